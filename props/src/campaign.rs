//! Calibrations by the hundred and thousand, played and calibrated in memory as `sixaxis campaign` does.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use sixaxis_campaign::plan::{CampaignPlan, Shard};
use sixaxis_campaign::row::Row;
use sixaxis_campaign::run::{self, Order, Watch};
use sixaxis_campaign::statistics::{Summary, summarise};
use sixaxis_campaign::{folder, part};
use sixaxis_reference::laboratory::plan_file::parse;

use crate::provenance::{revision, workspace};

/// Every how many cases progress is printed.
const PRINTED_EVERY: u64 = 10;

/// The cases of a plan, TOML, with these seeds, and what they sum up to.
///
/// # Errors
/// A plan that cannot be played; files that cannot be written.
pub fn played(plan: &str, first: u64, count: u64) -> Result<(Vec<Row>, Summary), String> {
    let plan = parse(Path::new("plan"), plan).map_err(|e| e.to_string())?;
    let plan = CampaignPlan::new(&plan, first, count).map_err(|e| e.to_string())?;
    // An interrupted run of the same code goes on where its finished parts end.
    let folder = workspace().join(format!("target/campaign/{}-{first}-{count}", revision()));
    let order = Order {
        plan: &plan,
        shard: Shard::WHOLE,
        folder: &folder,
        threads: 0,
    };
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    run::run(&order, &Counter::default()).map_err(|e| e.to_string())?;
    let summary = summarise(core::slice::from_ref(&folder)).map_err(|e| e.to_string())?;
    let mut rows = Vec::new();
    for named in folder::parts(&folder).map_err(|e| e.to_string())? {
        rows.extend(part::read(&named.path).map_err(|e| e.to_string())?.rows);
    }
    std::fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    println!("{:?}, step 4: {:?}", summary.status, summary.step_4);
    Ok((rows, summary))
}

/// Prints how many cases are done.
#[derive(Default)]
struct Counter(AtomicU64);

impl Watch for Counter {
    fn begins(&self, cases: u64, done: u64) {
        println!("{cases} cases, {done} found done");
    }

    fn case(&self) {
        let done = self.0.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of(PRINTED_EVERY) {
            println!("{done} done");
        }
    }

    fn set_aside(&self, part: &Path, now: &Path, cause: &str) {
        eprintln!(
            "{} is damaged ({cause}) and lies at {} now",
            part.display(),
            now.display()
        );
    }
}

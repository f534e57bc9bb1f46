//! Calibrations by the thousand, summed up: `cargo run --release -p sixaxis-props --example campaign`.
//!
//! Plays and calibrates the sessions of `props/results/campaign.toml` in memory, as `sixaxis campaign` does, and with `--publish` writes
//! what README and the report show.

use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

use sixaxis_campaign::plan::{CampaignPlan, Shard};
use sixaxis_campaign::run::{self, Order, Watch};
use sixaxis_campaign::statistics::{Summary, summarise};
use sixaxis_props::provenance::{revision, workspace};
use sixaxis_props::publication::{Seeds, run as publish};
use sixaxis_reference::laboratory::plan_file::parse;

/// What is varied.
const PLAN: &str = include_str!("../results/campaign.toml");

fn main() -> ExitCode {
    let (first, count) = (1, 10_000);
    publish(
        Seeds {
            first,
            count,
            sample: 10,
        },
        study,
    )
}

fn study(first: u64, count: u64) -> Result<Summary, String> {
    let plan = parse(Path::new("campaign.toml"), PLAN).map_err(|e| e.to_string())?;
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
    let summary = summarise(&[folder.clone()]).map_err(|e| e.to_string())?;
    std::fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    println!("{:?}, step 4: {:?}", summary.status, summary.step_4);
    Ok(summary)
}

/// Prints every hundredth case.
#[derive(Default)]
struct Counter(AtomicU64);

impl Watch for Counter {
    fn begins(&self, cases: u64, done: u64) {
        println!("{cases} cases, {done} found done");
    }

    fn case(&self) {
        let done = self.0.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of(100) {
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

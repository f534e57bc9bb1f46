//! `sixaxis campaign run`: what is left of a shard to be done.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, Result};
use sixaxis_campaign::plan::{CampaignPlan, LARGEST_SEED, Shard};
use sixaxis_campaign::run::{Order, Watch, run as work};
use sixaxis_reference::laboratory::plan_file;

use crate::commands::choices::threads;
use crate::commands::common::{print, tell};
use crate::commands::output::make_folder;
use crate::progress::Progress;

/// Which cases and where to write.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Plan of the sessions, TOML, as `sixaxis simulate --print-plan` writes it; its seed does not matter
    #[arg(long, value_name = "FILE")]
    plan: PathBuf,
    /// Seed of the first case; each has its own
    #[arg(long, value_name = "SEED", default_value_t = 1,
        value_parser = clap::value_parser!(u64).range(..=LARGEST_SEED))]
    first_seed: u64,
    /// Cases of the whole campaign
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    count: u64,
    /// Do one shard of them, as in 3/16; without, all
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE, hide_default_value = true)]
    shard: Shard,
    /// Folder to write to; shards may share it
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Threads; 0 for one for each core
    #[arg(long, value_name = "N", value_parser = threads, default_value_t = 0, hide_default_value = true)]
    threads: usize,
    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

const AFTER_HELP: &str = include_str!("run.txt");

/// Does what is left to be done.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let session = plan_file::read(&arguments.plan)?;
    let plan = CampaignPlan::new(&session, arguments.first_seed, arguments.count)
        .with_context(|| format!("{} cannot be run", arguments.plan.display()))?;
    if !arguments.quiet {
        make_folder(&arguments.out)?;
    }
    let shown = Shown(Progress::new(arguments.quiet));
    let started = Instant::now();
    let done = work(
        &Order {
            plan: &plan,
            shard: arguments.shard,
            folder: &arguments.out,
            threads: arguments.threads,
        },
        &shown,
    )?;
    drop(shown);
    if arguments.quiet {
        return Ok(ExitCode::SUCCESS);
    }
    let seconds = started.elapsed().as_secs_f64();
    let rate = if done.cases > 0 {
        format!(", {:.1} a second", done.cases as f64 / seconds)
    } else {
        String::new()
    };
    let failed = if done.failed > 0 {
        format!(
            "{} of them could not be calibrated: columns status and failure say why\n",
            done.failed
        )
    } else {
        String::new()
    };
    let out = arguments.out.display();
    print(format!(
        "{out}: {} cases, {} found done, {} done in {seconds:.0} s{rate}\n{failed}next: sixaxis campaign summary {out}\n",
        done.found + done.cases,
        done.found,
        done.cases,
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// The library's work on the command's progress display.
struct Shown(Progress);

impl Watch for Shown {
    fn begins(&self, cases: u64, _: u64) {
        self.0.counted("calibrating", cases);
    }

    fn case(&self) {
        self.0.advance(1);
    }

    fn set_aside(&self, part: &Path, now: &Path, cause: &str) {
        let (part, now) = (part.display(), now.display());
        let words = format!("{part}: {cause}; set aside as {now}, its cases are done again");
        tell("warning", &words);
    }
}

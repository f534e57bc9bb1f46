//! `sixaxis report`: the paper's campaign on MuJoCo, as an offline HTML page.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde::Serialize;
use sixaxis_core::Scheme;
use sixaxis_page::render;
use sixaxis_page::standalone::standalone;
use sixaxis_props::provenance::revision;
use sixaxis_props::{evidence, motions, tolerance};
use sixaxis_recordings::draft::write_atomically;
use sixaxis_reports::sections;
use sixaxis_reports::study::results::{AcceptanceLimit, LimitKind, Results};
use sixaxis_reports::study::{self, plan::Plan};

use super::choices::threads;
use super::common::print;
use super::output::claim_folder;
use crate::progress::Progress;

/// Exit code where a required limit is broken; the report is written all the same.
const BROKEN: u8 = 5;

/// What to play and where to write.
#[derive(clap::Args)]
pub struct Arguments {
    /// Folder to write to
    #[arg(long, value_name = "DIR", default_value = "sixaxis-report")]
    out: PathBuf,
    /// Seed of the laboratory's random errors
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Fewer runs, for a first look
    #[arg(long)]
    quick: bool,
    /// Threads to use; 0 for one per core
    #[arg(long, value_name = "N", value_parser = threads, default_value_t = 0)]
    threads: usize,
    /// Folder of the test suites' rows [default: where the tests of this checkout write]
    #[arg(long, value_name = "DIR")]
    evidence: Option<PathBuf>,
}

/// What depends on where and when: kept out of `results.json`.
#[derive(Serialize)]
struct Run {
    sixaxis_version: String,
    commit: String,
    mujoco_version: String,
    seed: u64,
    quick: bool,
    threads: usize,
    machine: String,
    duration_s: f64,
}

impl Run {
    fn facts(&self) -> Vec<(String, String)> {
        [
            ("sixaxis", self.sixaxis_version.clone()),
            ("commit", self.commit.clone()),
            ("MuJoCo", self.mujoco_version.clone()),
            ("seed", self.seed.to_string()),
            (
                "campaign",
                if self.quick { "quick" } else { "full" }.to_owned(),
            ),
            ("threads", self.threads.to_string()),
            ("machine", self.machine.clone()),
            ("duration", format!("{:.0} s", self.duration_s)),
        ]
        .map(|(name, value)| (name.to_owned(), value))
        .to_vec()
    }
}

/// Plays the campaign and writes the report.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let Arguments {
        out,
        seed,
        quick,
        threads,
        evidence,
    } = arguments;
    let plan = &Plan {
        seed: *seed,
        quick: *quick,
    };
    // Before half a minute of work, not after it.
    if let Some(folder) = evidence {
        ensure!(
            folder.is_dir(),
            "{} is no folder of evidence",
            folder.display()
        );
    }
    let _ours_alone = claim_folder(out)?;
    let started = Instant::now();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(*threads)
        .build()
        .context("cannot start the threads")?;
    let progress = Progress::shown();
    let report = |name: &str, total, units| progress.report(name, total, units);
    let results = pool.install(|| study::run(plan, &report))?;
    let motions = plan.random_motions();
    let mut rows = pool.install(|| {
        let scheme = Scheme::AdamsMoulton4;
        motions::compare_all(plan.seed, motions, scheme, tolerance::DECOUPLED, || {
            progress.report("motions", motions, 1);
        })
    });
    drop(progress);
    let run = Run {
        sixaxis_version: results.sixaxis_version.clone(),
        commit: revision().to_owned(),
        mujoco_version: results.mujoco_version.clone(),
        seed: plan.seed,
        quick: plan.quick,
        threads: pool.current_num_threads(),
        machine: machine(),
        duration_s: started.elapsed().as_secs_f64(),
    };
    let folder = evidence.clone().unwrap_or_else(evidence::folder);
    let section = match evidence::read_folder(&folder) {
        Ok(suites) => {
            rows.extend(suites);
            sections::evidence::section(&rows, None)
        }
        Err(e) => sections::evidence::section(&rows, Some(&e)),
    }?;
    let page = sections::report(&results, section, run.facts())?;
    let html = out.join("report.html");

    let mut files = vec![
        (
            out.join("results.json"),
            serde_json::to_vec_pretty(&Document::new(&results)?)?,
        ),
        (out.join("run.json"), serde_json::to_vec_pretty(&run)?),
        (html.clone(), render(&page)?.into_bytes()),
    ];
    files.push((out.join("evidence.csv"), evidence::to_csv(&rows)?));
    let figures = out.join("figures");
    std::fs::create_dir_all(&figures)
        .with_context(|| format!("cannot create {}", figures.display()))?;
    for figure in page.figures() {
        files.push((
            figures.join(&figure.id).with_extension("svg"),
            standalone(figure).into_bytes(),
        ));
    }
    for (path, bytes) in files {
        write_atomically(&path, &bytes)
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    let missed = results.acceptance.iter().any(|bar| !bar.met);
    let quick = match plan.quick && missed {
        true => {
            "this is a quick look with three trials a step on the three axes alone: the laboratory's limits need the full campaign, without --quick\n\n"
        }
        false => "",
    };
    print(format!(
        "{}\n{quick}{}\n",
        summary(&results),
        html.display()
    ))?;
    Ok(ExitCode::from(code(&results.acceptance)))
}

fn code(acceptance: &[AcceptanceLimit]) -> u8 {
    match acceptance.iter().any(AcceptanceLimit::is_broken) {
        true => BROKEN,
        false => 0,
    }
}

/// `results.json`: the numbers and the ledger.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    results: &'a Results,
    claims: Vec<sixaxis_page::Claim>,
}

impl<'a> Document<'a> {
    fn new(results: &'a Results) -> Result<Self> {
        Ok(Self {
            results,
            claims: sections::claims(results)?,
        })
    }
}

/// Every acceptance limit with what was measured, a line each.
fn summary(results: &Results) -> String {
    let heading = format!(
        "{:<66} {:>12} {:>10}\n",
        "acceptance limit", "measured", "limit"
    );
    let line = |bar: &AcceptanceLimit| {
        format!(
            "{:<66} {:>12.2e} {:>10.1e} {:<2} {}\n",
            bar.name,
            bar.value,
            bar.limit,
            bar.unit,
            match (bar.met, bar.kind) {
                (true, _) => "met",
                (false, LimitKind::Required) => "BROKEN",
                (false, LimitKind::Aim) => "missed: a finding",
            }
        )
    };
    heading + &results.acceptance.iter().map(line).collect::<String>()
}

/// Processor and number of cores, as the system names them.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let name = std::fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            text.lines()
                .find(|line| line.starts_with("model name"))
                .and_then(|line| line.split(':').nth(1))
                .map(|name| name.trim().to_owned())
        })
        .unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    format!("{name}, {cores} cores, {}", std::env::consts::OS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No seed is known to break a required limit: here it is said that one is.
    #[test]
    fn neg_a_broken_limit_is_the_exit_code() {
        let limit = |met, kind| AcceptanceLimit {
            name: String::new(),
            unit: String::new(),
            note: String::new(),
            value: 1.0,
            limit: 1.0,
            met,
            kind,
        };
        let missed = limit(false, LimitKind::Aim);
        assert_eq!(code(&[limit(true, LimitKind::Required), missed.clone()]), 0);
        assert_eq!(code(&[missed, limit(false, LimitKind::Required)]), BROKEN);
    }
}

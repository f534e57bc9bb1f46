//! `sixaxis campaign summary`: the parts of one campaign, from any number of folders, summed up.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use sixaxis_campaign::statistics::{Estimator, Share, Summary, summarise};

use crate::commands::common::{print, print_json};

/// Which folders.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Folders with parts of one campaign, in any order
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Print every number as JSON instead of the table
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = include_str!("summary.txt");

/// Runs of seeds that the table lists.
const RUNS_SHOWN: usize = 10;

/// Sums up.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let summary = summarise(&arguments.folders)?;
    if arguments.json {
        print_json(&summary)?;
    } else {
        print(table(&summary))?;
    }
    Ok(ExitCode::from(if summary.missing > 0 { 3 } else { 0 }))
}

fn table(summary: &Summary) -> String {
    let mut out = String::new();
    let counts = |words: &std::collections::BTreeMap<String, u64>| -> String {
        let words: Vec<String> = words.iter().map(|(w, n)| format!("{n} {w}")).collect();
        words.join(", ")
    };
    let _ = writeln!(
        out,
        "{} cases of seeds {} to {}{}: {}",
        summary.cases,
        summary.first_seed,
        summary.last_seed,
        match summary.unasked_seeds.as_slice() {
            [] => String::new(),
            unasked => format!(", without {}, which nobody asked for", runs(unasked)),
        },
        counts(&summary.status)
    );
    if !summary.step_4.is_empty() {
        let _ = writeln!(out, "step 4: {}", counts(&summary.step_4));
    }
    if summary.missing > 0 {
        let _ = writeln!(
            out,
            "{} missing, seeds {}",
            match summary.missing {
                1 => "1 case is".to_owned(),
                missing => format!("{missing} cases are"),
            },
            runs(&summary.missing_seeds)
        );
    }
    estimators(&mut out, "four steps", summary, |p| Some(&p.four_steps));
    if summary.parameters.iter().any(|p| p.joint.is_some()) {
        estimators(&mut out, "joint fit", summary, |p| p.joint.as_ref());
        estimators(&mut out, "gain known", summary, |p| {
            p.joint_gain_known.as_ref()
        });
    }
    out
}

/// The first runs of seeds, and how many more there are.
fn runs(of_seeds: &[(u64, u64)]) -> String {
    let run = |(first, last): &(u64, u64)| match first == last {
        true => first.to_string(),
        false => format!("{first} to {last}"),
    };
    let shown: Vec<String> = of_seeds.iter().take(RUNS_SHOWN).map(run).collect();
    let more = match of_seeds.len().saturating_sub(RUNS_SHOWN) {
        0 => String::new(),
        more => format!(" and {more} more runs of them"),
    };
    shown.join(", ") + &more
}

fn estimators<'a>(
    out: &mut String,
    title: &str,
    summary: &'a Summary,
    of: impl Fn(&'a sixaxis_campaign::statistics::ParameterSummary) -> Option<&'a Estimator>,
) {
    let _ = writeln!(
        out,
        "\n{title:<10} {:>5} {:>8} {:>7} {:>15} {:>10} {:>10} {:>22} {:>22}",
        "unit", "cases", "failed", "bias/sd", "sd", "var/stated", "noise 95 %", "stated 95 %"
    );
    for parameter in &summary.parameters {
        let Some(e) = of(parameter) else { continue };
        let _ = writeln!(
            out,
            "{:<10} {:>5} {:>8} {:>7} {:>15} {:>10} {:>10} {:>22} {:>22}",
            parameter.parameter.to_string(),
            parameter.unit,
            e.cases,
            e.failures,
            e.bias_in_sd.map_or_else(dash, |bias| format!(
                "{bias:+.3} ± {:.3}",
                1.0 / (e.cases as f64).sqrt()
            )),
            e.attained_sd.map_or_else(dash, |sd| format!("{sd:.3e}")),
            e.variance_over_stated
                .map_or_else(dash, |ratio| format!("{ratio:.3}")),
            percent(e.within_noise_95),
            percent(e.within_stated_95),
        );
    }
}

fn dash() -> String {
    "-".to_owned()
}

fn percent(share: Option<Share>) -> String {
    share.map_or_else(dash, |share| {
        let (low, high) = share.wilson_95;
        format!(
            "{:.2} ({:.2}-{:.2})",
            100.0 * share.value,
            100.0 * low,
            100.0 * high
        )
    })
}

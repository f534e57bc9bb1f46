//! `sixaxis compare`: a result against the truth, or against another result.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result};
use sixaxis_calibration::compare::aligned::Aligned;
use sixaxis_calibration::compare::measure::{Comparison, compare, to_a_millionth};
use sixaxis_calibration::compare::track::Track;
use sixaxis_calibration::page;
use sixaxis_page::render;
use sixaxis_recordings::draft::write_atomically;

use super::common::{not_streamed, print, say};
use super::output::{JSON, PAGE, check_ending, check_outputs};

/// What is held against what.
#[derive(clap::Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// Decoupled recording
    result: PathBuf,
    /// Truth, or another result
    truth: PathBuf,
    /// Page to write: table, curves, errors; needs no network
    #[arg(long, value_name = "FILE", default_value = "compare.html")]
    out: PathBuf,
    /// The figures as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

const AFTER_HELP: &str = include_str!("compare.txt");

/// Compares, prints the table, writes the page.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    not_streamed([arguments.result.as_path(), arguments.truth.as_path()])?;
    let json = arguments.json.as_deref().map(|path| ("--json", path));
    let outputs: Vec<(&str, &Path)> = json
        .into_iter()
        .chain([("--out", arguments.out.as_path())])
        .collect();
    check_outputs(
        &outputs,
        [arguments.result.as_path(), arguments.truth.as_path()],
    )?;
    check_ending("--out", &arguments.out, PAGE)?;
    if let Some((option, path)) = json {
        check_ending(option, path, JSON)?;
    }
    let result = Track::open(&arguments.result)?;
    let truth = Track::open(&arguments.truth)?;
    for track in [&result, &truth] {
        let cut = track.cut.iter();
        let said: Vec<String> = cut
            .map(|cut| format!("{}: {cut}", track.path.display()))
            .collect();
        say("warning", &said);
    }
    let mut aligned = Aligned::new(result, truth)?;
    let comparison = compare(
        &mut aligned,
        arguments.result.display().to_string(),
        arguments.truth.display().to_string(),
    )?;
    say("warning", comparison.of_unequal_length().as_slice());
    let html = render(&page::comparison::page(&comparison))?;
    write_atomically(&arguments.out, html.as_bytes())
        .with_context(|| format!("cannot write {}", arguments.out.display()))?;
    if let Some(path) = &arguments.json {
        write_atomically(path, &serde_json::to_vec_pretty(&comparison)?)
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    print(format!(
        "{}\n{}\n",
        table(&comparison),
        arguments.out.display()
    ))?;
    Ok(ExitCode::SUCCESS)
}

fn table(comparison: &Comparison) -> String {
    let mut lines = vec![
        format!(
            "{} common instants{} from {} s at {} Hz\n",
            comparison.instants,
            comparison.left_out(|instants| instants.to_string()),
            to_a_millionth(comparison.start_s),
            to_a_millionth(comparison.rate_hz)
        ),
        format!(
            "{:<8} {:>8} {:>12} {:>12} {:>12}   {:^39}",
            "", "", "peak of", "largest", "rms of", "error over the peak, %"
        ),
        format!(
            "{:<8} {:>8} {:>12} {:>12} {:>12}   {:>9} {:>9} {:>9} {:>9}",
            "axis", "unit", "the truth", "error", "the error", "50 %", "90 %", "99 %", "largest"
        ),
    ];
    lines.extend(comparison.axes.iter().map(|axis| {
        let share = |figure: f64| {
            axis.percent(figure)
                .map_or("-".to_owned(), |percent| format!("{percent:.3}"))
        };
        let [half, most, nearly_all] = axis.error_quantiles;
        format!(
            "{:<8} {:>8} {:>12.5} {:>12.3e} {:>12.3e}   {:>9} {:>9} {:>9} {:>9}",
            axis.name,
            axis.unit,
            axis.peak,
            axis.largest_error,
            axis.rms_error,
            share(half),
            share(most),
            share(nearly_all),
            share(axis.largest_error)
        )
    }));
    if let Some(angle) = comparison.largest_attitude_error_deg {
        lines.push(format!("\nattitude: at most {angle:.3e} deg apart"));
    }
    lines.join("\n") + "\n"
}

//! `sixaxis model`: the simulated sensor as MJCF.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result};
use sixaxis_recordings::draft::write_atomically;
use sixaxis_reference::{campaign, paper, rig::Mounting};
use sixaxis_reports::study;

/// Which sensor and where to.
#[derive(clap::Args)]
pub struct Arguments {
    /// File to write
    #[arg(long, value_name = "FILE", default_value = "sixaxis.xml")]
    out: PathBuf,
    /// The sensor as designed instead of as identified
    #[arg(long)]
    design: bool,
}

/// Writes the model.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let out = &arguments.out;
    let parameters = if arguments.design {
        paper::design_parameters()
    } else {
        paper::identified_parameters()
    };
    let [trial, ..] = campaign::compound(Mounting::AxisVertical);
    let step_s = 1.0 / study::plan::CAMPAIGN_RATE_HZ / study::plan::CAMPAIGN_STEPS as f64;
    let xml = trial.model(&parameters).to_mjcf(step_s);
    write_atomically(out, xml.as_bytes())
        .with_context(|| format!("cannot write {}", out.display()))?;
    println!("{}", out.display());
    Ok(ExitCode::SUCCESS)
}

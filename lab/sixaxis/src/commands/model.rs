//! `sixaxis model`: the simulated sensor as MJCF.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result};
use sixaxis_recordings::draft::write_atomically;
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::paper;
use sixaxis_reference::rig::run::Mounting;
use sixaxis_reference::sensor::TrueSensor;
use sixaxis_reports::study;

use super::common::print;
use super::output::{check_ending, check_outputs};

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
    check_ending("--out", out, &["xml", "mjcf"])?;
    check_outputs(&[("--out", out)], [])?;
    let sensor = if arguments.design {
        TrueSensor::design()
    } else {
        TrueSensor::identified()
    };
    let [first, ..] = paper::COMPOUND_TABLES;
    let gravity = Mounting::AxisVertical.gravity_ground_m_s2(first.direction.normalize());
    let step_s = 1.0 / study::plan::CAMPAIGN_RATE_HZ / study::plan::CAMPAIGN_STEPS as f64;
    let xml = SensorModel::new(&sensor, gravity).to_mjcf(step_s);
    write_atomically(out, xml.as_bytes())
        .with_context(|| format!("cannot write {}", out.display()))?;
    print(format!("{}\n", out.display()))?;
    Ok(ExitCode::SUCCESS)
}

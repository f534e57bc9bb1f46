//! `sixaxis calibrate`: a session's recordings to 25 parameters, their intervals and a verdict.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result};
use sixaxis_calibration::session::SessionFile;
use sixaxis_calibration::verdict::{Grade, Unwatched, judge};

/// Which session and where to write.
#[derive(clap::Args)]
pub struct Arguments {
    /// Session file
    session: PathBuf,
    /// Calibration to write
    #[arg(long, value_name = "FILE", default_value = "calibration.json")]
    out: PathBuf,
}

/// Calibrates and judges.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let file = SessionFile::read(&arguments.session)?;
    let judgement = judge(&file, &Unwatched)?;
    if let Some(calibration) = &judgement.calibration {
        calibration
            .write(&arguments.out)
            .with_context(|| format!("cannot write {}", arguments.out.display()))?;
    }
    println!("{}", judgement.sentence);
    for next in &judgement.next {
        println!("- {next}");
    }
    Ok(ExitCode::from(match judgement.grade {
        Grade::Good => 0,
        Grade::Reserved => 3,
        Grade::Bad => 4,
    }))
}

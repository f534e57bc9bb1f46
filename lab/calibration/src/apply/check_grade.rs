//! Whether a calibration is one to decouple with.

use crate::calibration::Calibration;
use crate::report::Grade;
use anyhow::{Result, ensure};

/// What a user should know of the calibration called `name` before its result is believed; nothing if it is good.
///
/// # Errors
/// A bad one that is not forced, with its findings.
pub fn check_grade(name: &str, calibration: &Calibration, force: bool) -> Result<Option<String>> {
    match calibration.verdict {
        Grade::Good => Ok(None),
        Grade::Reserved => Ok(Some(format!(
            "{name}: its verdict is \"good with reservations\": nothing wrong was named, and its page says what is left open, which deviations need not contain"
        ))),
        Grade::Bad => {
            let findings: Vec<String> = calibration
                .findings
                .iter()
                .map(|finding| match finding.recordings.as_slice() {
                    [] => finding.cause.name().to_owned(),
                    [one] => format!("{} in {one}", finding.cause.name()),
                    [one, rest @ ..] => {
                        format!("{} in {one} and {} more", finding.cause.name(), rest.len())
                    }
                })
                .collect();
            let findings = if findings.is_empty() {
                "it names none".to_owned()
            } else {
                findings.join("; ")
            };
            ensure!(
                force,
                "{name}: its verdict is \"not good\" ({findings}); mend the calibration, or take --force and do not trust the result"
            );
            Ok(Some(format!(
                "{name}: its verdict is \"not good\" ({findings}); do not trust the result"
            )))
        }
    }
}

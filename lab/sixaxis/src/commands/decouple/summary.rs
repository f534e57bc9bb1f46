//! What `sixaxis decouple` says of a file's decoupling beside the accelerations: for `--json` and on the picture's page.

use serde::Serialize;
use sixaxis_calibration::apply::decoupled::Decoupled;
use sixaxis_calibration::report::Grade;
use sixaxis_recordings::inspect::listing::brief;

/// What `--json` prints.
#[derive(Serialize)]
pub(super) struct Summary<'a> {
    pub(super) recording: String,
    pub(super) calibration: String,
    pub(super) verdict: Grade,
    pub(super) out: String,
    #[serde(flatten)]
    pub(super) decoupled: &'a Decoupled,
    pub(super) duration_s: f64,
    pub(super) notes: &'a [String],
}

/// What the picture's page states of its origin.
pub(super) fn facts(summary: &Summary) -> Vec<(String, String)> {
    let decoupled = summary.decoupled;
    let mut facts = vec![
        ("sixaxis", env!("CARGO_PKG_VERSION").to_owned()),
        ("recording", summary.recording.clone()),
        ("calibration", summary.calibration.clone()),
        ("verdict", summary.verdict.word().to_owned()),
        ("samples", decoupled.samples.to_string()),
        ("sample rate", format!("{} Hz", decoupled.sample_rate_hz)),
        ("scheme", decoupled.scheme.name().to_owned()),
        ("gains of limbs 1 to 9, N/V", list(&decoupled.gain_n_per_v)),
        (
            "gravity, ground axes, m/s²",
            list(&decoupled.gravity_ground_m_s2),
        ),
    ];
    if let Some(corner_hz) = decoupled.low_pass_hz {
        facts.push(("low-pass", format!("{corner_hz} Hz, without phase")));
    }
    if !decoupled.excluded_limbs.is_empty() {
        let numbers = decoupled.excluded_limbs.iter().map(usize::to_string);
        facts.push(("excluded limbs", numbers.collect::<Vec<_>>().join(", ")));
    }
    if decoupled.end_rate_before_rad_s.is_some() {
        facts.push(("correction", "from rest to rest".to_owned()));
    }
    let owned = facts
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value));
    owned.collect()
}

fn list(numbers: &[f64]) -> String {
    let texts: Vec<String> = numbers.iter().map(|number| brief(*number, 6)).collect();
    texts.join(", ")
}

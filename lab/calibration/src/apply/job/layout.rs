//! What a result says before its rows: its columns, and where it is from.

use std::path::Path;

use sixaxis_recordings::{Channel, Layout};

use super::Job;
use crate::apply::columns::DEVIATIONS;
use crate::apply::exclusions::flags;

impl Job<'_> {
    /// The columns of the result.
    pub(super) fn layout(&self, sample_rate_hz: f64) -> Layout {
        let mut layout = self.columns.layout(sample_rate_hz);
        if self.uncertainty {
            let deviations = DEVIATIONS.map(|(name, unit)| Channel {
                sample_rate_hz: Some(sample_rate_hz),
                ..Channel::new(name, Some(unit))
            });
            layout.channels.extend(deviations);
        }
        if self.false_alarms_per_hour.is_some() {
            layout.channels.extend(flags(sample_rate_hz));
        }
        layout
    }

    /// The result's properties: where it is from.
    pub(super) fn describe(&self, recording: &Path, layout: &mut Layout) {
        let name = |path: &Path| {
            let name = path.file_name().unwrap_or_default();
            name.to_string_lossy().into_owned()
        };
        let mut put = |key: &str, value: String| layout.properties.insert(key.to_owned(), value);
        put("sixaxis_version", env!("CARGO_PKG_VERSION").to_owned());
        put("recording", name(recording));
        put("calibration", name(self.calibration_name));
        put("verdict", self.calibration.verdict.word().to_owned());
        put("first_row_sample", "1".to_owned());
        if !self.excluded.is_empty() {
            put("excluded_limbs", self.excluded.to_string());
        }
    }
}

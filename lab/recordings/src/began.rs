//! When a recording began, by a date.

use chrono::DateTime;

/// Property that says when a file's recording began.
pub const BEGAN: &str = "wf_start_time";

/// Date and time of a recording's first sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Began {
    /// Since 1970, ns: in universal time, or by the clock on a wall.
    pub ns: i128,
    /// Whether that is universal time.
    pub universal: bool,
}

impl Began {
    /// Date and time after ISO 8601; none of a year that no calendar has.
    pub fn text(self) -> Option<String> {
        let time = DateTime::from_timestamp_nanos(i64::try_from(self.ns).ok()?);
        let zone = if self.universal { "Z" } else { "" };
        Some(format!("{}{zone}", time.format("%Y-%m-%dT%H:%M:%S%.9f")))
    }

    /// So many seconds later.
    pub fn later(self, later_s: f64) -> Self {
        let ns = self.ns + (1e9 * later_s).round() as i128;
        Self { ns, ..self }
    }

    /// Seconds from another beginning to this one; none between universal time and a wall's.
    pub fn after(self, other: Self) -> Option<f64> {
        let comparable = self.universal == other.universal;
        comparable.then(|| crate::text::seconds(other.ns, self.ns))
    }
}

//! How far a calibration is, for whoever shows it.

/// Receives the progress of a calibration.
pub trait Progress: Sync {
    /// A stage begins that has so many parts.
    fn stage(&self, name: &str, parts: usize);
    /// One part is done.
    fn part(&self);
}

/// Shows nothing.
pub struct NoProgress;

impl Progress for NoProgress {
    fn stage(&self, _: &str, _: usize) {}
    fn part(&self) {}
}

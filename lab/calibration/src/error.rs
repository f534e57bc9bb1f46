//! Errors that stop a calibration before it begins. Faults in the data are findings, not errors: see [`crate::diagnosis`].

use thiserror::Error;

/// Every way in which a session can be refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A recording cannot be read, or the session says something impossible of it.
    #[error(transparent)]
    Recording(#[from] sixaxis_recordings::Error),
    /// A recording can be read but not be worked with.
    #[error("{file}: {source}")]
    Trial {
        /// The recording.
        file: String,
        /// Channel and sample.
        source: Box<sixaxis_core::Error>,
    },
    /// One of the four steps refuses its data.
    #[error("{step}: {source}")]
    Step {
        /// Which.
        step: &'static str,
        /// Why.
        source: Box<sixaxis_core::Error>,
    },
}

/// Result of every fallible function of this crate.
pub type Result<T> = std::result::Result<T, Error>;

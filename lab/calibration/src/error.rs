//! What stops a calibration before it begins. What is merely wrong with the data is no error: see [`crate::suspicion`].

use std::path::PathBuf;

use thiserror::Error;

/// Every way in which a session can be refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A recording cannot be read.
    #[error(transparent)]
    Recording(#[from] sixaxis_recordings::Error),
    /// The session file says something that cannot be.
    #[error("{}{}: {key}: {cause}", path.display(), line.map(|l| format!(", line {l}")).unwrap_or_default())]
    Session {
        /// The session file.
        path: PathBuf,
        /// Line of the key, from 1, where it is known.
        line: Option<usize>,
        /// The key, as in `recording[3].direction`.
        key: String,
        /// What is wrong, and what would be right.
        cause: String,
    },
    /// A recording can be read but not be worked with.
    #[error("{file}: {source}")]
    Trial {
        /// The recording.
        file: String,
        /// Channel and sample.
        source: Box<sixaxis_core::Error>,
    },
    /// A channel comes in a unit that is not what it measures, or in none.
    #[error("{file}: channel {channel:?}: {cause}")]
    Unit {
        /// The recording.
        file: String,
        /// The channel.
        channel: String,
        /// What is wrong, and what would be right.
        cause: String,
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

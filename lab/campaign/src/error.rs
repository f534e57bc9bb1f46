//! What stops a campaign. A case that cannot be calibrated does not: it is a row.

use std::path::PathBuf;

use sixaxis_reference::laboratory::error::SessionError;
use thiserror::Error;

/// Every way in which a campaign can be refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] sixaxis_recordings::Error),
    /// The plan cannot be played.
    #[error(transparent)]
    Plan(#[from] SessionError),
    /// Seeds that cannot be.
    #[error("seeds: {0}")]
    Seeds(String),
    /// A file of this name is no part of a campaign, or no longer.
    #[error("{}: {cause}", path.display())]
    Damaged {
        /// The part.
        path: PathBuf,
        /// What is wrong with it.
        cause: String,
    },
    /// Parts of two campaigns.
    #[error("{} belongs to another campaign: {}", path.display(), differences.join("; "))]
    OtherCampaign {
        /// The part or plan that is different.
        path: PathBuf,
        /// Where: key, what it has there, what it would have to have.
        differences: Vec<String>,
    },
    /// Two parts have the same case.
    #[error("seed {seed} is in {} and in {}: take one of them away", first.display(), second.display())]
    Duplicate {
        /// The case.
        seed: u64,
        /// A part.
        first: PathBuf,
        /// Another.
        second: PathBuf,
    },
    /// Nothing to sum up.
    #[error("no parts of a campaign in {}", folders.iter().map(|f| f.display().to_string()).collect::<Vec<_>>().join(", "))]
    NoParts {
        /// Where they were looked for.
        folders: Vec<PathBuf>,
    },
    /// The system gives no more threads.
    #[error("cannot start a thread: {0}")]
    Threads(String),
}

/// Result of every fallible function of this crate.
pub type Result<T> = std::result::Result<T, Error>;

//! What can be wrong with a file, said so that it can be found.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Where in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Nowhere in particular.
    Whole,
    /// Byte, from 0.
    Byte(u64),
    /// Line, from 1.
    Line(u64),
    /// Line and column of the table, both from 1.
    Cell(u64, usize),
    /// Sample, from 0.
    Sample(u64),
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Byte(at) => write!(f, ", byte {at}"),
            Self::Line(line) => write!(f, ", line {line}"),
            Self::Cell(line, column) => write!(f, ", line {line}, column {column}"),
            Self::Sample(sample) => write!(f, ", sample {sample}"),
        }
    }
}

/// Every way in which a file can be refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// The system says no.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Its name says nothing that is known, nor do its first bytes.
    #[error(
        "{}: unknown kind of file; known are .csv, .txt, .tsv, .dat, .lvm (also .gz), .tdms, .parquet, .npy, .npz, .h5, .hdf5 and .mat, the binary ones by how they begin",
        path.display()
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// A file of another kind than the one expected there.
    #[error("{}: no {expected}; it looks like a {found}", path.display())]
    OtherKind {
        /// The file.
        path: PathBuf,
        /// What was expected.
        expected: &'static str,
        /// What it seems to be.
        found: &'static str,
    },
    /// The file breaks its format's rules, or ends too early.
    #[error("{}{place}: {cause}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Where.
        place: Place,
        /// What is wrong.
        cause: String,
    },
    /// A feature of the format that is not read.
    #[error("{}: {feature} is not supported; {advice}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What it uses.
        feature: String,
        /// What the user can do.
        advice: String,
    },
    /// A channel that is not there.
    #[error("{}: no channel {name:?}; it has {available}", path.display())]
    NoSuchChannel {
        /// The file.
        path: PathBuf,
        /// The name asked for.
        name: String,
        /// The names there are.
        available: String,
    },
    /// Channels that are to be read side by side differ in length.
    #[error("{}: channel {name:?} has {samples} samples, {expected} were expected", path.display())]
    LengthMismatch {
        /// The file.
        path: PathBuf,
        /// The channel.
        name: String,
        /// Its length.
        samples: u64,
        /// Length of the first channel selected.
        expected: u64,
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
    /// A channel in one unit by its file and in another by what was stated.
    #[error(
        "{file}: channel {channel:?}: the file says {own:?}, and stated is {stated:?} (in [channels], or by --unit)"
    )]
    UnitContradicted {
        /// The recording.
        file: String,
        /// The channel.
        channel: String,
        /// The file's unit.
        own: String,
        /// The other one.
        stated: String,
    },
    /// A sample that nothing can be computed from: a value that is not finite, a time stamp that is no clock's.
    #[error(
        "{}{}: channel {channel:?}, sample {sample}: {cause}",
        path.display(),
        line.map_or(Place::Whole, Place::Line)
    )]
    Sample {
        /// The recording.
        path: PathBuf,
        /// The channel.
        channel: String,
        /// The sample, from 0.
        sample: u64,
        /// Its line, from 1, in a file of text.
        line: Option<u64>,
        /// What is wrong, and what to do.
        cause: String,
    },
    /// A recording of too few samples.
    #[error("{}: {samples} samples{which}; {needed} are needed", path.display())]
    TooShort {
        /// The recording.
        path: PathBuf,
        /// Fewest samples that are accepted.
        needed: usize,
        /// Its samples.
        samples: usize,
        /// Which of its samples are counted, if not all.
        which: &'static str,
    },
    /// A recording that cannot be brought to an even clock.
    #[error("{}: {source}", path.display())]
    Resampling {
        /// The recording.
        path: PathBuf,
        /// Why.
        source: Box<sixaxis_core::Error>,
    },
    /// A session file has a value that is impossible.
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
}

/// Result of every fallible function of this crate.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An input or output error with its file.
    pub fn io(path: &Path, source: io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            source,
        }
    }

    /// A broken rule with its place.
    pub fn malformed(path: &Path, place: Place, cause: impl Into<String>) -> Self {
        Self::Malformed {
            path: path.to_owned(),
            place,
            cause: cause.into(),
        }
    }

    /// A feature that is not read, with what the user can do.
    pub fn unsupported(path: &Path, feature: impl Into<String>, advice: impl Into<String>) -> Self {
        Self::Unsupported {
            path: path.to_owned(),
            feature: feature.into(),
            advice: advice.into(),
        }
    }
}

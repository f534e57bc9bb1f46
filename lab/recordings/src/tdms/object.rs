//! Object paths and what is known of an object.

use super::daqmx::Daqmx;
use super::kind::Kind;
use super::value::Properties;

/// The file, a group or a channel.
#[derive(Debug, Default)]
pub struct Object {
    /// Names of group and channel; none for the file.
    pub names: Vec<String>,
    /// The latest value of each.
    pub properties: Properties,
    /// How its samples lie in a chunk, as last said.
    pub raw: Option<RawIndex>,
    /// Samples in the file.
    pub samples: u64,
}

/// How an object's samples lie in a chunk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawIndex {
    pub kind: Kind,
    /// Samples per chunk.
    pub values: u64,
    /// Bytes per chunk, where it is not from DAQmx.
    pub bytes: u64,
    pub daqmx: Option<Daqmx>,
}

impl RawIndex {
    /// Whether samples under another index can follow in the same channel.
    pub fn continues(&self, other: &Self) -> bool {
        let scalers = |raw: &Self| -> Vec<(Kind, u32)> {
            let scalers = raw.daqmx.iter().flat_map(|daqmx| &daqmx.scalers);
            scalers.map(|scaler| (scaler.kind, scaler.id)).collect()
        };
        self.kind == Kind::Void || self.kind == other.kind && scalers(self) == scalers(other)
    }
}

/// Splits `/'group'/'channel'`; quotes inside a name are doubled. None where it is not such a path.
pub fn split_path(path: &str) -> Option<Vec<String>> {
    let mut names = Vec::new();
    if path == "/" {
        return Some(names);
    }
    let mut rest = path;
    while !rest.is_empty() {
        rest = rest.strip_prefix("/'")?;
        let mut name = String::new();
        loop {
            let (before, after) = rest.split_once('\'')?;
            name.push_str(before);
            match after.strip_prefix('\'') {
                Some(after) => {
                    name.push('\'');
                    rest = after;
                }
                None => {
                    rest = after;
                    break;
                }
            }
        }
        names.push(name);
    }
    (1..=2).contains(&names.len()).then_some(names)
}

/// What [`split_path`] splits.
pub fn join_path<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut path = String::new();
    for name in names {
        path.push_str("/'");
        path.push_str(&name.replace('\'', "''"));
        path.push('\'');
    }
    if path.is_empty() {
        path.push('/');
    }
    path
}

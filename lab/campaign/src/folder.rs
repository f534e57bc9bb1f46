//! The parts of a campaign side by side, and the plan that they are of.

use core::ops::Range;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use sixaxis_recordings::draft::write_atomically;

use crate::error::{Error, Result};
use crate::part::{Provenance, seeds_of};
use crate::plan::differences;

/// The campaign's plan in each folder that has parts of it, for people and for the next run.
pub const PLAN_FILE: &str = "plan.toml";

/// What is added to the name of a part that cannot be used.
const SET_ASIDE: &str = "damaged";

/// A part by its name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Named {
    /// First seed.
    pub first: u64,
    /// Seed after the last.
    pub end: u64,
    /// The file.
    pub path: PathBuf,
}

/// The parts in a folder in the order of their seeds. Other files are nobody's business.
///
/// # Errors
/// [`Error::File`].
pub fn parts(folder: &Path) -> Result<Vec<Named>> {
    let io = |source| sixaxis_recordings::Error::io(folder, source);
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        if let Some(Range { start: first, end }) = seeds_of(&path) {
            found.push(Named { first, end, path });
        }
    }
    found.sort();
    Ok(found)
}

/// Makes a folder a campaign's, or finds that it is. The first to come writes the plan.
///
/// # Errors
/// [`Error::OtherCampaign`] with what is different; [`Error::File`].
pub fn claim(folder: &Path, plan: &str) -> Result<()> {
    let io = |path: &Path, source| sixaxis_recordings::Error::io(path, source);
    fs::create_dir_all(folder).map_err(|e| io(folder, e))?;
    let path = folder.join(PLAN_FILE);
    match fs::read_to_string(&path) {
        Ok(theirs) => {
            let differences = differences(&path, &theirs, plan);
            if differences.is_empty() {
                Ok(())
            } else {
                Err(Error::OtherCampaign { path, differences })
            }
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            // A hundred shards may begin at once, and each writes a draft of its own: the last of equal files stays.
            Ok(write_atomically(&path, plan.as_bytes())?)
        }
        Err(error) => Err(io(&path, error).into()),
    }
}

/// Refuses a part of another plan or of another version, whose bits may be others.
///
/// # Errors
/// [`Error::OtherCampaign`].
pub fn same_campaign(path: &Path, theirs: &Provenance, ours: &Provenance) -> Result<()> {
    let mut differences = differences(path, &theirs.plan, &ours.plan);
    if theirs.version != ours.version {
        differences.push(format!(
            "version: {} there, {} here",
            theirs.version, ours.version
        ));
    }
    if differences.is_empty() {
        return Ok(());
    }
    Err(Error::OtherCampaign {
        path: path.to_owned(),
        differences,
    })
}

/// Gives a part a name under which nobody takes it for one, and returns that.
///
/// # Errors
/// [`Error::File`].
pub fn set_aside(path: &Path) -> Result<PathBuf> {
    let free = (1_u32..)
        .map(|n| {
            let mut name = path.as_os_str().to_owned();
            name.push(format!(".{SET_ASIDE}-{n}"));
            PathBuf::from(name)
        })
        .find(|name| !name.exists())
        .unwrap_or_else(|| path.with_extension(SET_ASIDE));
    fs::rename(path, &free).map_err(|source| sixaxis_recordings::Error::io(path, source))?;
    Ok(free)
}

//! A file that appears whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use tempfile::{Builder, TempPath};

use crate::error::{Error, Result};

/// Between the name of the file to be written and the end of its draft's name stand so many random characters.
const RANDOM: usize = 6;
/// Age from which a draft that nobody holds is a killed run's. A younger one may be about to be locked.
const LEFT_OVER: Duration = Duration::from_secs(60);
/// Links that are followed from one to the next.
const MOST_LINKS: usize = 40;

/// What is written before a path shows it: a neighbour of the file, under a random name, renamed over it once complete. Whatever
/// happens before, a power cut included, the path holds the old file or none. A link is followed to the file that it names. A device
/// or a pipe is written into, as it comes.
#[derive(Debug)]
pub struct Draft {
    path: PathBuf,
    /// None for a device or a pipe.
    neighbour: Option<TempPath>,
}

impl Draft {
    /// Creates the neighbour, `.NAME.RANDOM.part`, for writing, and clears away those that killed runs left of the same name. Missing
    /// folders are made.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn create(path: &Path) -> Result<(Self, File)> {
        let io = |source| Error::io(path, source);
        let path = followed(path).map_err(io)?;
        let there = fs::metadata(&path);
        if there.as_ref().is_ok_and(fs::Metadata::is_dir) {
            return Err(io(ErrorKind::IsADirectory.into()));
        }
        if there.is_ok_and(|there| !there.is_file()) {
            let file = OpenOptions::new().write(true).open(&path).map_err(io)?;
            let neighbour = None;
            return Ok((Self { path, neighbour }, file));
        }
        let name = path
            .file_name()
            .ok_or_else(|| io(ErrorKind::InvalidFilename.into()))?;
        let folder = folder_of(&path);
        fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
        let prefix = format!(".{}.", name.to_string_lossy());
        clear_away(folder, &prefix);
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(SUFFIX).rand_bytes(RANDOM);
        // Readable as any other new file is; the default is the owner's alone.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let (file, neighbour) = builder.tempfile_in(folder).map_err(io)?.into_parts();
        // Until the file is closed, by a kill at the latest. Where a file system knows no locks its drafts stay.
        let _ = file.try_lock();
        let neighbour = Some(neighbour);
        Ok((Self { path, neighbour }, file))
    }

    /// Flushes to disk and renames. `file` is the one from [`Self::create`], with everything written to it.
    ///
    /// # Errors
    /// [`Error::Io`]; the old file, if any, is then untouched.
    pub fn keep(self, file: &File) -> Result<()> {
        let Self { path, neighbour } = self;
        let Some(neighbour) = neighbour else {
            return Ok(());
        };
        let renamed = || {
            file.sync_all()?;
            neighbour.persist(&path).map_err(|error| error.error)
        };
        renamed().map_err(|source| Error::io(&path, source))?;
        // The rename itself is durable once the folder is; not every platform can open a folder.
        if let Ok(opened) = File::open(folder_of(&path)) {
            let _ = opened.sync_all();
        }
        Ok(())
    }
}

const SUFFIX: &str = ".part";

/// The path that a link names in the end, there or not.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&path) {
            Ok(next) => path = folder_of(&path).join(next),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("too many links"))
}

/// Removes drafts whose runs were killed: old ones that nobody has locked. What cannot be removed stays.
fn clear_away(folder: &Path, prefix: &str) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let random = name
            .to_str()
            .and_then(|name| name.strip_prefix(prefix)?.strip_suffix(SUFFIX));
        let is_draft = random.is_some_and(|r| {
            r.len() == RANDOM && r.bytes().all(|byte| byte.is_ascii_alphanumeric())
        });
        let age = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        let is_left = || {
            entry.file_type().is_ok_and(|kind| kind.is_file())
                && age().is_some_and(|age| age > LEFT_OVER)
                && File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok())
        };
        if is_draft && is_left() {
            let _ = fs::remove_file(entry.path());
        }
    }
}

pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Writes a whole file at once.
///
/// # Errors
/// [`Error::Io`]; the old file, if any, is then untouched.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    let (draft, mut file) = Draft::create(path)?;
    file.write_all(bytes)
        .map_err(|source| Error::io(path, source))?;
    draft.keep(&file)
}

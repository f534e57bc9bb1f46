//! A file that appears whole or not at all.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::{Builder, TempPath};

use crate::error::{Error, Result};

/// A neighbour of the file to be written, under a random name, renamed over it once complete. Whatever happens before, a
/// power cut included, the path holds the old file or none.
#[derive(Debug)]
pub struct Draft {
    path: PathBuf,
    neighbour: TempPath,
}

impl Draft {
    /// Creates the neighbour, `.NAME.RANDOM.part`, for writing. Missing folders are made.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn create(path: &Path) -> Result<(Self, File)> {
        let io = |source| Error::io(path, source);
        let name = path
            .file_name()
            .ok_or_else(|| io(std::io::ErrorKind::InvalidFilename.into()))?;
        let folder = folder_of(path);
        fs::create_dir_all(folder).map_err(io)?;
        let prefix = format!(".{}.", name.to_string_lossy());
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(".part");
        // Readable as any other new file is; the default is the owner's alone.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let (file, neighbour) = builder.tempfile_in(folder).map_err(io)?.into_parts();
        let path = path.to_owned();
        Ok((Self { path, neighbour }, file))
    }

    /// Flushes to disk and renames. `file` is the one from [`Self::create`], with everything written to it.
    ///
    /// # Errors
    /// [`Error::Io`]; the old file, if any, is then untouched.
    pub fn keep(self, file: &File) -> Result<()> {
        let Self { path, neighbour } = self;
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

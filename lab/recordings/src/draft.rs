//! A file that appears whole or not at all.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// A neighbour of the file to be written, renamed over it once complete. Whatever happens before, power cut included, the
/// path holds the old file or none.
#[derive(Debug)]
pub struct Draft {
    path: PathBuf,
    draft: PathBuf,
    kept: bool,
}

impl Draft {
    /// Opens the neighbour for writing. Missing folders are made.
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
        let draft = folder.join(format!(
            ".{}.{}.part",
            name.to_string_lossy(),
            std::process::id()
        ));
        let file = File::create(&draft).map_err(io)?;
        let draft = Self {
            path: path.to_owned(),
            draft,
            kept: false,
        };
        Ok((draft, file))
    }

    /// Flushes to disk and renames. `file` is the one from [`Self::create`], with everything written to it.
    ///
    /// # Errors
    /// [`Error::Io`]; the old file, if any, is then untouched.
    pub fn keep(mut self, file: &File) -> Result<()> {
        file.sync_all()
            .and_then(|()| fs::rename(&self.draft, &self.path))
            .map_err(|source| Error::io(&self.path, source))?;
        self.kept = true;
        // The rename itself is durable once the folder is; not every platform can open a folder.
        if let Ok(opened) = File::open(folder_of(&self.path)) {
            let _ = opened.sync_all();
        }
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if !self.kept {
            let _ = fs::remove_file(&self.draft);
        }
    }
}

fn folder_of(path: &Path) -> &Path {
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
    use std::io::Write;
    let (draft, mut file) = Draft::create(path)?;
    file.write_all(bytes)
        .map_err(|source| Error::io(path, source))?;
    draft.keep(&file)
}

//! The session file: parsing, the paths in it, and the line and key of an error.

use std::path::{Path, PathBuf};

use super::entry::Entry;
use super::place;
use super::schema::Session;
use crate::error::{Error, Result};
use crate::kind::Kind;
use crate::whole::read_text;

/// A session file that has been read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionFile {
    /// Its path.
    pub path: PathBuf,
    /// Its text, for the line of a later error and for provenance.
    pub text: String,
    /// Its contents.
    pub session: Session,
}

impl SessionFile {
    /// Reads and checks a session file.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read; [`Error::OtherKind`] for another of the project's files; [`Error::Session`] with line and key for text that is no TOML, for keys that are
    /// unknown or missing, and for values that are impossible.
    pub fn read(path: &Path) -> Result<Self> {
        let read = read_text(path).and_then(|text| Self::parse(path, text));
        read.map_err(|error| Kind::Session.refuses(path).unwrap_or(error))
    }

    /// Parses and checks a session from text; recordings are relative to `path`.
    ///
    /// # Errors
    /// [`Error::Session`], as [`Self::read`].
    pub fn parse(path: &Path, text: String) -> Result<Self> {
        let session: Session =
            toml::from_str(&text).map_err(|error| place::refused(path, &text, &error))?;
        let file = Self {
            path: path.to_owned(),
            text,
            session,
        };
        match file.session.check() {
            Ok(()) => Ok(file),
            Err(impossible) => Err(file.refuse(&impossible.key, impossible.cause)),
        }
    }

    /// Path of a recording.
    pub fn resolve(&self, file: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new(".")).join(file)
    }

    /// Whether a path in the session is this file.
    pub fn names(&self, listed: &Path, file: &Path) -> bool {
        let listed = self.resolve(listed);
        match (listed.canonicalize(), file.canonicalize()) {
            (Ok(a), Ok(b)) => a == b,
            _ => listed == file,
        }
    }

    /// A recording's entry: the same file, or else the only one of that name.
    pub fn entry(&self, recording: &Path) -> Option<&Entry> {
        let entries = &self.session.recording;
        if let Some(entry) = entries.iter().find(|e| self.names(&e.file, recording)) {
            return Some(entry);
        }
        let mut named = entries
            .iter()
            .filter(|entry| entry.file.file_name() == recording.file_name());
        match (named.next(), named.next()) {
            (Some(entry), None) => Some(entry),
            _ => None,
        }
    }

    /// The session's own file of an entry that another file is taken for by its name, if it has one.
    pub fn namesake(&self, entry: &Entry, recording: &Path) -> Option<PathBuf> {
        let own = self.resolve(&entry.file);
        (!self.names(&entry.file, recording) && own.exists()).then_some(own)
    }

    /// An error at a key such as `recording[3].direction`.
    pub fn refuse(&self, key: &str, cause: impl Into<String>) -> Error {
        Error::Session {
            path: self.path.clone(),
            line: place::line_of(&self.text, key),
            key: key.to_owned(),
            cause: cause.into(),
        }
    }
}

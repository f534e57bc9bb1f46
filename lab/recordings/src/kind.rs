//! What a file is that was named where another was expected.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::Error;
use crate::open;
use crate::whole::check_regular;

/// Bytes by which the project's own files are told: what they begin with, and a session after a long comment.
const HEAD: u64 = 1 << 14;

/// Files that a user names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// What `sixaxis calibrate` writes.
    Calibration,
    /// What it reads.
    Session,
    /// A page of a report.
    Page,
    /// What an instrument recorded.
    Recording,
}

impl Kind {
    /// What the file seems to be, by its first bytes and its name.
    fn of(path: &Path) -> Option<Self> {
        // A pipe would hold up whoever opens it.
        check_regular(path).ok()?;
        let mut head = Vec::new();
        let file = File::open(path).ok()?;
        file.take(HEAD).read_to_end(&mut head).ok()?;
        let text = String::from_utf8_lossy(&head);
        let begins = |what: &str| text.lines().any(|line| line.trim_start().starts_with(what));
        if text.trim_start().starts_with('{') {
            text.contains("\"sixaxis-calibration-")
                .then_some(Self::Calibration)
        } else if text.starts_with("<!") {
            Some(Self::Page)
        } else if begins("[sensor") || begins("[[recording") {
            Some(Self::Session)
        } else {
            open::format_of(path, &head).map(|_| Self::Recording)
        }
    }

    const fn in_words(self) -> &'static str {
        match self {
            Self::Calibration => "calibration (JSON, as `sixaxis calibrate` writes it)",
            Self::Session => "session file (TOML)",
            Self::Page => "page of a report (HTML)",
            Self::Recording => "recording",
        }
    }

    /// The refusal of a file that was to be of this kind and seems to be of another; none if nothing says so.
    pub fn refuses(self, path: &Path) -> Option<Error> {
        let other = Self::of(path).filter(|kind| *kind != self)?;
        Some(Error::OtherKind {
            path: path.to_owned(),
            expected: self.in_words(),
            found: other.in_words(),
        })
    }
}

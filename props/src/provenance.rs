//! Which code made a result, when, and by which command.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::results::{of_bytes, of_sources};

/// What stands beside a published result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// The commit that made it, with nothing changed since.
    pub commit: String,
    /// When.
    pub date_utc: String,
    /// The command that makes it anew.
    pub command: String,
    /// What it depends on, folder by folder.
    pub sources: Vec<Source>,
    /// Small runs of the same program over seeds of the result's own range: whether other code still makes the same bits is told by
    /// any of them, in seconds.
    pub samples: Vec<Sample>,
}

impl Provenance {
    /// Code that is not any more what it was.
    ///
    /// # Errors
    /// The path that cannot be read, and why.
    pub fn changed(&self) -> Result<Vec<&str>, String> {
        let mut changed = Vec::new();
        for source in &self.sources {
            if Source::now(&source.path)? != *source {
                changed.push(&source.path[..]);
            }
        }
        Ok(changed)
    }
}

/// Code that a result depends on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// Folder or file below the workspace's root.
    pub path: String,
    /// Its digest at the commit.
    pub digest: String,
}

impl Source {
    /// As it lies there now.
    ///
    /// # Errors
    /// The path and what the system says of it.
    pub fn now(path: &str) -> Result<Self, String> {
        let digest = of_sources(&workspace(), path).map_err(|e| format!("{path}: {e}"))?;
        Ok(Self {
            path: path.to_owned(),
            digest,
        })
    }
}

/// A small run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sample {
    /// First seed.
    pub first: u64,
    /// Number of seeds.
    pub count: u64,
    /// Digest of the result as JSON.
    pub digest: String,
}

/// The workspace that this was built in.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// What a command prints in the workspace, if there is such a command and it succeeds.
pub fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(workspace())
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

/// The commit that the workspace is at; behind it, where tracked files have been changed since, `-dirty-` and a digest of the
/// changes. `unknown` outside a checkout. Asked once a process.
pub fn revision() -> &'static str {
    static REVISION: LazyLock<String> = LazyLock::new(|| {
        let commit = output("git", &["rev-parse", "--short=12", "HEAD"]);
        let changes = output("git", &["diff", "HEAD"]);
        match (commit, changes) {
            (Some(commit), Some(changes)) if changes.is_empty() => commit,
            (Some(commit), Some(changes)) => {
                format!("{commit}-dirty-{}", &of_bytes(changes.bytes())[..8])
            }
            _ => "unknown".to_owned(),
        }
    });
    &REVISION
}

/// The time now as `2026-01-31T23:59:59Z`.
pub fn date_utc() -> String {
    chrono::DateTime::<chrono::Utc>::from(std::time::SystemTime::now())
        .to_rfc3339_opts(chrono::SecondsFormat::Secs, true)
}

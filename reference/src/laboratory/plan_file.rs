//! A plan as TOML: read with refusals that name file and line, and written whole, with comments, to start from.

use std::path::{Path, PathBuf};

use sixaxis_recordings::session::line_at;
use sixaxis_recordings::whole::read_text;
use thiserror::Error;
use toml::{Table, Value};

use super::defect::Kind;
use super::plan::SessionPlan;

/// A plan file that is refused.
#[derive(Debug, Error)]
#[error("{}{}: {cause}", path.display(), line.map(|l| format!(", line {l}")).unwrap_or_default())]
pub struct PlanFileError {
    /// The file.
    pub path: PathBuf,
    /// Line, from 1, where it is known.
    pub line: Option<usize>,
    /// What is wrong, and what would be right.
    pub cause: String,
}

/// Reads a plan; what it leaves out is as in [`SessionPlan::default`].
///
/// # Errors
/// [`PlanFileError`] for a file that cannot be read, text that is no TOML, keys that are not known and values of the wrong kind.
pub fn read(path: &Path) -> Result<SessionPlan, PlanFileError> {
    let text = read_text(path).map_err(|error| PlanFileError {
        path: path.to_owned(),
        line: None,
        cause: match error {
            sixaxis_recordings::Error::Io { source, .. } => source.to_string(),
            other => other.to_string(),
        },
    })?;
    parse(path, &text)
}

/// The same from text; `path` is what errors name.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, text: &str) -> Result<SessionPlan, PlanFileError> {
    toml::from_str(text).map_err(|e| PlanFileError {
        path: path.to_owned(),
        line: e.span().map(|span| line_at(text, span.start)),
        cause: e.message().to_owned(),
    })
}

/// A complete plan file: a line that is no comment, section or blank is a key, whose value is still to come.
const TEMPLATE: &str = include_str!("plan_file.txt");

/// The plan with every key and what it means; [`parse`] makes the same plan of it.
pub fn with_comments(plan: &SessionPlan) -> String {
    // A seed above 2^63 has no form in TOML: it is left out, and has its default.
    let writable = SessionPlan {
        seed: plan.seed.min(i64::MAX as u64),
        ..plan.clone()
    };
    let mut values = Table::try_from(writable).unwrap_or_default();
    if i64::try_from(plan.seed).is_err() {
        values.remove("seed");
    }
    let kinds: Vec<String> = Kind::ALL
        .chunks(5)
        .map(|row| {
            let names: Vec<&str> = row.iter().map(|kind| kind.name()).collect();
            format!("#   {}", names.join(", "))
        })
        .collect();
    let mut text = String::new();
    let mut section = &values;
    for line in TEMPLATE.lines() {
        if let Some(name) = line.strip_prefix('[').and_then(|l| l.strip_suffix(']')) {
            section = values
                .get(name)
                .and_then(Value::as_table)
                .unwrap_or(&values);
        }
        if line == "KINDS" {
            text += &(kinds.join(",\n") + ",\n");
        } else if line.is_empty() || line.starts_with(['#', '[']) {
            text += &format!("{line}\n");
        } else if let Some(value) = section.get(line) {
            text += &format!("{line} = {value}\n");
        }
    }
    text
}

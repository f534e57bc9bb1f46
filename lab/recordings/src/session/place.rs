//! Where in a session file, or another TOML text, something stands.

use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::check::BACKSLASH;
use crate::error::Error;

/// A parser's refusal with its line and, as far as it can be told, its key.
pub fn refused(path: &Path, text: &str, error: &toml::de::Error) -> Error {
    let span = error.span();
    let key = span
        .as_ref()
        .and_then(|span| key_at(text, span.start))
        .unwrap_or_else(|| "session".to_owned());
    Error::Session {
        path: path.to_owned(),
        line: span.map(|span| line_at(text, span.start)),
        key,
        cause: match error.message() {
            about if about.contains("escape") => format!("{about}: {BACKSLASH}"),
            message => message.to_owned(),
        },
    }
}

/// Line, from 1, of a key such as `recording[3].direction`. Of a key that is not there, the line of what should hold it.
pub fn line_of(text: &str, key: &str) -> Option<usize> {
    let document = DeTable::parse(text).ok()?;
    let mut line = None;
    let mut value: Option<&DeValue<'_>> = None;
    for part in key.split('.') {
        let (name, index) = match part.split_once('[') {
            Some((name, rest)) => (name, rest.trim_end_matches(']').parse::<usize>().ok()),
            None => (part, None),
        };
        let table = match value {
            None => document.get_ref(),
            Some(value) => match value.as_table() {
                Some(table) => table,
                None => return line,
            },
        };
        let Some((found_key, found)) = table.iter().find(|(k, _)| k.get_ref() == name) else {
            return line;
        };
        line = Some(line_at(text, found_key.span().start));
        value = Some(found.get_ref());
        if let Some(index) = index {
            let Some(element) = found
                .get_ref()
                .as_array()
                .and_then(|array| array.get(index))
            else {
                return line;
            };
            line = Some(line_at(text, element.span().start));
            value = Some(element.get_ref());
        }
    }
    line
}

/// Line, from 1, of a byte.
pub fn line_at(text: &str, byte: usize) -> usize {
    1 + text.as_bytes()[..byte.min(text.len())]
        .iter()
        .filter(|b| **b == b'\n')
        .count()
}

/// The word before `=` on the line of a byte, under the heading above it.
fn key_at(text: &str, byte: usize) -> Option<String> {
    let number = line_at(text, byte);
    let line = text.lines().nth(number - 1)?;
    let heading = text
        .lines()
        .take(number)
        .filter(|l| l.trim_start().starts_with('['))
        .last()
        .map(|l| l.trim().trim_matches(['[', ']']).to_owned());
    let word = line
        .split_once('=')
        .map(|(word, _)| word.trim().to_owned())
        .filter(|word| !word.is_empty());
    match (heading, word) {
        (Some(heading), Some(word)) => Some(format!("{heading}.{word}")),
        (heading, word) => word.or(heading),
    }
}

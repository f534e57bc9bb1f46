//! What the examples of this crate share: how they are asked, and how a result becomes one of `props/results`.

use std::path::Path;
use std::process::ExitCode;

use crate::results::Published;

/// The command line.
#[derive(Debug, Clone, PartialEq)]
pub struct Arguments(Vec<String>);

impl Arguments {
    /// As given to the running program.
    #[must_use]
    pub fn given() -> Self {
        Self(std::env::args().skip(1).collect())
    }

    /// Whether an option is there.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.0.iter().any(|argument| argument == name)
    }

    /// The word behind an option.
    #[must_use]
    pub fn text(&self, name: &str) -> Option<&str> {
        let at = self.0.iter().position(|argument| argument == name)?;
        self.0.get(at + 1).map(String::as_str)
    }

    /// The whole number behind an option, or another where the option is not there.
    ///
    /// # Errors
    /// An option with no number behind it.
    pub fn number(&self, name: &str, otherwise: u64) -> Result<u64, String> {
        let Some(at) = self.0.iter().position(|argument| argument == name) else {
            return Ok(otherwise);
        };
        let text = self.0.get(at + 1).map_or("", String::as_str);
        text.parse()
            .map_err(|_| format!("{name} wants a whole number and has {text:?}"))
    }

    /// Writes a result to its file if `--publish` is there.
    ///
    /// # Errors
    /// The file and what the system says of it.
    pub fn publish<P: Published>(&self, result: &P) -> Result<(), String> {
        if !self.has("--publish") {
            return Ok(());
        }
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("..")
            .join(P::FILE);
        let text = serde_json::to_string_pretty(result).map_err(|e| e.to_string())?;
        std::fs::write(&path, text + "\n").map_err(|e| format!("{}: {e}", path.display()))
    }
}

/// What the program ends with.
#[must_use]
pub fn end(result: Result<(), String>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_none_is_refused() {
        let given = |text: &str| Arguments(text.split(' ').map(str::to_owned).collect());
        assert_eq!(given("--count 7").number("--count", 1), Ok(7));
        assert_eq!(given("--first 7").number("--count", 1), Ok(1));
        assert!(given("--count seven").number("--count", 1).is_err());
        assert!(given("--count").number("--count", 1).is_err());
    }
}

//! What the examples of this crate share: how they are asked, and how a result becomes one of `props/results`.
//!
//! A study is a function of its seeds. `--publish` runs it over all of them, then over a few samples, and writes the result with its
//! [`Provenance`]. `--check` says what of the code it depends on has changed since, runs one of the samples again, drawn by the
//! commit that the workspace is at, and fails where that gives other bits than when it was published; `--check --all` runs all of them.

use std::path::Path;
use std::process::ExitCode;

use serde::Serialize;

use crate::provenance::{Provenance, Sample, Source, date_utc, output, revision, workspace};
use crate::results::{Studied, of_bytes};

/// Samples of a published result.
const SAMPLES: u64 = 8;
/// What every study is asked by.
const SWITCHES: [&str; 3] = ["--publish", "--check", "--all"];
/// The same with a number behind it.
const NUMBERS: [&str; 2] = ["--first", "--count"];

/// Seeds of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seeds {
    /// The first that is reported.
    pub first: u64,
    /// How many.
    pub count: u64,
    /// How many of them make a sample.
    pub sample: u64,
}

impl Seeds {
    /// So many from the first on, of which each alone makes a sample.
    pub const fn alone(first: u64, count: u64) -> Self {
        Self {
            first,
            count,
            sample: 1,
        }
    }
}

/// A program that does one study and has no options of its own: `--first` and `--count` give other seeds, `--publish` and `--check` are told above.
pub fn run<S: Studied>(seeds: Seeds, study: impl Fn(u64, u64) -> Result<S, String>) -> ExitCode {
    end(Arguments::given(&[]).and_then(|arguments| arguments.obey(seeds, study)))
}

/// The command line.
#[derive(Debug, Clone, PartialEq)]
pub struct Arguments(Vec<String>);

impl Arguments {
    /// As given to the running program, a study that has options of its `own` with something behind them.
    ///
    /// # Errors
    /// A word that is no option: hours of work would answer something else.
    pub fn given(own: &[&str]) -> Result<Self, String> {
        Self::checked(std::env::args().skip(1).collect(), own)
    }

    fn checked(words: Vec<String>, own: &[&str]) -> Result<Self, String> {
        let takes_a_word = |word: &str| NUMBERS.contains(&word) || own.contains(&word);
        let mut rest = words.iter().map(String::as_str);
        while let Some(word) = rest.next() {
            if takes_a_word(word) {
                rest.next();
            } else if !SWITCHES.contains(&word) {
                let options = [&SWITCHES[..], &NUMBERS, own].concat().join(", ");
                return Err(format!("no option {word:?}; there are {options}"));
            }
        }
        Ok(Self(words))
    }

    /// Whether an option is there.
    pub fn has(&self, name: &str) -> bool {
        self.0.iter().any(|argument| argument == name)
    }

    /// The word behind an option.
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

    /// Does what is asked of a study.
    ///
    /// # Errors
    /// What went wrong, in words.
    pub fn obey<S: Studied>(
        &self,
        seeds: Seeds,
        study: impl Fn(u64, u64) -> Result<S, String>,
    ) -> Result<(), String> {
        if self.has("--check") {
            return check(study, self.has("--all"));
        }
        let first = self.number("--first", seeds.first)?;
        let count = self.number("--count", seeds.count)?;
        let publish = self.has("--publish");
        if !publish {
            return study(first, count).map(drop);
        }
        // Of the code that runs, not of what is written meanwhile.
        let mut provenance = Provenance {
            commit: committed(S::SOURCES)?,
            date_utc: date_utc(),
            command: S::MAKE.to_owned(),
            sources: S::SOURCES
                .iter()
                .map(|path| Source::now(path))
                .collect::<Result<_, _>>()?,
            samples: Vec::new(),
        };
        let result = study(first, count)?;
        let step = (count / SAMPLES).max(1);
        for i in 0..SAMPLES.min(count) {
            let (first, count) = (first + i * step, seeds.sample);
            let digest = digest(&study(first, count)?)?;
            provenance.samples.push(Sample {
                first,
                count,
                digest,
            });
        }
        write(S::FILE, &File { provenance, result })
    }
}

/// A published file.
#[derive(Debug, Clone, PartialEq, Serialize, serde::Deserialize)]
pub struct File<S> {
    /// Where the result is from.
    pub provenance: Provenance,
    /// The result.
    pub result: S,
}

/// Digest of a result.
fn digest(result: &impl Serialize) -> Result<String, String> {
    let text = serde_json::to_vec(result).map_err(|e| e.to_string())?;
    Ok(of_bytes(text))
}

fn write(file: &str, content: &impl Serialize) -> Result<(), String> {
    let path = workspace().join(file);
    let text = serde_json::to_string_pretty(content).map_err(|e| e.to_string())?;
    std::fs::write(&path, text + "\n").map_err(|e| format!("{}: {e}", path.display()))
}

/// The commit that has the code as it lies there: a published figure names it.
fn committed(sources: &[&str]) -> Result<String, String> {
    let asked = [&["status", "--porcelain", "--"], sources].concat();
    match (
        output("git", &["rev-parse", "--short=12", "HEAD"]),
        output("git", &asked),
    ) {
        (Some(commit), Some(changes)) if changes.is_empty() => Ok(commit),
        (_, Some(changes)) if !changes.is_empty() => Err(format!(
            "commit first, so that the result can name its code:\n{changes}"
        )),
        _ => Err("results are published from a checkout".to_owned()),
    }
}

/// What has changed since a result was published, and whether that changes the result.
fn check<S: Studied>(
    study: impl Fn(u64, u64) -> Result<S, String>,
    all: bool,
) -> Result<(), String> {
    let published = S::file()
        .map_err(|e| format!("{}: {e}", S::FILE))?
        .provenance;
    let name = Path::new(S::FILE).file_name().unwrap_or_default().display();
    let since = match &published.changed()?[..] {
        [] => "its code is unchanged".to_owned(),
        changed => format!("changed since: {}", changed.join(", ")),
    };
    let from = format!(
        "{name}: published at {} on {}, {since}",
        published.commit, published.date_utc
    );
    let samples = &published.samples[..];
    let drawn = u64::from_str_radix(&of_bytes(revision().bytes()), 16).unwrap_or(0);
    let samples = match (drawn.checked_rem(samples.len() as u64), all) {
        (None, _) => return Err(format!("{from}; it has no samples")),
        (Some(_), true) => samples,
        (Some(drawn), false) => &samples[drawn as usize..=drawn as usize],
    };
    for sample in samples {
        let last = sample.first + sample.count - 1;
        let seeds = format!("seeds {} to {last} once more", sample.first);
        let now = digest(&study(sample.first, sample.count)?)?;
        if now != sample.digest {
            return Err(format!(
                "{from}; {seeds}: OTHER BITS ({now}, then {}). Publish it again: {}",
                sample.digest,
                S::MAKE
            ));
        }
        eprintln!("{from}; {seeds}: the same bits");
    }
    Ok(())
}

/// What the program ends with.
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

    #[test]
    fn a_word_that_is_no_option_is_refused() {
        let given = |text: &str| {
            let words = text.split(' ').map(str::to_owned).collect();
            Arguments::checked(words, &["--rows"]).is_ok()
        };
        for allowed in ["--publish", "--check --all", "--first 7 --rows --help"] {
            assert!(given(allowed), "{allowed}");
        }
        for refused in ["--help", "--count 7 8", "--merge rows.json"] {
            assert!(!given(refused), "{refused}");
        }
    }
}

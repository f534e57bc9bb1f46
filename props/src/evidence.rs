//! Every comparison as a row, so that margins can be seen and not only that nothing failed.
//!
//! A suite is one module of a test program. Its rows go to `target/evidence/<suite>.csv`, which each run of the suite
//! writes anew. [`Row::judge`] writes before it judges, so that a failed comparison is in the file, too. [`Quantiles`] are
//! read back from the file, and gates hold against them. `sixaxis report` draws all the files as its Evidence section and
//! keeps them as one, `evidence.csv`.
//!
//! The test harness names each test's thread `module::test`, which is where a row takes its suite and its case from. A
//! thread of a pool has no such name: hand the error back to the test and compare it there.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use crate::provenance::revision;
use crate::tolerance::{Gate, Tolerance};

/// One comparison.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The code that was tested: [`revision`].
    #[serde(default)]
    pub commit: String,
    /// Module of the test.
    pub suite: String,
    /// Test, and within it the case.
    pub case: String,
    /// What is compared.
    pub quantity: String,
    /// Unit of `truth` and `ours`; empty for a pure number.
    pub unit: String,
    /// The reference's value where the error is largest.
    pub truth: Option<f64>,
    /// The core's value there.
    pub ours: Option<f64>,
    /// Magnitude of the error in the measure of the limit, mostly over full scale.
    pub error: f64,
    /// The reference's own error in the same measure: what halving its step changes.
    pub reference_error: Option<f64>,
    /// Limit that the error is held to.
    pub limit: f64,
    /// Why the limit is what it is, in words.
    #[serde(default)]
    pub reason: String,
    /// For a negative control, the factor by which the error must exceed the limit.
    #[serde(default)]
    pub control: Option<f64>,
}

impl Row {
    /// A row of the running test about `quantity`.
    ///
    /// # Panics
    /// On a thread that is not a test's.
    pub fn new(quantity: impl Into<String>, error: f64, tolerance: Tolerance) -> Self {
        let (suite, case) = running();
        Self::of(&suite, case, quantity, error, tolerance)
    }

    /// A row of a suite and a case by name: for comparisons that no test makes.
    pub fn of(
        suite: &str,
        case: impl Into<String>,
        quantity: impl Into<String>,
        error: f64,
        tolerance: Tolerance,
    ) -> Self {
        Self {
            commit: revision().to_owned(),
            suite: suite.to_owned(),
            case: case.into(),
            quantity: quantity.into(),
            unit: String::new(),
            truth: None,
            ours: None,
            error,
            reference_error: None,
            limit: tolerance.limit,
            reason: tolerance.reason.to_string(),
            control: None,
        }
    }

    /// Names the case within the test.
    #[must_use]
    pub fn case(mut self, case: impl std::fmt::Display) -> Self {
        self.case = format!("{}: {case}", self.case);
        self
    }

    /// Adds both sides of the comparison.
    #[must_use]
    pub fn sides(mut self, truth: f64, ours: f64, unit: &str) -> Self {
        (self.truth, self.ours, self.unit) = (Some(truth), Some(ours), unit.to_owned());
        self
    }

    /// Adds the reference's own error. The limit is what is allowed *beyond* it.
    #[must_use]
    pub fn beyond(mut self, reference_error: f64) -> Self {
        self.reference_error = Some(reference_error);
        self
    }

    /// Makes the row a negative control: something is broken on purpose, and the error must be at least `factor` limits.
    #[must_use]
    pub fn control(mut self, factor: f64) -> Self {
        self.control = Some(factor);
        self
    }

    /// Error over what is allowed: the limit and, where it stands beside the comparison, the reference's own error.
    /// NaN for an error that is NaN.
    pub fn share(&self) -> f64 {
        self.error / (self.limit + self.reference_error.unwrap_or(0.0))
    }

    /// Whether a comparison is within its limit, or a negative control far enough beyond it. False for NaN, and for a
    /// negative error, which is no magnitude.
    pub fn holds(&self) -> bool {
        match self.control {
            None => (0.0..=1.0).contains(&self.share()),
            Some(factor) => self.error >= factor * self.limit,
        }
    }

    /// Writes the row, then asserts that it [`holds`](Self::holds).
    ///
    /// # Panics
    /// If it does not.
    pub fn judge(self) {
        let row = self.recorded();
        assert!(
            row.holds(),
            "{}: error {:.3e}, {} {:.3e} beyond the reference's own {:.1e} ({}) in {}",
            row.quantity,
            row.error,
            match row.control {
                None => "allowed is 0 to".to_owned(),
                Some(factor) => format!("broken on purpose it must be {factor} times"),
            },
            row.limit,
            row.reference_error.unwrap_or(0.0),
            row.reason,
            row.case,
        );
    }

    /// Writes the row without judging it: for suites whose gates are quantiles.
    pub fn recorded(self) -> Self {
        if std::env::var_os("SIXAXIS_RESIDUALS").is_some() {
            eprintln!(
                "residual: {}: {:.3e} of {:.3e}, margin {:.3}",
                self.quantity,
                self.error,
                self.limit,
                self.share().recip()
            );
        }
        write(&self);
        self
    }
}

/// Distribution of the errors of one quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// Number of rows.
    pub count: usize,
    /// Median.
    pub median: f64,
    /// 99 % lie below.
    pub q99: f64,
    /// Largest.
    pub max: f64,
}

impl Quantiles {
    /// Of any set of numbers; NaN counts as larger than all. None of an empty set.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values
            .into_iter()
            .map(|v| if v.is_nan() { f64::INFINITY } else { v })
            .collect();
        values.sort_by(f64::total_cmp);
        // Nearest rank: the smallest value that at least this share does not exceed.
        let at = |share: f64| {
            let rank = (share * values.len() as f64).ceil() as usize;
            values.get(rank.max(1) - 1).copied()
        };
        Some(Self {
            count: values.len(),
            median: at(0.5)?,
            q99: at(0.99)?,
            max: at(1.0)?,
        })
    }

    /// Asserts that the distribution is within a gate.
    ///
    /// # Panics
    /// If a quantile is beyond its limit.
    pub fn judge(&self, what: &str, gate: Gate) {
        assert!(
            self.median <= gate.median && self.q99 <= gate.q99 && self.max <= gate.max,
            "{what}: {self} is beyond {gate:?}"
        );
    }
}

impl std::fmt::Display for Quantiles {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            count,
            median,
            q99,
            max,
        } = self;
        write!(
            f,
            "median {median:.1e}, 99 % {q99:.1e}, largest {max:.1e} of {count}"
        )
    }
}

/// Folder of the evidence: `target/evidence`, unless `SIXAXIS_EVIDENCE` names another.
pub fn folder() -> PathBuf {
    std::env::var_os("SIXAXIS_EVIDENCE").map_or_else(
        || PathBuf::from(env!("SIXAXIS_EVIDENCE_DIR")),
        PathBuf::from,
    )
}

/// The rows that this run of the running test's suite has written so far: what gates are read from.
///
/// # Errors
/// Those of [`read_file`].
///
/// # Panics
/// On a thread that is not a test's.
pub fn written() -> Result<Vec<Row>, csv::Error> {
    read_file(&file_of(&running().0))
}

/// All rows of one file.
///
/// # Errors
/// If it cannot be read, or holds a line that is no row; the error names the line.
pub fn read_file(path: &Path) -> Result<Vec<Row>, csv::Error> {
    csv::Reader::from_path(path)?.deserialize().collect()
}

/// All rows of a folder, file by file in order of name; none if there is no such folder.
///
/// # Errors
/// Those of [`read_file`].
pub fn read_folder(folder: &Path) -> Result<Vec<Row>, csv::Error> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Ok(Vec::new());
    };
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "csv"))
        .collect();
    files.sort();
    let rows: Result<Vec<_>, _> = files.iter().map(|path| read_file(path)).collect();
    Ok(rows?.into_iter().flatten().collect())
}

/// Rows as the text of one file.
///
/// # Errors
/// If a row cannot be written, which no finite or infinite number is a reason for.
pub fn to_csv(rows: &[Row]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    Ok(writer.into_inner().map_err(|e| e.into_error())?)
}

/// Suite and case of the running test: its module, and its path within that.
fn running() -> (String, String) {
    let thread = std::thread::current();
    let (suite, case) = thread
        .name()
        .and_then(|name| name.split_once("::"))
        .expect("rows are made on the thread of a test in a module, not on one of a pool");
    (suite.to_owned(), case.to_owned())
}

fn file_of(suite: &str) -> PathBuf {
    folder().join(suite).with_extension("csv")
}

/// Appends one line to the suite's file, which the first row of a run begins anew. A folder that cannot be written to
/// costs the evidence, not the test.
fn write(row: &Row) {
    static FILES: LazyLock<Mutex<HashMap<String, Option<File>>>> = LazyLock::new(Mutex::default);
    let mut files = FILES.lock().unwrap_or_else(PoisonError::into_inner);
    let first = !files.contains_key(&row.suite);
    let file = files.entry(row.suite.clone()).or_insert_with(|| {
        let path = file_of(&row.suite);
        fs::create_dir_all(folder())
            .and_then(|()| File::create(&path))
            .inspect_err(|e| eprintln!("no evidence is kept: {}: {e}", path.display()))
            .ok()
    });
    let Some(file) = file else { return };
    let mut line = csv::WriterBuilder::new()
        .has_headers(first)
        .from_writer(Vec::new());
    if line.serialize(row).is_ok()
        && let Ok(line) = line.into_inner()
    {
        // One write a line, so that another process never reads half of one.
        let _ = file.write_all(&line);
    }
}

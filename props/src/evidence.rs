//! Every comparison as a row, so that margins can be seen and not only that nothing failed.
//!
//! A suite is a test binary; its rows go to `target/evidence/<suite>.csv`, written anew by each run of that binary.
//! [`Row::judge`] writes before it judges, so that a failed comparison is in the file, too. [`Quantiles`] are read back
//! from the file, and gates hold against them. `sixaxis report` draws all the files as its Evidence section and keeps
//! them as one, `evidence.csv`.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

use serde::{Deserialize, Serialize};

use crate::tolerance::{Gate, Tolerance};

/// One comparison.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Test binary.
    pub suite: String,
    /// Test, and within it the case.
    pub case: String,
    /// What is compared.
    pub quantity: String,
    /// Unit of `truth` and `ours`; empty for a pure number.
    pub unit: String,
    /// What the reference says where the error is largest.
    pub truth: Option<f64>,
    /// What the core says there.
    pub ours: Option<f64>,
    /// Error in the measure of the limit, mostly over full scale.
    pub error: f64,
    /// The reference's own error in the same measure: what halving its step changes.
    pub reference_error: Option<f64>,
    /// Limit that the error is held to.
    pub limit: f64,
}

impl Row {
    /// A row of the running test about `quantity`.
    #[must_use]
    pub fn new(quantity: impl Into<String>, error: f64, limit: f64) -> Self {
        Self {
            suite: suite(),
            case: std::thread::current().name().unwrap_or("main").to_owned(),
            quantity: quantity.into(),
            unit: String::new(),
            truth: None,
            ours: None,
            error,
            reference_error: None,
            limit,
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

    /// Error over what is allowed: the limit and, where it stands beside the comparison, the reference's own error.
    /// NaN for an error that is none.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.error / (self.limit + self.reference_error.unwrap_or(0.0))
    }

    /// Writes the row, then asserts that the error is within its limit.
    ///
    /// # Panics
    /// If it is not, or is NaN.
    pub fn judge(self, tolerance: Tolerance) {
        let row = self.recorded();
        assert!(
            row.share() <= 1.0,
            "{}: error {:.3e} exceeds {:.3e} beyond the reference's own {:.1e} ({:?}) in {}",
            row.quantity,
            row.error,
            row.limit,
            row.reference_error.unwrap_or(0.0),
            tolerance.reason,
            row.case,
        );
    }

    /// Writes the row without judging it: for suites whose gates are quantiles.
    pub fn recorded(self) -> Self {
        if std::env::var_os("SIXAXIS_RESIDUALS").is_some() {
            eprintln!(
                "residual: {}: {:.3e} of {:.3e}",
                self.quantity, self.error, self.limit
            );
        }
        write(&self);
        self
    }
}

/// Distribution of the errors of one quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
    #[must_use]
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
#[must_use]
pub fn folder() -> PathBuf {
    std::env::var_os("SIXAXIS_EVIDENCE").map_or_else(
        || PathBuf::from(env!("SIXAXIS_EVIDENCE_DIR")),
        PathBuf::from,
    )
}

/// The rows that a test of this run has written so far: what gates are read from.
///
/// # Errors
/// Those of [`read_file`].
pub fn written() -> Result<Vec<Row>, csv::Error> {
    read_file(&folder().join(suite()).with_extension("csv"))
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

/// Name of the running test binary without cargo's hash.
fn suite() -> String {
    let name = std::env::current_exe()
        .ok()
        .and_then(|path| Some(path.file_stem()?.to_string_lossy().into_owned()))
        .unwrap_or_default();
    match name.rsplit_once('-') {
        Some((stem, hash)) if hash.len() == 16 && hash.bytes().all(|b| b.is_ascii_hexdigit()) => {
            stem.to_owned()
        }
        _ => name,
    }
}

/// Appends one line to this binary's file. A folder that cannot be written to costs the evidence, not the test.
fn write(row: &Row) {
    static FILE: OnceLock<Option<Mutex<File>>> = OnceLock::new();
    let file = FILE.get_or_init(|| {
        let folder = folder();
        let path = folder.join(suite()).with_extension("csv");
        match fs::create_dir_all(&folder).and_then(|()| File::create(&path)) {
            Ok(mut file) => {
                file.write_all(HEADER).ok()?;
                Some(Mutex::new(file))
            }
            Err(e) => {
                eprintln!("no evidence is kept: {}: {e}", path.display());
                None
            }
        }
    });
    let Some(file) = file else { return };
    let mut line = csv::WriterBuilder::new()
        .has_headers(false)
        .from_writer(Vec::new());
    if line.serialize(row).is_err() {
        return;
    }
    if let Ok(line) = line.into_inner() {
        // One write a line: rows of tests that run side by side do not mix.
        let _ = file
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .write_all(&line);
    }
}

const HEADER: &[u8] = b"suite,case,quantity,unit,truth,ours,error,reference_error,limit\n";

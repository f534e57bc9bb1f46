//! Formats of the calibration, and how their files are called.

use std::path::Path;

use anyhow::Result;
use clap::ValueEnum;

use crate::commands::common::not_understood;
use crate::commands::output::{JSON, PAGE};

/// A format of the calibration by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// What the other commands read
    Json,
    /// Constants for a firmware
    Rust,
}

impl Format {
    /// Refuses a calibration that is named as one of the other format, or as a page.
    pub fn check(self, out: &Path) -> Result<()> {
        let ends = |endings: &[&str]| {
            let ending = out.extension().unwrap_or_default();
            endings
                .iter()
                .any(|known| ending.eq_ignore_ascii_case(known))
        };
        let out = out.display();
        match self {
            Self::Json if ends(&["rs"]) => not_understood(format!(
                "--out: {out} is the name of a Rust source, and the calibration is written as JSON; add --format rust, or name a .json"
            )),
            Self::Rust if ends(JSON) => not_understood(format!(
                "--out: {out} is the name of a JSON file, and with --format rust a Rust source is written; leave --format out, or name a .rs"
            )),
            _ if ends(PAGE) => not_understood(format!(
                "--out: {out} is the name of a page and not of a calibration; the page is --report"
            )),
            _ => Ok(()),
        }
    }
}

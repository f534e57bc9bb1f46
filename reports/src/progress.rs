//! A progress bar with the time left; nothing at all when standard error is not a terminal.

use std::borrow::Cow;

use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressStyle};

/// The command's progress display.
#[derive(Debug, Default)]
pub struct Progress {
    hidden: bool,
}

impl Progress {
    /// Shown on a terminal.
    #[must_use]
    pub const fn shown() -> Self {
        Self { hidden: false }
    }

    /// Never shown.
    #[must_use]
    pub const fn hidden() -> Self {
        Self { hidden: true }
    }

    /// Starts a stage of `total` units of work.
    #[must_use]
    pub fn stage(&self, name: impl Into<Cow<'static, str>>, total: u64) -> Stage {
        self.bar(name, total, "{percent:>3} %")
    }

    /// The same for a long run of equal cases, with how many are done of how many, and how fast.
    #[must_use]
    pub fn counted(&self, name: impl Into<Cow<'static, str>>, total: u64) -> Stage {
        self.bar(name, total, "{pos}/{len}, {per_sec}")
    }

    /// Starts a stage of steps that are not alike.
    #[must_use]
    pub fn steps(&self, name: impl Into<Cow<'static, str>>) -> Steps {
        let template = "{prefix:>12} {pos} {msg:30} {elapsed_precise}";
        Steps {
            bar: self.line(name, None, template),
        }
    }

    fn bar(&self, name: impl Into<Cow<'static, str>>, total: u64, share: &str) -> Stage {
        let template =
            format!("{{prefix:>12}} [{{bar:40}}] {share}  {{elapsed_precise}}, {{eta}} left");
        Stage {
            bar: self.line(name, Some(total), &template),
        }
    }

    fn line(
        &self,
        name: impl Into<Cow<'static, str>>,
        total: Option<u64>,
        template: &str,
    ) -> ProgressBar {
        // indicatif draws to standard error and falls silent by itself when that is no terminal.
        let bar = match (self.hidden, total) {
            (true, _) => ProgressBar::hidden(),
            (false, Some(total)) => ProgressBar::new(total),
            (false, None) => ProgressBar::new_spinner(),
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_prefix(name);
        bar
    }
}

/// A stage of steps that are not alike: it says which one is being done. Dropping it leaves its line finished.
#[derive(Debug)]
pub struct Steps {
    bar: ProgressBar,
}

impl Steps {
    /// Does a step.
    ///
    /// # Errors
    /// Those of the step, with its name.
    pub fn step<T>(&self, name: &'static str, work: impl FnOnce() -> Result<T>) -> Result<T> {
        self.bar.set_message(name);
        let outcome = work().context(name);
        self.bar.inc(1);
        outcome
    }
}

impl Drop for Steps {
    fn drop(&mut self) {
        self.bar.finish_with_message("done");
    }
}

/// One stage; dropping it leaves its line finished.
#[derive(Debug)]
pub struct Stage {
    bar: ProgressBar,
}

impl Stage {
    /// Adds finished work. May be called from any thread.
    pub fn advance(&self, units: u64) {
        self.bar.inc(units);
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        self.bar.finish();
    }
}

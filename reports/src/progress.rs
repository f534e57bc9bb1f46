//! A progress bar with the time left; nothing at all when standard error is not a terminal.

use std::borrow::Cow;

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

    fn bar(&self, name: impl Into<Cow<'static, str>>, total: u64, share: &str) -> Stage {
        let bar = if self.hidden {
            ProgressBar::hidden()
        } else {
            // indicatif draws to standard error and falls silent by itself when that is no terminal.
            ProgressBar::new(total)
        };
        if let Ok(style) = ProgressStyle::with_template(&format!(
            "{{prefix:>12}} [{{bar:40}}] {share}  {{elapsed_precise}}, {{eta}} left"
        )) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_prefix(name);
        Stage { bar }
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

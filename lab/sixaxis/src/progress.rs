//! A progress bar with the time left; nothing at all when standard error is not a terminal.

use std::sync::{Mutex, MutexGuard, PoisonError};

use indicatif::{ProgressBar, ProgressStyle};
use sixaxis_calibration::progress;

/// How far the command is: one stage at a time, told from any thread.
#[derive(Debug)]
pub struct Progress {
    hidden: bool,
    stage: Mutex<Option<(String, ProgressBar)>>,
}

impl Progress {
    /// Shown on a terminal unless `quiet`.
    pub const fn new(quiet: bool) -> Self {
        Self {
            hidden: quiet,
            stage: Mutex::new(None),
        }
    }

    /// Shown on a terminal.
    pub const fn shown() -> Self {
        Self::new(false)
    }

    /// `units` more of a stage's `total` are done. The first report of a name ends the stage before it.
    pub fn report(&self, name: &str, total: u64, units: u64) {
        let mut stage = self.lock();
        if stage.as_ref().is_none_or(|(current, _)| current != name) {
            self.start(&mut stage, name, total, "{percent:>3} %");
        }
        drop(stage);
        self.advance(units);
    }

    /// A stage as the callback of a library.
    pub fn callback<'a>(&'a self, name: &'a str) -> impl Fn(u64, u64) + Sync + 'a {
        move |total, units| self.report(name, total, units)
    }

    /// Starts a long run of equal cases, shown with how many are done of how many, and how fast.
    pub fn counted(&self, name: &str, total: u64) {
        self.start(&mut self.lock(), name, total, "{pos}/{len}, {per_sec}");
    }

    /// `units` more of the current stage are done.
    pub fn advance(&self, units: u64) {
        if let Some((_, bar)) = self.lock().as_ref() {
            bar.inc(units);
        }
    }

    fn start(
        &self,
        stage: &mut Option<(String, ProgressBar)>,
        name: &str,
        total: u64,
        share: &str,
    ) {
        // The old one finishes its line before the new one begins.
        finish(stage);
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
        bar.set_prefix(name.to_owned());
        *stage = Some((name.to_owned(), bar));
    }

    fn lock(&self) -> MutexGuard<'_, Option<(String, ProgressBar)>> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn finish(stage: &mut Option<(String, ProgressBar)>) {
    if let Some((_, bar)) = stage.take() {
        bar.finish();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        finish(&mut self.lock());
    }
}

impl progress::Progress for Progress {
    fn stage(&self, name: &str, parts: usize) {
        self.report(name, parts as u64, 0);
    }

    fn part(&self) {
        self.advance(1);
    }
}

//! What `--iterate` adds to the summaries: k/m pass by pass, and what became of it.

use std::fmt::Write as _;

use serde::Serialize;
use sixaxis_calibration::iteration::{End, Iteration, Pass};
use sixaxis_core::identify::{Reason, Verdict};

use crate::commands::common::wrapped;

/// For scripts.
#[derive(Serialize)]
pub struct Repetition<'a> {
    sentence: String,
    /// None where a step refused its data.
    end: Option<End>,
    /// None unless it stands still.
    stiffness_per_mass_per_s2: Option<f64>,
    passes: &'a [Pass],
}

impl<'a> Repetition<'a> {
    /// Of a judgement's iteration.
    pub fn of(iteration: &'a Result<Iteration, String>) -> Self {
        match iteration {
            Ok(iteration) => Self {
                sentence: iteration.sentence(),
                end: Some(iteration.end),
                stiffness_per_mass_per_s2: iteration.stiffness_per_mass_per_s2(),
                passes: &iteration.passes,
            },
            Err(error) => Self {
                sentence: error.clone(),
                end: None,
                stiffness_per_mass_per_s2: None,
                passes: &[],
            },
        }
    }
}

/// For people.
pub fn print(out: &mut String, iteration: &Result<Iteration, String>) {
    out.push_str("\nSteps 2 to 4, repeated\n");
    let repetition = Repetition::of(iteration);
    if !repetition.passes.is_empty() {
        let _ = writeln!(
            out,
            "  {:>4}  {:>14}  {:>10}  {:>10}  step 4",
            "pass", "k/m, 1/s^2", "change s", "change I"
        );
    }
    for (number, pass) in repetition.passes.iter().enumerate() {
        let change = |change: Option<f64>| change.map_or("-".to_owned(), |c| format!("{c:.1e}"));
        let _ = writeln!(
            out,
            "  {number:>4}  {:>14.6e}  {:>10}  {:>10}  {}",
            pass.found_per_s2,
            change(pass.scale_change),
            change(pass.inertia_change),
            word(&pass.verdict)
        );
    }
    wrapped(out, "  ", "  ", &format!("{}.", repetition.sentence));
}

fn word(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Determined => "a minimum",
        Verdict::Undetermined { reason } => match reason {
            Reason::EdgeOfGrid => "an edge of the grid",
            Reason::Flat { .. } => "flat",
            Reason::Noise { .. } | Reason::Misfit { .. } => "noise",
        },
    }
}

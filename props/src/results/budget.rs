//! The budget of 7.479 %: what imperfections of sensor, rig and laboratory, one at a time, do to the decoupled accelerations.

use serde::{Deserialize, Serialize};

/// The paper's largest error after identification, of 18.
pub const PRINTED: f64 = 0.07479;

/// Compound runs of Tables 4 to 6 played by MuJoCo in imperfect laboratories.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Budget {
    /// First seed; an imperfection that is drawn takes as many from here on as it has draws.
    pub first_seed: u64,
    /// Trials for each of steps 2 to 4 in every laboratory.
    pub trials_per_step: usize,
    /// A laboratory without any of the imperfections.
    pub nothing: Errors,
    /// One imperfection after the other, each over its sizes.
    pub ladders: Vec<Ladder>,
    /// Several together that come near to [`PRINTED`].
    pub combinations: Vec<Combination>,
}

/// One imperfection over a ladder of sizes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Ladder {
    /// What is imperfect.
    pub name: String,
    /// What a size is measured in.
    pub unit: String,
    /// Laboratories at each size: more than one where the imperfection is drawn.
    pub draws: u64,
    /// Ascending.
    pub steps: Vec<Step>,
    /// Size that alone makes the largest error [`PRINTED`], open loop and identified on the same laboratory, by interpolation on
    /// log axes. None if none of the ladder does.
    pub alone: Option<f64>,
}

/// One size.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Step {
    /// The size, in the ladder's unit.
    pub size: f64,
    /// What it does.
    pub errors: Errors,
}

/// Several imperfections together, each at a size that does a part of the harm.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Combination {
    /// What they have in common.
    pub name: String,
    /// Each with its size and unit.
    pub parts: Vec<Part>,
    /// What they do together.
    pub errors: Errors,
}

/// An imperfection in a combination.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Part {
    /// Name of its ladder.
    pub name: String,
    /// Its size.
    pub size: f64,
    /// Unit of that.
    pub unit: String,
}

/// Errors of the decoupled accelerations against truth over the peak of the axis; of drawn imperfections the median laboratory's.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Errors {
    /// With the sensor's true parameters.
    pub with_truth: Treatments,
    /// With those that the four steps find in the same laboratory.
    pub identified: Treatments,
}

/// The same voltages, treated in two ways.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Treatments {
    /// Integrated as they are.
    pub open_loop: Cells,
    /// Six numbers taken off each run, so that it ends at rest where it began.
    pub corrected: Cells,
}

/// Of the 18 cells of Tables 4 to 6.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Cells {
    /// The largest.
    pub largest: f64,
    /// The median.
    pub median: f64,
}

impl Budget {
    /// The ladder of this name.
    #[must_use]
    pub fn ladder(&self, name: &str) -> Option<&Ladder> {
        self.ladders.iter().find(|ladder| ladder.name == name)
    }
}

impl Ladder {
    /// Size at which an error that grows along `points` crosses `error`, by interpolation on log axes.
    #[must_use]
    pub fn crossing(points: &[(f64, f64)], error: f64) -> Option<f64> {
        points.windows(2).find_map(|pair| {
            let [(x, y), (more, above)] = [pair[0], pair[1]];
            (y < error && above >= error).then(|| {
                let share = (error / y).ln() / (above / y).ln();
                x * (more / x).powf(share)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crossing_lies_on_the_power_law() {
        let points = [1.0, 10.0, 100.0].map(|x: f64| (x, 1e-4 * x * x));
        let found = Ladder::crossing(&points, 0.04).expect("between 10 and 100");
        assert!((found - 20.0).abs() < 20.0 * 1e-12, "{found}");
        assert_eq!(Ladder::crossing(&points, 10.0), None);
        assert_eq!(Ladder::crossing(&points, 1e-6), None);
    }
}

//! The budget of 7.479 %: what imperfections of sensor, rig and laboratory do to the decoupled accelerations.

use serde::{Deserialize, Serialize};

/// The paper's largest error after identification, of 18.
pub const PRINTED: f64 = 0.07479;

/// Compound runs of Tables 4 to 6 played in imperfect laboratories, one imperfection at a time and in combinations.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Budget {
    /// Trials for each of steps 2 to 4 in every laboratory.
    pub trials_per_step: usize,
    /// One after the other; draws of one size stand together.
    pub laboratories: Vec<Imperfect>,
}

/// A laboratory.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Imperfect {
    /// Its seed, which also says which of the study's laboratories it is.
    pub seed: u64,
    /// Whether MuJoCo played it, or the rigid engine.
    pub mujoco: bool,
    /// What is imperfect: nothing, one thing, or several together.
    pub parts: Vec<Part>,
    /// What that does; none where the four steps or the decoupling refuse, with the reason.
    pub errors: Option<Errors>,
    /// Why there are no errors.
    pub refused: Option<String>,
}

/// An imperfection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// What.
    pub name: String,
    /// How much.
    pub size: f64,
    /// In which unit.
    pub unit: String,
}

/// Errors of the decoupled accelerations against truth over the peak of the axis.
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

/// The laboratories of one imperfection.
#[derive(Debug, Clone)]
pub struct Ladder<'a> {
    /// Name.
    pub name: &'a str,
    /// Unit of the sizes.
    pub unit: &'a str,
    /// Ascending; the laboratories of each size.
    pub steps: Vec<(f64, Vec<&'a Imperfect>)>,
}

impl Budget {
    /// Imperfections that were played alone, in the study's order.
    pub fn ladders(&self) -> Vec<Ladder<'_>> {
        let mut ladders: Vec<Ladder<'_>> = Vec::new();
        for laboratory in &self.laboratories {
            let [part] = &laboratory.parts[..] else {
                continue;
            };
            if ladders.last().is_none_or(|last| last.name != part.name) {
                ladders.push(Ladder {
                    name: &part.name,
                    unit: &part.unit,
                    steps: Vec::new(),
                });
            }
            let Some(ladder) = ladders.last_mut() else {
                continue;
            };
            match ladder.steps.last_mut() {
                Some((size, draws)) if *size == part.size => draws.push(laboratory),
                _ => ladder.steps.push((part.size, vec![laboratory])),
            }
        }
        ladders
    }

    /// Laboratories without and with several imperfections: draws of the same ones together.
    pub fn combined(&self, several: bool) -> Vec<Vec<&Imperfect>> {
        let wanted = |parts: &[Part]| match several {
            true => parts.len() > 1,
            false => parts.is_empty(),
        };
        let mut groups: Vec<Vec<&Imperfect>> = Vec::new();
        for laboratory in self.laboratories.iter().filter(|l| wanted(&l.parts)) {
            match groups.last_mut() {
                Some(group) if group[0].parts == laboratory.parts => group.push(laboratory),
                _ => groups.push(vec![laboratory]),
            }
        }
        groups
    }
}

/// The median of a number over some laboratories; a refusal counts as an error without bound. None of no laboratories, and where
/// most refuse.
pub fn median_of(draws: &[&Imperfect], of: impl Fn(&Errors) -> f64) -> Option<f64> {
    let errors = draws.iter().map(|l| l.errors.as_ref());
    let mut values: Vec<f64> = errors.map(|e| e.map_or(f64::INFINITY, &of)).collect();
    values.sort_by(f64::total_cmp);
    let middle = values.get(values.len().checked_sub(1)? / 2)?;
    middle.is_finite().then_some(*middle)
}

/// What stands beside the paper's figure: identified, open loop, the largest of 18.
pub fn headline(errors: &Errors) -> f64 {
    errors.identified.open_loop.largest
}

impl Ladder<'_> {
    /// Sizes with the median laboratory's number.
    pub fn points(&self, of: impl Fn(&Errors) -> f64) -> Vec<(f64, f64)> {
        let steps = self.steps.iter();
        steps
            .filter_map(|(size, draws)| Some((*size, median_of(draws, &of)?)))
            .collect()
    }

    /// The two sizes next to each other between which a number passes [`PRINTED`]; none if none of the ladder does.
    pub fn alone(&self, of: impl Fn(&Errors) -> f64) -> Option<[f64; 2]> {
        crossing(&self.points(of), PRINTED)
    }
}

/// Between which of the `points` an error that grows along them passes `error`.
fn crossing(points: &[(f64, f64)], error: f64) -> Option<[f64; 2]> {
    points.windows(2).find_map(|pair| {
        let [(less, below), (more, above)] = [pair[0], pair[1]];
        (below < error && above >= error).then_some([less, more])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crossing_lies_between_two_sizes() {
        let points = [1.0, 10.0, 100.0].map(|x: f64| (x, 1e-4 * x * x));
        assert_eq!(crossing(&points, 0.04), Some([10.0, 100.0]));
        assert_eq!(crossing(&points, 10.0), None);
        assert_eq!(crossing(&points, 1e-6), None);
    }
}

//! The curve of step 4 from a few decodes: every candidate's mean |w*| by interpolation.
//!
//! A candidate k/m enters through the strains, which are proportional to y = 1/(k/m), and strains enter (3) and (8) as
//! additions of 1e-5 to what rigid limbs give. So w* at a sample is a power series in y whose terms fall by 1e-4 or so each:
//! four decodes fix its cubic, and what is left over is of the size of the last coefficient times 1e-4. That coefficient
//! is looked at, not trusted: where it is not small, all candidates are decoded one by one.
//!
//! The four values of y are Chebyshev's points of the range of candidates. Four candidates of two trials share the eight
//! lanes of [`crate::decouple::lanes`].

use ::wide::f64x4;
use alloc::vec;
use alloc::vec::Vec;
use pulp::{Arch, Simd, WithSimd};

use super::stiffness::rate_norm_sum;
use crate::decouple::lanes::{LaneSample, push_lanes};
use crate::decouple::stream::Decoupler;
use crate::error::Result;
use crate::float::{cos, sqrt};
use crate::geometry::LIMBS;
use crate::kernel::simd::{LANES, Register, Row, Wide};
use crate::kernel::vec3::{Vec3, vec3};
use crate::model::Parameters;
use crate::model::{Sensor, Settings};

/// Decodes per trial.
pub const NODES: usize = 4;
/// Largest cubic coefficient, over the largest |w*|, at which the interpolation stands. Coefficients fall by the same factor
/// from power to power, so the quartic one, which is what is neglected, is its power of 3/2: 3e-11.
const CUBIC_LIMIT: f64 = 1e-7;
/// First of the nine numbers of a lane sample that belong to w*.
const RATE: usize = 6;

/// One recording of pure linear motion above the threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial<'a> {
    /// Drawing, and gains of this recording.
    pub sensor: &'a Sensor,
    /// How to decouple it.
    pub settings: &'a Settings,
    /// Nine voltages a sample.
    pub voltage_v: &'a [[f64; LIMBS]],
}

/// What the search sums up.
#[derive(Debug, Clone, PartialEq)]
pub struct RateNorms {
    /// Sum of |w*| over all samples of all trials, rad/s, for each candidate.
    pub sums: Vec<f64>,
    /// Samples summed over.
    pub samples: usize,
}

/// Sum of |w*| over trials for candidates of k/m, s^-2.
///
/// Equals [`rate_norm_sum`] for each candidate within 1e-9 of the largest rate.
///
/// # Errors
/// Those of [`rate_norm_sum`].
pub fn rate_norm_sums(
    parameters: &Parameters,
    trials: &[Trial],
    candidates_per_s2: &[f64],
) -> Result<RateNorms> {
    let mut all = RateNorms {
        sums: vec![0.0; candidates_per_s2.len()],
        samples: 0,
    };
    for pair in trials.chunks(2) {
        let found = match interpolated(parameters, pair, candidates_per_s2)? {
            Some(found) => found,
            None => one_by_one(parameters, pair, candidates_per_s2)?,
        };
        for (sum, more) in all.sums.iter_mut().zip(found.sums) {
            *sum += more;
        }
        all.samples += found.samples;
    }
    Ok(all)
}

fn with_stiffness(parameters: &Parameters, stiffness_per_mass_per_s2: f64) -> Parameters {
    Parameters {
        stiffness_per_mass_per_s2,
        ..*parameters
    }
}

fn one_by_one(
    parameters: &Parameters,
    trials: &[Trial],
    candidates_per_s2: &[f64],
) -> Result<RateNorms> {
    let mut sums = Vec::with_capacity(candidates_per_s2.len());
    let mut samples = 0;
    for &candidate in candidates_per_s2 {
        let parameters = with_stiffness(parameters, candidate);
        let (mut sum, mut count) = (0.0, 0);
        for t in trials {
            let (more, n) = rate_norm_sum(t.sensor, &parameters, t.settings, t.voltage_v)?;
            sum += more;
            count += n;
        }
        sums.push(sum);
        samples = count;
    }
    Ok(RateNorms { sums, samples })
}

/// Nothing if the rates are no cubic in 1/(k/m), or a sample is refused on the way.
fn interpolated(
    parameters: &Parameters,
    pair: &[Trial],
    candidates_per_s2: &[f64],
) -> Result<Option<RateNorms>> {
    let compliances = candidates_per_s2.iter().map(|k| 1.0 / k);
    let low = compliances.clone().fold(f64::INFINITY, f64::min);
    let high = compliances.fold(0.0, f64::max);
    let worth_it = candidates_per_s2.len() > NODES && low < high && high.is_finite() && low > 0.0;
    let ([first] | [first, ..]) = pair else {
        return Ok(None);
    };
    let second = pair.last().unwrap_or(first);
    let twins = second.settings.scheme == first.settings.scheme;
    if !(worth_it && twins) {
        return Ok(None);
    }
    // Chebyshev's points, and cosines by which their values give his coefficients.
    let angle = |node: usize| (2 * node + 1) as f64 * core::f64::consts::PI / (2 * NODES) as f64;
    let y = |node: usize| 0.5 * (low + high) + 0.5 * (high - low) * cos(angle(node));
    let mut streams = Vec::with_capacity(LANES);
    for trial in [first, second] {
        for node in 0..NODES {
            let parameters = with_stiffness(parameters, 1.0 / y(node));
            streams.push(Decoupler::new(trial.sensor, &parameters, trial.settings)?);
        }
    }
    let Ok(mut streams) = <[Decoupler; LANES]>::try_from(streams) else {
        return Ok(None);
    };
    let weights = weights(candidates_per_s2, core::array::from_fn(y));
    let mut sums = Sums::new(weights, core::array::from_fn(|n| cos(3.0 * angle(n))));
    // Together for as long as both last, then the longer one beside itself.
    let together = first.voltage_v.len().min(second.voltage_v.len());
    let head = [first, second].map(|t| &t.voltage_v[..together]);
    let rows = core::array::from_fn(|lane| head[lane / NODES]);
    let alone = pair.len() == 1;
    sums.trials = if alone { [true, false] } else { [true, true] };
    if push_lanes(&mut streams, rows, &mut |chunk| sums.add(chunk)).is_err() {
        return Ok(None);
    }
    for (which, trial) in [first, second].into_iter().enumerate() {
        let rest = &trial.voltage_v[together..];
        sums.trials = [which == 0, which == 1];
        if push_lanes(&mut streams, [rest; LANES], &mut |chunk| sums.add(chunk)).is_err() {
            return Ok(None);
        }
    }
    Ok(sums.finish(candidates_per_s2.len()))
}

/// Lagrange's weight of each node in each candidate, eight candidates to a row.
fn weights(candidates_per_s2: &[f64], y: [f64; NODES]) -> Vec<[Row; NODES]> {
    candidates_per_s2
        .chunks(LANES)
        .map(|eight| {
            core::array::from_fn(|node| {
                let mut row = Row::ZERO;
                for (weight, k) in row.0.iter_mut().zip(eight) {
                    let others = (0..NODES).filter(|&other| other != node);
                    *weight = others
                        .map(|other| (1.0 / k - y[other]) / (y[node] - y[other]))
                        .product();
                }
                row
            })
        })
        .collect()
}

struct Sums {
    weights: Vec<[Row; NODES]>,
    sums: Vec<Row>,
    cubic_cosines: [f64; NODES],
    cubic_squared: f64,
    largest_squared: f64,
    /// Whose lanes count.
    trials: [bool; 2],
    samples: usize,
}

impl Sums {
    fn new(weights: Vec<[Row; NODES]>, cubic_cosines: [f64; NODES]) -> Self {
        Self {
            sums: vec![Row::ZERO; weights.len()],
            weights,
            cubic_cosines,
            cubic_squared: 0.0,
            largest_squared: 0.0,
            trials: [true; 2],
            samples: 0,
        }
    }

    fn add(&mut self, chunk: &[LaneSample]) {
        Arch::new().dispatch(Add { sums: self, chunk });
    }

    /// Nothing if the cubic is not small; written so that NaN is not.
    fn finish(self, candidates: usize) -> Option<RateNorms> {
        let small = sqrt(self.cubic_squared) <= CUBIC_LIMIT * sqrt(self.largest_squared);
        let sums: Vec<f64> = self
            .sums
            .iter()
            .flat_map(|row| row.0)
            .take(candidates)
            .collect();
        let finite = sums.iter().all(|sum| sum.is_finite());
        (small && finite).then_some(RateNorms {
            sums,
            samples: self.samples,
        })
    }
}

struct Add<'a> {
    sums: &'a mut Sums,
    chunk: &'a [LaneSample],
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if S::IS_SCALAR {
            add::<f64x4>((), self.sums, self.chunk);
        } else {
            add::<Wide<S>>(simd, self.sums, self.chunk);
        }
    }
}

#[inline(always)]
fn add<R: Register>(proof: R::Proof, sums: &mut Sums, chunk: &[LaneSample]) {
    for sample in chunk {
        for (trial, counts) in sums.trials.into_iter().enumerate() {
            if !counts {
                continue;
            }
            sums.samples += 1;
            let first = trial * NODES;
            let mut nodes = [Vec3::all(R::splat(proof, 0.0)); NODES];
            let mut cubic = [0.0; 3];
            for (n, node) in nodes.iter_mut().enumerate() {
                let at = |axis: usize| sample[RATE + axis].0[first + n];
                let w = [at(0), at(1), at(2)];
                let squares = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
                sums.largest_squared = sums.largest_squared.max(squares);
                for (sum, w) in cubic.iter_mut().zip(w) {
                    *sum += sums.cubic_cosines[n] * w * (2.0 / NODES as f64);
                }
                *node = vec3(
                    R::splat(proof, w[0]),
                    R::splat(proof, w[1]),
                    R::splat(proof, w[2]),
                );
            }
            let squares = cubic[0] * cubic[0] + cubic[1] * cubic[1] + cubic[2] * cubic[2];
            // Written so that NaN stays, as a maximum would not let it.
            let smaller = squares <= sums.cubic_squared;
            if !smaller {
                sums.cubic_squared = squares;
            }
            for (sum, weight) in sums.sums.iter_mut().zip(&sums.weights) {
                for part in 0..R::PARTS {
                    let [a, b, c, d] = nodes;
                    let ab = b.times_plus(
                        R::load(proof, &weight[1], part),
                        a.times(R::load(proof, &weight[0], part)),
                    );
                    let abc = c.times_plus(R::load(proof, &weight[2], part), ab);
                    let w = d.times_plus(R::load(proof, &weight[3], part), abc);
                    let norm = w.dot(w).root();
                    (R::load(proof, sum, part) + norm).store(sum, part);
                }
            }
        }
    }
}

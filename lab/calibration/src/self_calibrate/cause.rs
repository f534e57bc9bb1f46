//! Why a recording leaves scale ratios open: whether its motion is too poor, or its channels contradict each other.
//!
//! The fit of the ratios weights the coordination equations by what they leave. Where a channel is wrong they leave more than noise,
//! and ratios that the motion determines look open. Therefore two questions are asked of the scatter of the block means, apart
//! from the fit: whether the equations leave more than the noise that the calibration states, and whether the motion would determine
//! the ratios if that noise were all.

use nalgebra::{Matrix3, SMatrix, SVector};
use serde::Serialize;
use sixaxis_core::LIMBS;
use sixaxis_core::redundancy::parity::{ROWS, SIGNATURES};
use sixaxis_core::redundancy::self_calibration::{Limits, PerLimbs, RATIOS};

/// Change of a scale factor, standard deviation, that is taken for possible: what drift and unequal limbs explain is no contradiction.
const DRIFT_SD: f64 = 0.1;
/// What the equations leave, over the noise, from which channels contradict each other: noise of a few hertz is not white.
const CONTRADICTION: f64 = 3.0;
/// Variance of a channel that is not believed, over the largest of the others.
const NOT_BELIEVED: f64 = 1e8;
/// Weight, over the largest other one, that keeps the common factor where it is.
const KEPT: f64 = 1e6;

/// Signs of the strains in the equations.
type Rows = SMatrix<f64, LIMBS, ROWS>;

/// Why ratios are open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The motion does not excite them, and the channels agree.
    Motion,
    /// The channels contradict each other in a motion that would do.
    Channels,
    /// The channels contradict each other, and the motion that they show would not do either.
    Either,
    /// The calibration states its own scale factors no better.
    Calibration,
}

/// What the block means of a recording say of that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// Root mean square of what the equations leave, over the noise, whatever limbs may have drifted by.
    pub over_noise: f64,
    /// Whether the motion would determine all ratios if noise were all.
    pub suffices: bool,
}

impl Judged {
    /// Whether channels contradict each other.
    pub fn contradicts(self) -> bool {
        self.over_noise > CONTRADICTION
    }

    /// Why ratios are open.
    pub fn cause(self) -> Cause {
        match (self.contradicts(), self.suffices) {
            (true, true) => Cause::Channels,
            (true, false) => Cause::Either,
            (false, _) => Cause::Motion,
        }
    }
}

/// What a calibration says of healthy channels.
pub struct Expected<'a> {
    /// White noise of one sample of each channel, V.
    pub noise_v: &'a [f64; LIMBS],
    /// ln of each limb's stiffness over the mean.
    pub ln_stiffness: &'a [f64; LIMBS],
    /// Standard deviation of the share of each other limb's force that a channel shows.
    pub cross_talk_sd: f64,
}

/// Scatter of the block means of nine forces.
pub struct Scatter {
    force_per_v: [f64; LIMBS],
    block: u32,
    filled: u32,
    sum: SVector<f64, LIMBS>,
    blocks: f64,
    mean: SVector<f64, LIMBS>,
    products: PerLimbs,
}

impl Scatter {
    /// Of blocks of so many samples; a volt of each channel is so many m/s^2 of force per mass.
    pub fn new(force_per_v: [f64; LIMBS], block: u32) -> Self {
        Self {
            force_per_v,
            block,
            filled: 0,
            sum: SVector::zeros(),
            blocks: 0.0,
            mean: SVector::zeros(),
            products: PerLimbs::zeros(),
        }
    }

    /// Takes a sample, V.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) {
        for ((sum, u), slope) in (self.sum.iter_mut().zip(voltage_v)).zip(self.force_per_v) {
            *sum += u * slope;
        }
        self.filled += 1;
        if self.filled == self.block {
            let force = self.sum / f64::from(self.block);
            self.blocks += 1.0;
            let from_old = force - self.mean;
            self.mean += from_old / self.blocks;
            self.products += from_old * (force - self.mean).transpose();
            self.sum = SVector::zeros();
            self.filled = 0;
        }
    }

    /// Held against what is expected of healthy channels; none for fewer than two blocks, or numbers of which nothing can be said.
    pub fn judge(&self, expected: &Expected) -> Option<Judged> {
        if self.blocks < 2.0 {
            return None;
        }
        let compliance = expected.ln_stiffness.map(|ln| (-ln).exp());
        let strains = PerLimbs::from_fn(|i, j| {
            compliance[i] * self.products[(i, j)] * compliance[j] / (self.blocks - 1.0)
        });
        let noise: [f64; LIMBS] = core::array::from_fn(|i| {
            let of_sample = compliance[i] * self.force_per_v[i] * expected.noise_v[i];
            of_sample * of_sample / f64::from(self.block)
        });
        Some(Judged {
            over_noise: over_noise(&strains, &noise, expected.cross_talk_sd)?,
            suffices: suffices(&strains, &noise, self.blocks)?,
        })
    }
}

fn rows() -> Rows {
    Rows::from_fn(|limb, row| f64::from(SIGNATURES[limb][row]))
}

/// What the equations, weighted by `q`, say of relative changes of the nine: the sum over r and s of q_rs diag(w_r) strains diag(w_s).
fn of_changes(strains: &PerLimbs, q: &Matrix3<f64>) -> PerLimbs {
    (rows() * q * rows().transpose()).component_mul(strains)
}

fn over_noise(strains: &PerLimbs, noise: &[f64; LIMBS], cross_talk_sd: f64) -> Option<f64> {
    let expected = |row: usize| -> f64 {
        let in_row = (0..LIMBS).filter(|&i| SIGNATURES[i][row] != 0);
        let of_others = |i: usize| cross_talk_sd.powi(2) * (strains.trace() - strains[(i, i)]);
        in_row.map(|i| noise[i] + of_others(i)).sum()
    };
    let weights = SVector::<f64, ROWS>::from_fn(|row, _| 1.0 / expected(row));
    let left = of_changes(strains, &Matrix3::from_diagonal(&weights)) / ROWS as f64;
    // The least of (1 + d)^T left (1 + d) + |d|^2 / sd^2 over changes d that add up to zero.
    let ones = SVector::<f64, LIMBS>::repeat(1.0);
    let possible = PerLimbs::identity() / DRIFT_SD.powi(2);
    let kept = ones * ones.transpose() * (KEPT * left.amax().max(1.0));
    let change = (left + possible + kept)
        .cholesky()?
        .solve(&(-(left * ones)));
    let changed = ones + change;
    let least = changed.dot(&(left * changed)) + change.norm_squared() / DRIFT_SD.powi(2);
    least.is_finite().then(|| least.max(0.0).sqrt())
}

/// Whether the motion would do, by the eight channels that contradict each other least: the ninth may be the one that is wrong, and what
/// it shows is no motion.
fn suffices(strains: &PerLimbs, noise: &[f64; LIMBS], blocks: f64) -> Option<bool> {
    let rows = rows();
    let largest = noise.iter().copied().fold(0.0, f64::max);
    let mut least = (f64::INFINITY, PerLimbs::identity());
    for limb in 0..LIMBS {
        let mut variances = SVector::from(*noise);
        variances[limb] = NOT_BELIEVED * largest;
        let variances = PerLimbs::from_diagonal(&variances);
        let weights = (rows.transpose() * variances * rows).try_inverse()?;
        let contradiction = (weights * rows.transpose() * strains * rows).trace();
        if contradiction < least.0 {
            let others = PerLimbs::identity() - variances * rows * weights * rows.transpose();
            least = (contradiction, others);
        }
    }
    let (_, others) = least;
    let noise = PerLimbs::from_diagonal(&SVector::from(*noise));
    let motion = others * (strains - noise) * others.transpose();
    let q = (rows.transpose() * noise * rows).try_inverse()?;
    let information = of_changes(&motion, &q) * blocks;
    // The common factor shows in no motion.
    let apart = PerLimbs::identity() - PerLimbs::repeat(1.0 / LIMBS as f64);
    let information = apart * (information + information.transpose()) * apart * 0.5;
    let mut values = Vec::from(<[f64; LIMBS]>::from(information.symmetric_eigenvalues()));
    values.sort_by(|a, b| b.total_cmp(a));
    let (most, fewest) = (values[0], values[RATIOS - 1]);
    let limits = Limits::default();
    let excited = most * limits.least_excitation.powi(2);
    Some(fewest >= excited.max(limits.largest_deviation.powi(-2)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks of one sample with some noise: so many loads, each at a frequency of its own, and what `spoil` makes of the channels.
    fn judged(loads: usize, spoil: impl Fn(usize, &mut [f64; LIMBS])) -> Judged {
        const NOISE: f64 = 1e-3;
        let rows = rows();
        let gram = (rows.transpose() * rows).try_inverse().expect("rank three");
        let consistent = PerLimbs::identity() - rows * gram * rows.transpose();
        let mut scatter = Scatter::new([1.0; LIMBS], 1);
        let mut state = 1_u64;
        let mut noise = || {
            let twelve = (0..12).map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
            });
            NOISE * twelve.sum::<f64>()
        };
        for at in 0..2000 {
            let load = SVector::<f64, LIMBS>::from_fn(|limb, _| {
                let all = (0..loads).map(|k| {
                    let weight = (1.0 + (limb * (3 * k + 2)) as f64).sin();
                    weight * (0.01 * (k + 1) as f64 * at as f64).sin()
                });
                all.sum()
            });
            let mut row: [f64; LIMBS] = (consistent * load).into();
            spoil(at, &mut row);
            row.iter_mut().for_each(|u| *u += noise());
            scatter.push(&row);
        }
        let judged = scatter.judge(&Expected {
            noise_v: &[NOISE; LIMBS],
            ln_stiffness: &[0.0; LIMBS],
            cross_talk_sd: 0.0,
        });
        judged.expect("blocks")
    }

    #[test]
    fn prop_a_motion_that_is_rich_enough_is_told_from_one_that_is_not() {
        let healthy = judged(6, |_, _| {});
        assert!(healthy.suffices && healthy.over_noise < 1.5, "{healthy:?}");
        let poor = judged(1, |_, _| {});
        assert_eq!(poor.cause(), Cause::Motion, "{poor:?}");
        assert!(!poor.suffices);
        // A limb that has drifted contradicts nothing.
        for loads in [1, 6] {
            let drifted = judged(loads, |_, row| row[3] *= 1.05);
            assert!(drifted.over_noise < CONTRADICTION, "{loads}: {drifted:?}");
        }
    }

    #[test]
    fn neg_a_channel_that_is_wrong_is_no_poor_motion() {
        for limb in 0..LIMBS {
            let hum =
                |at: usize, row: &mut [f64; LIMBS]| row[limb] += (2.3 * at as f64).sin() / 5.0;
            let hums = judged(6, hum);
            assert_eq!(hums.cause(), Cause::Channels, "hum, {limb}: {hums:?}");
            let dead = judged(6, |at, row| row[limb] *= f64::from(at < 1000));
            assert_eq!(dead.cause(), Cause::Channels, "dead, {limb}: {dead:?}");
            let inverted = judged(6, |_, row| row[limb] = -row[limb]);
            assert_eq!(inverted.cause(), Cause::Channels, "{limb}: {inverted:?}");
            // The same hum does not make a poor motion rich.
            let both = judged(1, hum);
            assert_eq!(both.cause(), Cause::Either, "poor, {limb}: {both:?}");
        }
    }
}

//! Noise that is not white: how much more of it there is beside the fit's harmonics than a record shows above them all.
//!
//! A converter that oversamples, a filter or a slow amplifier leaves less noise at high frequencies, from which a record's noise is told,
//! than at the low ones that are fitted. The harmonics next to the fitted ones say by how much: K being the last one, those up to 3 K. A
//! record has too few of them, so all records that are sampled alike are asked together, and what is no more than chance is none. Lines,
//! as of mains, are left out with the largest fifth of the squares, and records that show something else there do not sway a median.

use alloc::vec::Vec;

use super::harmonics::{Grid, squares};
use super::trial::Trial;
use crate::float::{ln, sqrt};
use crate::geometry::LIMBS;

/// Last harmonic that is looked at over the last fitted one.
const NEAR: usize = 3;
/// Fewest harmonics that are worth a look.
const FEWEST: usize = 16;
/// Share of the squares that is kept, the smallest.
const KEPT: f64 = 0.8;
/// Standard deviations by which noise must be louder to be so.
const SIGNIFICANT: f64 = 4.0;
/// Standard deviation of a median of trimmed means over that of a mean of them all.
const OF_A_MEDIAN: f64 = 1.4;

/// Noise beside the fitted harmonics over what the record shows above them, variances.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Near {
    /// Of the limbs, then the standard.
    pub over_variance: [f64; LIMBS + 1],
    /// Harmonics that were looked at.
    pub harmonics: usize,
}

/// Looks at a record, of which channels show noise of such variances; none where too little lies between the fit's harmonics and `last`.
pub(super) fn look(
    grid: &Grid,
    row: impl Fn(usize) -> [f64; LIMBS + 1],
    variance: &[f64; LIMBS + 1],
    last: usize,
) -> Option<Near> {
    let first = grid.harmonics + grid.harmonics / 8 + 1;
    let last = last.min(NEAR * grid.harmonics);
    let count = (last + 1).saturating_sub(first);
    if count < FEWEST {
        return None;
    }
    let mut all = squares(grid, row, first..=last);
    let kept = (KEPT * count as f64) as usize;
    // The mean of the smallest of n squares of unit noise, each even over exp(-x): the i-th has the mean of 1/n + ... + 1/(n - i + 1).
    let (mut each, mut expected) = (0.0, 0.0);
    for i in 0..kept {
        each += 1.0 / (count - i) as f64;
        expected += each;
    }
    for squares in &mut all {
        squares.sort_by(f64::total_cmp);
    }
    Some(Near {
        over_variance: core::array::from_fn(|channel| {
            let smallest: f64 = all[channel].iter().take(kept).sum();
            smallest / expected / variance[channel]
        }),
        harmonics: count,
    })
}

/// Sets by how much the noise of each trial is louder than the trial shows by itself.
pub(super) fn settle(trials: &mut [Trial]) {
    let of = |trials: &[Trial], at: usize, standard: bool| {
        let one = &trials[at];
        let alike = trials.iter().filter(|other| {
            other.grid.step_s.to_bits() == one.grid.step_s.to_bits()
                && (!standard || other.drive == one.drive)
        });
        let near = alike.filter_map(|trial| trial.near.as_ref());
        let channels = if standard { LIMBS..LIMBS + 1 } else { 0..LIMBS };
        louder(near, channels)
    };
    for at in 0..trials.len() {
        let [limbs, standard] = [false, true].map(|standard| of(trials, at, standard));
        trials[at].louder = core::array::from_fn(|c| if c < LIMBS { limbs } else { standard });
    }
}

/// What these channels of these trials agree on; 1 where it is not told from chance.
fn louder<'a>(trials: impl Iterator<Item = &'a Near>, channels: core::ops::Range<usize>) -> f64 {
    let (mut ratios, mut harmonics) = (Vec::new(), 0);
    for near in trials {
        let of = near.over_variance[channels.clone()].iter();
        ratios.extend(of.filter(|ratio| ratio.is_finite()));
        harmonics += near.harmonics * channels.len();
    }
    if ratios.is_empty() {
        return 1.0;
    }
    ratios.sort_by(f64::total_cmp);
    let middle = ratios[ratios.len() / 2];
    let deviation = OF_A_MEDIAN / sqrt(harmonics as f64);
    if ln(middle) > SIGNIFICANT * deviation {
        middle
    } else {
        1.0
    }
}

//! The likelihood that two channels are exchanged, a hypothesis without a free parameter.
//!
//! With the plugs of channels i and j exchanged, limb i's voltage stands in channel j. Exchanged back, the strains change by
//! known amounts and the rows by w_i (x_i' - x_i) + w_j (x_j' - x_j): either that makes the rows quiet or the channels are not
//! exchanged. The columns of an ambiguous pair are equal: exchanged, its channels show by the difference of their sensitivities and
//! zeros, and not at all if those are equal.

use super::noise::{RowNoise, dot};
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::redundancy::parity::{ROWS, SIGNATURES};

/// Number of pairs.
pub const PAIRS: usize = LIMBS * (LIMBS - 1) / 2;

/// The pairs, limbs from 0.
pub const PAIRED: [[usize; 2]; PAIRS] = pairs();

const fn pairs() -> [[usize; 2]; PAIRS] {
    let mut of = [[0; 2]; PAIRS];
    let (mut count, mut i) = (0, 0);
    while i < LIMBS {
        let mut j = i + 1;
        while j < LIMBS {
            of[count] = [i, j];
            count += 1;
            j += 1;
        }
        i += 1;
    }
    of
}

/// ln of the likelihood ratio of each pair: half of the energy that exchanging it back removes from the whitened rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swaps([f64; PAIRS]);

impl Default for Swaps {
    fn default() -> Self {
        Self([0.0; PAIRS])
    }
}

impl Swaps {
    /// Takes a sample: whitened rows, strains, and what strain each limb's sensitivity makes of the voltage of channel j.
    pub fn push(
        &mut self,
        noise: &RowNoise,
        z: &[f64; ROWS],
        strain: &[f64; LIMBS],
        strain_of: impl Fn(usize, usize) -> f64,
    ) {
        let before = dot(z, z);
        for (likelihood, [i, j]) in self.0.iter_mut().zip(PAIRED) {
            let (di, dj) = (strain_of(i, j) - strain[i], strain_of(j, i) - strain[j]);
            let rows: [f64; ROWS] = core::array::from_fn(|k| {
                f64::from(SIGNATURES[i][k]) * di + f64::from(SIGNATURES[j][k]) * dj
            });
            let change = noise.whiten(&rows);
            let after: [f64; ROWS] = core::array::from_fn(|k| z[k] + change[k]);
            *likelihood += 0.5 * (before - dot(&after, &after));
        }
    }

    /// The pair that leads, of channels not in `gone`: its ln of the likelihood ratio against no failure, and by how much it leads.
    #[must_use]
    pub fn lead(&self, gone: LimbSet) -> ([usize; 2], f64, f64) {
        let (mut best, mut first, mut second) = ([0; 2], f64::NEG_INFINITY, f64::NEG_INFINITY);
        for (pair, &score) in PAIRED.into_iter().zip(&self.0) {
            if pair.into_iter().any(|limb| gone.contains(limb)) {
                continue;
            }
            if score > first {
                (best, second, first) = (pair, first, score);
            } else if score > second {
                second = score;
            }
        }
        (best, first, first - second)
    }
}

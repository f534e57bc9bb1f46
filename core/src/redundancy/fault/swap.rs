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

/// ln of the likelihood ratio of each pair, half of the energy that exchanging it back removes from the whitened rows, and how much of it
/// is of where the rows stand and not of how they move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swaps {
    ln_ratio: [f64; PAIRS],
    samples: f64,
    rows: [f64; ROWS],
    changes: [[f64; ROWS]; PAIRS],
}

impl Default for Swaps {
    fn default() -> Self {
        Self {
            ln_ratio: [0.0; PAIRS],
            samples: 0.0,
            rows: [0.0; ROWS],
            changes: [[0.0; ROWS]; PAIRS],
        }
    }
}

/// The pair that leads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lead {
    /// Its channels, from 0.
    pub pair: [usize; 2],
    /// ln of its likelihood ratio against no failure.
    pub ln_ratio: f64,
    /// The same by the rows' motion about their means alone: zeros that have moved may look exchanged, and stand.
    pub by_motion: f64,
    /// By how much it leads the next one.
    pub by: f64,
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
        self.samples += 1.0;
        for (sum, z) in self.rows.iter_mut().zip(z) {
            *sum += z;
        }
        for (place, [i, j]) in PAIRED.into_iter().enumerate() {
            let (di, dj) = (strain_of(i, j) - strain[i], strain_of(j, i) - strain[j]);
            let rows: [f64; ROWS] = core::array::from_fn(|k| {
                f64::from(SIGNATURES[i][k]) * di + f64::from(SIGNATURES[j][k]) * dj
            });
            let change = noise.whiten(&rows);
            let after: [f64; ROWS] = core::array::from_fn(|k| z[k] + change[k]);
            if let (Some(ratio), Some(sum)) =
                (self.ln_ratio.get_mut(place), self.changes.get_mut(place))
            {
                *ratio += 0.5 * (before - dot(&after, &after));
                for (sum, change) in sum.iter_mut().zip(&change) {
                    *sum += change;
                }
            }
        }
    }

    /// The pair that leads, of channels not in `gone`.
    #[must_use]
    pub fn lead(&self, gone: LimbSet) -> Lead {
        let mut lead = Lead {
            pair: [0; 2],
            ln_ratio: f64::NEG_INFINITY,
            by_motion: f64::NEG_INFINITY,
            by: 0.0,
        };
        let mut second = f64::NEG_INFINITY;
        for ((pair, &ln_ratio), change) in PAIRED.into_iter().zip(&self.ln_ratio).zip(&self.changes)
        {
            if pair.into_iter().any(|limb| gone.contains(limb)) {
                continue;
            }
            if ln_ratio > lead.ln_ratio {
                second = lead.ln_ratio;
                let after: [f64; ROWS] = core::array::from_fn(|k| self.rows[k] + change[k]);
                let standing = dot(&self.rows, &self.rows) - dot(&after, &after);
                lead.pair = pair;
                lead.ln_ratio = ln_ratio;
                lead.by_motion = ln_ratio - 0.5 * standing / self.samples.max(1.0);
            } else if ln_ratio > second {
                second = ln_ratio;
            }
        }
        lead.by = lead.ln_ratio - second;
        lead
    }
}

//! The strains of eight streams that exclude limbs, right to second order: see [`crate::kernel::reconstruct`].
//!
//! A loop of its own before all others: together with everything that comes after, the weights would be more numbers than any
//! processor has registers.

use super::side_by_side;
use crate::decouple::stream::Decoupler;
use crate::geometry::LIMBS;
use crate::kernel::constants::Constants;
use crate::kernel::order::{Limbs, from_kernel_order, to_kernel_order};
use crate::kernel::placement::limb_strains;
use crate::kernel::simd::{LANES, Register, Row};
use crate::kernel::weights::StrainWeights;
use crate::limb_set::LimbSet;

/// A number of each limb, each of eight streams.
pub type LimbRows = [Row; LIMBS];

/// Numbers in the weights of a stream, counted in f32, where nothing is padded.
pub const WEIGHTS: usize = size_of::<StrainWeights<f32>>() / size_of::<f32>();

/// Which limbs eight streams exclude, and the weights that reconstruct their strains.
pub struct LaneWeights {
    /// Limbs that any stream excludes.
    limbs: LimbSet,
    /// All bits set for a channel that is used, none for an excluded one.
    used: [[u64; LANES]; LIMBS],
    weights: [Row; WEIGHTS],
}

impl LaneWeights {
    pub fn gather(streams: &[Decoupler; LANES]) -> Self {
        let of = |limb: usize| {
            streams.each_ref().map(|stream| {
                if stream.excluded().contains(limb) {
                    0
                } else {
                    u64::MAX
                }
            })
        };
        let used: [[u64; LANES]; LIMBS] = core::array::from_fn(of);
        Self {
            limbs: (0..LIMBS)
                .filter(|&limb| used[limb] != [u64::MAX; LANES])
                .fold(LimbSet::EMPTY, LimbSet::with),
            used,
            weights: side_by_side(streams, |stream, mut f| {
                let mut numbers = stream.mask.strains.strain;
                numbers.visit(&mut f);
            }),
        }
    }

    /// Makes zero volt of excluded channels, which may be NaN.
    #[inline(always)]
    pub fn mask(&self, samples: &mut [LimbRows]) {
        for limb in self.limbs.indices() {
            let used = self.used[limb];
            for nine in &mut *samples {
                for (value, bits) in nine[limb].0.iter_mut().zip(used) {
                    *value = f64::from_bits(value.to_bits() & bits);
                }
            }
        }
    }

    /// Makes strains of the voltages of some samples, in place.
    #[inline(always)]
    pub fn reconstruct<R: Register>(
        &self,
        proof: R::Proof,
        constants: &Constants<R>,
        samples: &mut [LimbRows],
        part: usize,
    ) {
        let mut weights = StrainWeights::splat(R::splat(proof, 0.0));
        let mut rows = self.weights.iter();
        weights.visit(&mut |zero| rows.next().map_or(zero, |row| R::load(proof, row, part)));
        for nine in samples {
            let used = limb_strains(constants, load::<R>(proof, nine, part));
            let strains = from_kernel_order(weights.to_second_order(used, constants.inverse_nu));
            for (row, strain) in nine.iter_mut().zip(strains) {
                strain.store(row, part);
            }
        }
    }
}

/// Numbers of nine limbs in kernel order.
#[inline(always)]
pub fn load<R: Register>(proof: R::Proof, nine: &LimbRows, part: usize) -> Limbs<R> {
    let [a, b, c, d, e, f, g, h, i] = nine;
    to_kernel_order([
        R::load(proof, a, part),
        R::load(proof, b, part),
        R::load(proof, c, part),
        R::load(proof, d, part),
        R::load(proof, e, part),
        R::load(proof, f, part),
        R::load(proof, g, part),
        R::load(proof, h, part),
        R::load(proof, i, part),
    ])
}

//! Excluded channels, and the reconstruction of their strains.

use super::constants::Constants;
use super::number::Scalar;
use super::order::{Limbs, from_kernel_order, to_kernel_order};
use super::reconstruct::StrainReconstruction;
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::redundancy::reconstruction::Reconstruction;

/// The channels of all limbs but the excluded ones.
#[derive(Clone, Copy)]
pub struct ChannelMask<T: Scalar> {
    /// Weights in f64, and the excluded limbs themselves.
    pub reconstruction: Reconstruction,
    /// Weights for the kernel.
    pub strains: StrainReconstruction<T>,
    /// All bits set for a channel that is used, none for an excluded one, in kernel order.
    bits: Limbs<T>,
}

// By the set alone: the bits, read as f64, are NaN, which is not equal to itself.
impl<T: Scalar> core::fmt::Debug for ChannelMask<T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "ChannelMask {{ all but: {:?} }}", self.excluded())
    }
}

impl<T: Scalar> PartialEq for ChannelMask<T> {
    fn eq(&self, other: &Self) -> bool {
        self.excluded() == other.excluded()
    }
}

impl<T: Scalar> ChannelMask<T> {
    /// # Errors
    /// Those of [`Reconstruction::new`].
    pub fn excluding(
        excluded: LimbSet,
        stiffness_ratio: &[f64; LIMBS],
        constants: &Constants<f64>,
    ) -> Result<Self> {
        let reconstruction = Reconstruction::new(excluded)?.with_stiffness(stiffness_ratio);
        Ok(Self {
            // Of no limb the weights are zero: a decoupler is built without multiplying them out.
            strains: if excluded.is_empty() {
                StrainReconstruction::none()
            } else {
                StrainReconstruction::new(&reconstruction, constants)
            },
            bits: to_kernel_order(core::array::from_fn(|limb| {
                T::bits(!excluded.contains(limb))
            })),
            reconstruction,
        })
    }

    /// The excluded limbs.
    #[inline(always)]
    pub fn excluded(&self) -> LimbSet {
        self.reconstruction.excluded()
    }

    /// Whether no limb is excluded.
    #[inline(always)]
    pub fn all(&self) -> bool {
        self.excluded().is_empty()
    }

    /// Voltages in kernel order; excluded channels read 0.0 even if NaN.
    #[inline(always)]
    pub fn voltages(&self, [u, v, w]: Limbs<T>) -> Limbs<T> {
        let [a, b, c] = self.bits;
        [u.and(a), v.and(b), w.and(c)]
    }

    /// [`Self::voltages`] in f64 and in the paper's order.
    pub fn exact_voltages(&self, voltage_v: &[T; LIMBS]) -> [f64; LIMBS] {
        from_kernel_order(self.voltages(to_kernel_order(*voltage_v))).map(T::to_f64)
    }
}

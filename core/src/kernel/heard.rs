//! Which channels are listened to, and what makes up for the others.

use super::constants::{Constants, limb_after_limb, limb_by_limb};
use super::fill::Fill;
use super::placement::Limbs;
use super::real::Scalar;
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::parity::{LimbSet, Reconstruction};

/// The channels of all limbs but some.
#[derive(Clone, Copy)]
pub struct Heard<T: Scalar> {
    /// Weights in full precision, and the failed limbs themselves.
    pub reconstruction: Reconstruction,
    /// Weights for the kernel.
    pub fill: Fill<T>,
    /// All bits for a channel that is listened to, none for another.
    bits: Limbs<T>,
}

// The set says it all; as numbers, the bits are not equal to themselves and print as none.
impl<T: Scalar> core::fmt::Debug for Heard<T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "Heard {{ all but: {:?} }}", self.failed())
    }
}

impl<T: Scalar> PartialEq for Heard<T> {
    fn eq(&self, other: &Self) -> bool {
        self.failed() == other.failed()
    }
}

impl<T: Scalar> Heard<T> {
    /// # Errors
    /// Those of [`Reconstruction::new`].
    pub fn without(failed: LimbSet, constants: &Constants<f64>) -> Result<Self> {
        let reconstruction = Reconstruction::new(failed)?;
        Ok(Self {
            fill: Fill::new(&reconstruction, constants),
            bits: limb_by_limb(core::array::from_fn(|limb| T::bits(!failed.contains(limb)))),
            reconstruction,
        })
    }

    /// The limbs whose channels are not listened to.
    #[inline(always)]
    pub fn failed(&self) -> LimbSet {
        self.reconstruction.failed()
    }

    /// Whether that is none.
    #[inline(always)]
    pub fn all(&self) -> bool {
        self.failed().is_empty()
    }

    /// The voltages limb by limb, zero whatever a failed channel says: it may be no number.
    #[inline(always)]
    pub fn voltages(&self, [u, v, w]: Limbs<T>) -> Limbs<T> {
        let [a, b, c] = self.bits;
        [u.and(a), v.and(b), w.and(c)]
    }

    /// The same in full precision, limb after limb.
    pub fn exact_voltages(&self, voltage_v: &[T; LIMBS]) -> [f64; LIMBS] {
        limb_after_limb(self.voltages(limb_by_limb(*voltage_v))).map(T::to_f64)
    }
}

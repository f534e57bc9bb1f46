//! Samples beyond the series of the pose and the polynomials of the rotation, and those that have no answer.

use super::{Decoupler, Quaternion};
use crate::error::{Error, Result};
use crate::geometry::LIMBS;
use crate::kernel::attitude::{exp_exactly, to_ground};
use crate::kernel::number::Scalar;
use crate::kernel::placement::{self, LimbLoad};
use crate::kernel::reconstruct;
use crate::kernel::shell::ShellMotion;
use crate::kernel::vec3::Vec3;

impl<T: Scalar> Decoupler<T> {
    /// A sample beyond the series, or one that is not a number.
    #[cold]
    #[inline(never)]
    pub(super) fn place_exactly(&self, voltage_v: &[T; LIMBS], sample: u64) -> Result<LimbLoad<T>> {
        let used = self.mask.exact_voltages(voltage_v);
        let sample = sample as usize;
        let placed = if self.mask.all() {
            placement::exactly(&self.exact, &used, sample)
        } else {
            let without = self.exact.excluding(self.excluded());
            reconstruct::exactly(&without, &self.mask.reconstruction, &used, sample)
        }?;
        Ok(placed.map(T::from_f64))
    }

    /// A step by more than the polynomials of the rotation hold for, or one that is not a number.
    #[cold]
    #[inline(never)]
    pub(super) fn turn_exactly(
        &self,
        half: Vec3<T>,
        scale: T,
        motion: &ShellMotion<T>,
    ) -> Result<Quaternion<T>> {
        self.refuse_overflow(motion)?;
        exp_exactly(half, scale).ok_or(self.overflow())
    }

    pub(super) fn refuse_overflow(&self, motion: &ShellMotion<T>) -> Result<()> {
        let answer = to_ground(&self.constants, motion, self.state.attitude);
        let finite = answer.iter().all(|v| v.is_finite());
        if finite { Ok(()) } else { Err(self.overflow()) }
    }

    pub(super) fn overflow(&self) -> Error {
        Error::overflow("decoupling", self.state.received as usize)
    }
}

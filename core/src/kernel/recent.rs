//! The rows that came last: to be worked on anew when limbs are done without.

use super::placement::Limbs;
use super::real::Real;
use super::vector::Vec3;

/// Twice as many as are looked at: a row is kept as soon as it has been read, when it is still in registers, and one that is
/// refused after that must not be where a row lies that was taken.
const SLOTS: usize = 4;

/// Voltages of the last two samples, limb by limb.
#[derive(Debug, Clone)]
pub struct Recent<T: Real> {
    rows: [Limbs<T>; SLOTS],
}

impl<T: Real + Default> Default for Recent<T> {
    fn default() -> Self {
        Self {
            rows: [[Vec3::default(); 3]; SLOTS],
        }
    }
}

impl<T: Real> Recent<T> {
    /// Keeps the row of a sample.
    #[inline(always)]
    pub fn keep(&mut self, sample: u64, voltage_v: Limbs<T>) {
        self.rows[sample as usize & (SLOTS - 1)] = voltage_v;
    }

    /// The row of one of the last two samples.
    pub fn row(&self, sample: u64) -> Limbs<T> {
        self.rows[sample as usize & (SLOTS - 1)]
    }

    /// The same of the last two of as many as were received.
    pub fn last_two(&self, received: u64) -> [Limbs<T>; 2] {
        [1, 2].map(|ago| self.row(received.wrapping_sub(ago)))
    }
}

//! When a failure is over: all nine have been quiet for long, and those that had failed move again.

use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;

/// Samples without any alarm after which a failure is over: two of the longest windows.
pub const QUIET: u64 = 8192;
/// Standard deviations of its noise by which an excluded channel must move before it is believed again.
const STIRS: f64 = 8.0;

/// Samples for which all nine have been quiet after a failure, the voltages at the first, channels that have moved since.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Recovery {
    quiet: u64,
    from_v: [f64; LIMBS],
    stirred: LimbSet,
}

impl Recovery {
    /// Takes whether a sample was quiet, and says whether the failure is over; `moved` is how far a channel is from a voltage, in
    /// its noise.
    pub fn push(
        &mut self,
        sound: bool,
        voltage_v: &[f64; LIMBS],
        failed: LimbSet,
        moved: impl Fn(usize, f64) -> f64,
    ) -> bool {
        if !sound || self.quiet == 0 {
            *self = Self {
                quiet: u64::from(sound),
                from_v: *voltage_v,
                stirred: LimbSet::EMPTY,
            };
            return false;
        }
        self.quiet += 1;
        self.stirred = failed
            .indices()
            .filter(|&limb| moved(limb, self.from_v[limb]).abs() > STIRS)
            .fold(self.stirred, LimbSet::with);
        self.quiet >= QUIET && failed.minus(self.stirred).is_empty()
    }
}

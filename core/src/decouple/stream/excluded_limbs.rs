//! Excluding limbs from one sample to the next, and taking them back.
//!
//! A sample is decoupled when its successor has come. When the last sample received is n, its torque has entered nothing yet; its
//! pose has entered the rate at n - 1, and through it the attitude there. So the poses of n and n - 1 are computed again from their
//! voltages, and the effect of the old pose of n is undone.
//!
//! Two sets of limbs differ in the pose that they give, by noise and by errors of the calibration. To avoid a step in rate and
//! attitude, only the change of the relative rotation between samples n - 1 and n is corrected, not its absolute value.

use super::{Decoupler, in_range};
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::kernel::attitude::{HALF_ANGLE_SQUARED_LIMIT, exp, exp_exactly, half_rotation};
use crate::kernel::channel_mask::ChannelMask;
use crate::kernel::number::Scalar;
use crate::kernel::placement::{LimbLoad, turn};
use crate::kernel::shell;
use crate::kernel::vec3::Vec3;
use crate::kernel::wider::Wider;
use crate::limb_set::LimbSet;

impl<T: Scalar> Decoupler<T> {
    /// Excludes these limbs from now on: their channels are not read, even if NaN. [`LimbSet::EMPTY`] includes all limbs again.
    ///
    /// May be called at any time. In mid-stream the poses of the last two samples are computed again, so that a channel that failed
    /// at the last sample received leaves no trace in angular velocity and attitude; the one wrong answer is that of the sample
    /// before, which has been returned already. A sample refused because of the channel was not received. A limb that is included
    /// again must have been sound for two samples. Allocates nothing.
    ///
    /// # Errors
    /// [`crate::Error::LostLoad`] where the other limbs do not determine six accelerations, [`crate::Error::OutOfRange`] for
    /// more than three; those of [`Decoupler::push`] for one of the last two samples. The decoupler is then unchanged.
    #[cold]
    #[inline(never)]
    pub fn set_excluded(&mut self, excluded: LimbSet) -> Result<()> {
        let stiffness_ratio = self.mask.reconstruction.stiffness_ratio();
        let mut switched = Self {
            mask: ChannelMask::excluding(excluded, stiffness_ratio, &self.exact)?,
            constants: self.exact.excluding(excluded).rounded(),
            fast: excluded.is_empty() && self.settled,
            ..self.clone()
        };
        switched.wider = T::Wider::new(&switched.constants, &switched.mask.strains);
        switched.replay(self)?;
        self.mask = switched.mask;
        self.constants = switched.constants;
        self.wider = switched.wider;
        self.fast = switched.fast;
        self.state = switched.state;
        Ok(())
    }

    /// Takes the last two samples for what they are once these voltages are added to theirs, the earlier one's first, and goes on from
    /// there as if they had always been: constants of a channel that turn out to be others than they were taken for.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`] for one of these samples. The decoupler is then unchanged.
    #[cold]
    #[inline(never)]
    pub(crate) fn add_to_recent(&mut self, by_v: [[T; LIMBS]; 2]) -> Result<()> {
        let mut changed = self.clone();
        let received = changed.state.received;
        for (sample, by_v) in (0..received).rev().zip(by_v.into_iter().rev()) {
            let row = &mut changed.recent[(sample & 1) as usize];
            row.iter_mut().zip(by_v).for_each(|(u, by)| *u = *u + by);
        }
        changed.replay(self)?;
        self.recent = changed.recent;
        self.state = changed.state;
        Ok(())
    }

    /// The last two samples anew, with the voltages that are remembered now and the limbs that are now in use.
    fn replay(&mut self, old: &Self) -> Result<()> {
        let received = self.state.received;
        if received >= 1 {
            self.state.now = self.place_again(received - 1)?;
        }
        if received >= 2 {
            self.state.before = self.place_again(received - 2)?.relative_pose();
        }
        if received >= 3 {
            self.take_back(old)?;
        }
        Ok(())
    }

    /// [`Decoupler::set_excluded`] before the first sample.
    ///
    /// # Errors
    /// Those of [`Decoupler::set_excluded`].
    pub fn excluding(mut self, excluded: LimbSet) -> Result<Self> {
        self.set_excluded(excluded)?;
        Ok(self)
    }

    /// The excluded limbs.
    #[must_use]
    pub fn excluded(&self) -> LimbSet {
        self.mask.excluded()
    }

    /// Pose and load of one of the last two samples with the limbs that are now in use.
    fn place_again(&self, sample: u64) -> Result<LimbLoad<T>> {
        let voltage_v = &self.recent[(sample & 1) as usize];
        let placed = self.place(voltage_v);
        if in_range(&placed) {
            Ok(placed)
        } else {
            self.place_exactly(voltage_v, sample)
        }
    }

    /// Undoes the effect of the last sample's old pose on rate and attitude of the sample before it.
    fn take_back(&mut self, old: &Self) -> Result<()> {
        let half = T::from_f64(0.5);
        let phi = old.state.before.rotation;
        let at_last = self.state.now.rotation - old.state.now.rotation;
        let jump = at_last - (self.state.before.rotation - phi);
        // Central differences and the Jacobian of the rotation vector: of w_r and eps.
        let eps = phi.times(half).cross_plus(jump, jump);
        let w_r = eps.times(half);
        let g = self.constants.gyroscopic;
        let torque = self.state.now.torque - old.state.now.torque;
        let was = self.state.spin.rate;
        let spin = &mut self.state.spin;
        spin.change_next_torque(self.scheme, g, torque);
        let spun = shell::shell_axes(&self.constants, phi, spin.rate - was);
        let given = self.state.received == 3;
        let motion = &mut self.state.shell;
        if !given {
            motion.rate = motion.rate + (spun - w_r);
        }
        motion.rate_derivative = w_r.cross_plus(motion.rate, motion.rate_derivative - eps);
        if given {
            // Rate and attitude of the shell are given there; it is the mass's rate that was made of them.
            let back = Vec3::default() - phi;
            let change = self.constants.mass_to_principal(w_r + turn(back, w_r));
            self.state.spin.change_rate(g, change);
            return Ok(());
        }
        let was = &old.state.shell;
        let undone = half_rotation(was, motion) - half_rotation(was, was);
        // In the axes that the step has turned already: the right Jacobian to first order.
        let undone = undone - motion.rate.cross(undone).times(half);
        let attitude = self.state.attitude;
        let (mut by, half_angle_squared) = exp(undone, attitude.to_unit());
        let slow = half_angle_squared <= T::from_f64(HALF_ANGLE_SQUARED_LIMIT);
        if !slow {
            by = exp_exactly(undone, attitude.to_unit()).ok_or(self.overflow())?;
        }
        self.state.attitude = attitude.after(by);
        Ok(())
    }
}

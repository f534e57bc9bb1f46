//! Changing rate and attitude of a decoupler between two samples.

use glam::DVec3;

use super::channels::Channels;
use crate::decouple::stream::Decoupler;
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::kernel::attitude::exp_exactly;
use crate::kernel::shell;
use crate::kernel::vec3::{Vec3, vec3};

impl Decoupler {
    /// Has the last two rows, the earlier one first, mended by other channels than those that they were mended by.
    pub(super) fn mend_recent(
        &mut self,
        mended_v: [&mut [f64; LIMBS]; 2],
        with: &Channels,
        instead_of: &Channels,
    ) -> Result<()> {
        let anew = mended_v.each_ref().map(|row| with.anew(row, instead_of));
        self.add_to_recent(core::array::from_fn(|row| {
            core::array::from_fn(|limb| anew[row][limb] - mended_v[row][limb])
        }))?;
        for (row, anew) in mended_v.into_iter().zip(anew) {
            *row = anew;
        }
        Ok(())
    }

    /// Turns the attitude of the last decoupled sample by a rotation vector, shell axes, rad, and changes its rate, rad/s: the next
    /// sample goes on from there. Nothing happens before the first answer, or if the change is not finite.
    pub(super) fn steer(&mut self, turn_shell_rad: DVec3, rate_shell_rad_s: DVec3) {
        let changes = [turn_shell_rad, rate_shell_rad_s];
        if self.received() < 3 || !changes.iter().all(|v| v.is_finite()) {
            return;
        }
        let kernel = |v: DVec3| vec3(v.x, v.y, v.z);
        let scale = self.state.attitude.to_unit();
        if let Some(turn) = exp_exactly(kernel(0.5 * turn_shell_rad), scale) {
            self.state.attitude = self.state.attitude.after(turn);
        }
        let constants = self.constants;
        let change = kernel(rate_shell_rad_s).times(1.0 / constants.per_s);
        // R_r^T: the rotation of the mass in the shell the other way round, at the sample whose rate it is.
        let phi = self.state.before.rotation;
        let back = Vec3::default() - phi;
        let spun =
            constants.mass_to_principal(change + crate::kernel::placement::turn(back, change));
        let spin = &mut self.state.spin;
        let before = spin.derivative;
        spin.change_rate(constants.gyroscopic, spun);
        let derivative = shell::shell_axes(&constants, phi, spin.derivative - before);
        let motion = &mut self.state.shell;
        motion.rate = motion.rate + change;
        motion.rate_derivative = motion.rate_derivative + derivative;
    }
}

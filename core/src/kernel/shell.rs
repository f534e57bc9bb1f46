//! From the mass to the shell: eqs. (3) and (8) once the mass's own rate is known.
//!
//! The mass's motion in the shell is read from three placements by central differences. With R_r W = w* + w_r
//! (see [`super::rate`])
//!
//! ```text
//! w*  = R_r W - w_r
//! w*' = R_r W' + w_r x w* - eps
//! R^T (a - g) = sum (f/m) e - a_r - w*' x r - w* x (w* x r + 2 v).
//! ```

use super::constants::Constants;
use super::number::Real;
use super::placement::{LimbLoad, turn};
use super::vec3::Vec3;

/// Motion of the shell at one sample, shell axes, in units of L and the sample interval.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ShellMotion<T: Real> {
    /// w*.
    pub rate: Vec3<T>,
    /// w*'.
    pub rate_derivative: Vec3<T>,
    /// R^T (a - g).
    pub specific_force: Vec3<T>,
}

impl<T: Real> ShellMotion<T> {
    /// Converted to another number type.
    #[inline(always)]
    pub(crate) fn map<U: Real>(self, f: impl Fn(T) -> U) -> ShellMotion<U> {
        ShellMotion {
            rate: self.rate.map(&f),
            rate_derivative: self.rate_derivative.map(&f),
            specific_force: self.specific_force.map(&f),
        }
    }
}

/// Pose of the mass in the shell without the forces: what the central differences take from neighbouring samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RelativePose<T: Real> {
    /// 3 r.
    pub position_thrice: Vec3<T>,
    /// phi.
    pub rotation: Vec3<T>,
}

impl<T: Real> RelativePose<T> {
    /// Converted to another number type.
    #[inline(always)]
    pub(crate) fn map<U: Real>(self, f: impl Fn(T) -> U) -> RelativePose<U> {
        RelativePose {
            position_thrice: self.position_thrice.map(&f),
            rotation: self.rotation.map(&f),
        }
    }
}

impl<T: Real> LimbLoad<T> {
    /// The pose alone.
    #[inline(always)]
    pub fn relative_pose(&self) -> RelativePose<T> {
        RelativePose {
            position_thrice: self.position_thrice,
            rotation: self.rotation,
        }
    }
}

/// w_r and eps: the rotation vector's derivatives by central differences, times the left Jacobian of SO(3) to first
/// order in phi; the next term is |phi|^2/6 of them, and they are some 3e-6 of w* and w*' at the rig's 5 Hz.
#[inline(always)]
fn relative_rotation<T: Real>(before: Vec3<T>, now: Vec3<T>, after: Vec3<T>) -> (Vec3<T>, Vec3<T>) {
    let first = (after - before).times(now.constant(0.5));
    let second = now.times_plus(now.constant(-2.0), after + before);
    let half = now.times(now.constant(0.5));
    (
        half.cross_plus(first, first),
        half.cross_plus(second, second),
    )
}

/// Rate of the mass in the shell, w_r.
#[inline(always)]
pub fn relative_rate<T: Real>(
    before: &RelativePose<T>,
    now: &RelativePose<T>,
    after: &RelativePose<T>,
) -> Vec3<T> {
    relative_rotation(before.rotation, now.rotation, after.rotation).0
}

/// Principal axes of the mass to shell axes.
#[inline(always)]
pub(crate) fn shell_axes<T: Real>(constants: &Constants<T>, phi: Vec3<T>, v: Vec3<T>) -> Vec3<T> {
    let mass = constants.principal_to_mass(v);
    mass + turn(phi, mass)
}

/// Motion of the shell at the middle one of three samples.
#[inline(always)]
pub fn motion<T: Real>(
    constants: &Constants<T>,
    before: &RelativePose<T>,
    now: &RelativePose<T>,
    after: &RelativePose<T>,
    force: Vec3<T>,
    spin: [Vec3<T>; 2],
) -> ShellMotion<T> {
    let phi = now.rotation;
    let (w_r, eps) = relative_rotation(before.rotation, phi, after.rotation);
    let [spin, spin_derivative] = spin;
    let w = shell_axes(constants, phi, spin);
    let w_dot = shell_axes(constants, phi, spin_derivative);
    let rate = w - w_r;
    let rate_derivative = w_r.cross_plus(rate, w_dot - eps);

    // All of this line by line three times, as the position is.
    let r = now.position_thrice;
    let twice_velocity = after.position_thrice - before.position_thrice;
    let relative = r.times_plus(
        r.constant(-2.0),
        after.position_thrice + before.position_thrice,
    );
    let coriolis = rate.cross_plus(rate.cross_plus(r, twice_velocity), relative);
    let carried = rate_derivative.cross_plus(r, coriolis);
    ShellMotion {
        rate,
        rate_derivative,
        specific_force: carried.times_plus(r.constant(-1.0 / 3.0), force.times(constants.chi)),
    }
}

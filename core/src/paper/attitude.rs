//! Attitude from the shell's own rate: eq. (9), R' = R \[w*\]x, on SO(3).
//!
//! Given the rate and its derivative at both ends of a step, the rotation over the step is exp of
//!
//! ```text
//! h (w0 + w1)/2  +  h^2 (w0' - w1')/12  +  h^2 (w0 x w1)/12,
//! ```
//!
//! the Hermite quadrature of the rate plus the first commutator term of the Magnus series (the coning correction):
//! fourth order in h, so that the attitude never limits the scheme that integrates the rate. A unit quaternion
//! renormalised at each step stays a rotation for ever.

use glam::{DQuat, DVec3};

use crate::float::{sin_cos, sqrt};

/// Below this half angle sine and cosine take their series; the first dropped term, angle^6/720, is a tenth of rounding.
const SERIES_HALF_ANGLE_RAD: f64 = 5e-3;

/// exp of a rotation vector as a unit quaternion.
#[must_use]
pub fn exp(rotation_rad: DVec3) -> DQuat {
    let half = 0.5 * rotation_rad;
    let x2 = half.length_squared();
    let (quotient, cosine) = if x2 < SERIES_HALF_ANGLE_RAD * SERIES_HALF_ANGLE_RAD {
        (
            1.0 - x2 / 6.0 * (1.0 - x2 / 20.0),
            1.0 - x2 / 2.0 * (1.0 - x2 / 12.0),
        )
    } else {
        let x = sqrt(x2);
        let (sin, cos) = sin_cos(x);
        (sin / x, cos)
    };
    let v = half * quotient;
    DQuat::from_xyzw(v.x, v.y, v.z, cosine)
}

/// Shell attitude one step on: R(t + h) from R(t).
///
/// `attitude` turns shell axes into ground axes; rates and their derivatives are in shell axes, rad/s and rad/s^2.
#[must_use]
pub fn advance(
    attitude: DQuat,
    rate: [DVec3; 2],
    rate_derivative: [DVec3; 2],
    step_s: f64,
) -> DQuat {
    let h = step_s;
    let twelfth = h * h / 12.0;
    let rotation = (rate[0] + rate[1]) * (0.5 * h)
        + (rate_derivative[0] - rate_derivative[1]) * twelfth
        + rate[0].cross(rate[1]) * twelfth;
    (attitude * exp(rotation)).normalize()
}

//! Truth: MuJoCo, for answers that are about to be timed.
//!
//! Every row is measured: it holds the error that the code in question had on its problem when the row was written.
//! Problems have no noise and repeat exactly, so all that the margin has to cover is another machine's rounding. An
//! error of a method, which does not care for rounding, may grow by half; one that is rounding, by a factor of ten.
//!
//! Schemes of fourth order differ from MuJoCo by little more than MuJoCo from the truth: [`REFERENCE_LINEAR`].

use sixaxis_core::Scheme;

use super::{Tolerance, measured};

/// Limit where the error is the method's.
const fn of_method(value: f64) -> Tolerance {
    measured(1.5 * value, value, "the method's own error")
}

/// Limit where the error is rounding.
const fn of_rounding(value: f64) -> Tolerance {
    measured(10.0 * value, value, "rounding")
}

/// Limits of a decoupled run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecoupledRun {
    /// Largest error of a over the largest |a|.
    pub linear: Tolerance,
    /// Largest error of w' over the largest |w'|.
    pub angular: Tolerance,
    /// Largest error of w* over the largest |w*|.
    pub rate: Tolerance,
    /// Largest angle between attitudes, rad.
    pub attitude_rad: Tolerance,
}

impl DecoupledRun {
    const fn measured(linear: f64, angular: f64, rate: f64, attitude_rad: f64) -> Self {
        Self {
            linear: of_method(linear),
            angular: of_method(angular),
            rate: of_method(rate),
            attitude_rad: of_method(attitude_rad),
        }
    }

    /// The limits of a scheme of the core on the compound run at 5 Hz and 10 kHz.
    pub const fn compound(scheme: Scheme) -> Self {
        match scheme {
            Scheme::Euler => Self::measured(3.81e-3, 3.28e-3, 1.85e-3, 6.31e-3),
            Scheme::Heun => Self::measured(2.32e-5, 2.07e-5, 7.00e-6, 8.55e-5),
            Scheme::HeunSubstepped => Self::measured(3.65e-7, 3.26e-7, 1.11e-7, 1.35e-6),
            Scheme::AdamsBashforth2 => Self::measured(5.79e-5, 5.16e-5, 1.89e-5, 2.14e-4),
            Scheme::AdamsMoulton4 | Scheme::RungeKutta4 => {
                Self::measured(7.15e-9, 6.62e-9, 2.12e-9, 3.09e-8)
            }
        }
    }

    /// The limits of a scheme of the core on the tumble at 10 kHz.
    pub const fn tumble(scheme: Scheme) -> Self {
        match scheme {
            Scheme::Euler => Self::measured(1.75e-3, 1.82e-3, 1.60e-3, 2.66e-3),
            Scheme::Heun => Self::measured(1.36e-6, 1.86e-6, 1.45e-6, 6.61e-6),
            Scheme::HeunSubstepped => Self::measured(2.83e-8, 4.06e-8, 2.82e-8, 1.81e-7),
            Scheme::AdamsBashforth2 => Self::measured(3.93e-6, 7.17e-6, 4.08e-6, 2.40e-5),
            Scheme::AdamsMoulton4 | Scheme::RungeKutta4 => {
                Self::measured(1.77e-8, 2.73e-8, 9.04e-9, 8.24e-8)
            }
        }
    }
}

/// The paper's decoder on the compound run: Heun as well, so the same errors to four digits, from other formulas.
pub const PAPER_COMPOUND: DecoupledRun = DecoupledRun::compound(Scheme::Heun);
/// The paper's decoder on the tumble, where it steps w* instead of the mass's rate.
pub const PAPER_TUMBLE: DecoupledRun = DecoupledRun::measured(1.99e-6, 2.86e-6, 1.45e-6, 5.22e-6);

/// MuJoCo's own error in the linear acceleration of the compound run, over the peak: how far halving its step moves the
/// difference between decoupled and true. It is most of what Adams-Moulton and Runge-Kutta are allowed.
pub const REFERENCE_LINEAR: Tolerance = of_method(6.21e-9);

/// Position of the mass in the shell over its peak: MuJoCo holds it as a difference of positions of 0.1 m.
pub const POSE_POSITION: Tolerance = of_rounding(1.1e-10);
/// Rotation of the mass in the shell over its peak: MuJoCo holds it as a difference of unit quaternions.
pub const POSE_ROTATION: Tolerance = of_rounding(2.7e-10);

/// Worst s_i/m, relative: (12) neglects the motion of the mass in the shell.
pub const SCALE: Tolerance = of_method(1.53e-6);
/// Worst of I1..I6 over the largest: (15) neglects the same.
pub const INERTIA: Tolerance = of_method(1.05e-6);
/// Mean |w*| at the true k/m, where the truth is zero, rad/s.
pub const STIFFNESS_RATE: Tolerance = of_method(3.17e-8);
/// The same over that at the next candidate of the paper's grid, 5 % away: whether k/m is observed at all.
pub const STIFFNESS_CONTRAST: Tolerance = of_method(2.63e-4);
/// Step 4's sums by interpolation against a decode each, over the largest.
pub const SEARCH_BY_DECODING: Tolerance = of_rounding(8e-11);

/// MuJoCo's acceleration of the driven shell against the rig's law, over its peak.
pub const DRIVEN: Tolerance = of_rounding(3.1e-16);
/// MuJoCo's acceleration of a displaced mass against Newton and Euler, relative: limb lengths are rounded to 1e-11 of
/// their change.
pub const FORWARD: Tolerance = of_rounding(5.8e-12);
/// Fall of the common centre of mass against g t^2/2, relative.
pub const FREE_FALL: Tolerance = of_rounding(3.4e-16);

//! How the rate is carried from sample to sample: the choice; [`crate::kernel::rate`] is what each one does.
//!
//! The right side of (8) is known only where there are samples, so the schemes work on the grid of samples: the
//! Runge-Kutta scheme steps over pairs of them and fills the odd one in by cubic Hermite interpolation. The one
//! exception divides each sample interval and reads the torque between samples from the parabola through the last three.

use serde::{Deserialize, Serialize};

/// Sub-steps of [`Scheme::HeunSubstepped`].
pub const HEUN_SUBSTEPS: u32 = 8;

/// How w* is carried from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// Explicit Euler: first order.
    Euler,
    /// Improved Euler (Heun): second order. What the paper's authors use.
    #[default]
    Heun,
    /// Heun in [`HEUN_SUBSTEPS`] steps per sample interval, F read between samples by quadratic interpolation: second
    /// order with a 64th of Heun's error, until the interpolation's third order shows.
    HeunSubstepped,
    /// Two-step Adams-Bashforth: second order.
    AdamsBashforth2,
    /// Adams-Bashforth predictor, Adams-Moulton corrector, each of fourth order (PECE). The first three steps run at
    /// orders two to four.
    AdamsMoulton4,
    /// Classical Runge-Kutta over pairs of samples: fourth order, delay of one sample more.
    RungeKutta4,
}

impl Scheme {
    /// All schemes, in order of rising order.
    pub const ALL: [Self; 6] = [
        Self::Euler,
        Self::Heun,
        Self::HeunSubstepped,
        Self::AdamsBashforth2,
        Self::AdamsMoulton4,
        Self::RungeKutta4,
    ];

    /// Theoretical order of w* in the sample interval.
    #[must_use]
    pub const fn order(self) -> u32 {
        match self {
            Self::Euler => 1,
            Self::Heun | Self::HeunSubstepped | Self::AdamsBashforth2 => 2,
            Self::AdamsMoulton4 | Self::RungeKutta4 => 4,
        }
    }

    /// Name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Euler => "Euler",
            Self::Heun => "Heun (improved Euler)",
            Self::HeunSubstepped => "Heun, 8 sub-steps",
            Self::AdamsBashforth2 => "Adams-Bashforth 2",
            Self::AdamsMoulton4 => "Adams-Moulton 4 (PECE)",
            Self::RungeKutta4 => "Runge-Kutta 4 (sample pairs)",
        }
    }
}

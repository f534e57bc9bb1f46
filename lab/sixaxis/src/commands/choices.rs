//! Names of integrators and axes on the command line.

use clap::ValueEnum;
use sixaxis_calibration::apply::columns::Frame;
use sixaxis_core::Scheme;

/// [`Scheme`] as the command line names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Integrator {
    /// Explicit, first order
    Euler,
    /// Second order, the paper's
    Heun,
    /// Heun in eight steps a sample
    HeunSubstepped,
    /// Second order, two steps
    AdamsBashforth2,
    /// Fourth order
    AdamsMoulton4,
    /// Fourth order over pairs of samples
    RungeKutta4,
}

impl Integrator {
    /// The scheme.
    pub const fn scheme(self) -> Scheme {
        match self {
            Self::Euler => Scheme::Euler,
            Self::Heun => Scheme::Heun,
            Self::HeunSubstepped => Scheme::HeunSubstepped,
            Self::AdamsBashforth2 => Scheme::AdamsBashforth2,
            Self::AdamsMoulton4 => Scheme::AdamsMoulton4,
            Self::RungeKutta4 => Scheme::RungeKutta4,
        }
    }
}

/// [`Frame`] as the command line names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Axes {
    /// The ground's, as far as the attitude is known
    Ground,
    /// The sensor's
    Sensor,
    /// Both
    Both,
}

impl Axes {
    /// The frame.
    pub const fn frame(self) -> Frame {
        match self {
            Self::Ground => Frame::Ground,
            Self::Sensor => Frame::Sensor,
            Self::Both => Frame::Both,
        }
    }
}

/// Most threads: more than any machine has cores, and few enough to be started.
const MOST_THREADS: usize = 1024;

/// A number of threads.
pub fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads) if threads <= MOST_THREADS => Ok(threads),
        _ => Err(format!("give a number of threads up to {MOST_THREADS}")),
    }
}

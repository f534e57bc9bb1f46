//! The motion of a drive in closed form.

use core::f64::consts::{FRAC_PI_2, PI};

/// When a run rests and how it rises.
#[derive(Debug, Clone, Copy)]
pub struct Timing {
    /// Rest before and after, s.
    pub rest_s: f64,
    /// Run-up and run-down, s.
    pub ramp_s: f64,
    /// All of the run, s.
    pub run_s: f64,
}

impl Timing {
    /// Displacement over its amplitude: a sine that rises and falls smoothly, with its first two derivatives over omega, rad/s, and
    /// its square.
    pub fn course(self, t: f64, omega: f64) -> [f64; 3] {
        let (since, left) = (t - self.rest_s, self.run_s - self.rest_s - t);
        let inside = since.min(left);
        if inside <= 0.0 {
            return [0.0; 3];
        }
        let sign = if since < left { 1.0 } else { -1.0 };
        let k = PI / self.ramp_s / omega;
        // sin^4 of a quarter turn: four times smooth.
        let (s, c) = (FRAC_PI_2 * (inside / self.ramp_s).min(1.0)).sin_cos();
        let (ramp, slope, bend) = if inside < self.ramp_s {
            (
                s.powi(4),
                sign * 2.0 * k * s.powi(3) * c,
                k * k * (3.0 * s * s * c * c - s.powi(4)),
            )
        } else {
            (1.0, 0.0, 0.0)
        };
        let (sine, cosine) = (omega * since).sin_cos();
        [
            ramp * sine,
            ramp * cosine + slope * sine,
            bend * sine + 2.0 * slope * cosine - ramp * sine,
        ]
    }
}

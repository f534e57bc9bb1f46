//! Integration of eq. (8) from sample to sample.
//!
//! The right side F(t, w) of (8) is known only where there are samples, so the schemes work on the grid of samples:
//! the Runge-Kutta scheme steps over pairs of them and fills the odd one in by cubic Hermite interpolation. The one
//! exception divides each sample interval and reads F between samples from the parabola through the last three.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::dynamics::Instant;

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

/// One sample whose rate is known: (8) evaluated with the rate that the scheme settled on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settled {
    /// What the limbs say at this sample.
    pub instant: Instant,
    /// w*, rad/s.
    pub rate_shell_rad_s: DVec3,
    /// w*', rad/s^2.
    pub angular_acceleration_shell_rad_s2: DVec3,
}

impl Settled {
    fn new(instant: Instant, rate: DVec3) -> Self {
        Self {
            instant,
            rate_shell_rad_s: rate,
            angular_acceleration_shell_rad_s2: instant.angular_acceleration_shell_rad_s2(rate),
        }
    }
}

/// Heun in equal sub-steps from `from` to `to`, one `step_s` apart.
fn heun_substepped(
    before: Option<Instant>,
    from: Instant,
    to: Instant,
    rate: DVec3,
    step_s: f64,
) -> DVec3 {
    let substep = step_s / f64::from(HEUN_SUBSTEPS);
    let mut w = rate;
    let mut here = from;
    for i in 1..=HEUN_SUBSTEPS {
        let there = if i == HEUN_SUBSTEPS {
            to
        } else {
            let x = f64::from(i) / f64::from(HEUN_SUBSTEPS);
            Instant::between(before.as_ref(), &from, &to, x)
        };
        let f0 = here.angular_acceleration_shell_rad_s2(w);
        let f1 = there.angular_acceleration_shell_rad_s2(w + substep * f0);
        w += (substep / 2.0) * (f0 + f1);
        here = there;
    }
    w
}

/// Samples settled by one new instant: none, one or two, in order of time.
pub type SettledPair = [Option<Settled>; 2];

/// Carries w* along a stream of instants.
#[derive(Debug, Clone, PartialEq)]
pub struct Integrator {
    scheme: Scheme,
    step_s: f64,
    initial_rate: DVec3,
    last: Option<Settled>,
    /// Instant before the last: interpolation's third point.
    before_last: Option<Instant>,
    /// F at the settled samples before the last, newest first: the multi-step schemes' memory.
    history: [DVec3; 3],
    known: usize,
    /// Middle of a Runge-Kutta pair that waits for its end.
    middle: Option<Instant>,
}

impl Integrator {
    /// Starts with rate `initial_rate_shell_rad_s` at the first instant to come.
    #[must_use]
    pub fn new(scheme: Scheme, step_s: f64, initial_rate_shell_rad_s: DVec3) -> Self {
        Self {
            scheme,
            step_s,
            initial_rate: initial_rate_shell_rad_s,
            last: None,
            before_last: None,
            history: [DVec3::ZERO; 3],
            known: 0,
            middle: None,
        }
    }

    /// Takes the next instant, one step after the one before, and returns what it settles.
    pub fn push(&mut self, instant: Instant) -> SettledPair {
        let settled = self.settle(&instant);
        self.accept(instant, &settled);
        settled
    }

    /// What [`Self::push`] would return.
    #[inline]
    pub(crate) fn settle(&self, instant: &Instant) -> SettledPair {
        let Some(last) = &self.last else {
            return [Some(Settled::new(*instant, self.initial_rate)), None];
        };
        if self.scheme == Scheme::RungeKutta4 {
            return match self.middle {
                None => [None, None],
                Some(middle) => self.runge_kutta_pair(last, middle, *instant),
            };
        }
        [
            Some(Settled::new(*instant, self.rate_at(last, instant))),
            None,
        ]
    }

    /// w* at `instant`, one step after `last`, by a scheme that goes from sample to sample.
    fn rate_at(&self, last: &Settled, instant: &Instant) -> DVec3 {
        let h = self.step_s;
        let w = last.rate_shell_rad_s;
        let f0 = last.angular_acceleration_shell_rad_s2;
        let [f1, f2, f3] = self.history;
        let rhs = |rate| instant.angular_acceleration_shell_rad_s2(rate);
        match (self.scheme, self.known) {
            (Scheme::Euler, _) => w + h * f0,
            (Scheme::HeunSubstepped, _) => {
                heun_substepped(self.before_last, last.instant, *instant, w, h)
            }
            (Scheme::AdamsBashforth2, 1..) => w + (h / 2.0) * (3.0 * f0 - f1),
            (Scheme::AdamsMoulton4, 1) => {
                let predicted = w + (h / 2.0) * (3.0 * f0 - f1);
                w + (h / 12.0) * (5.0 * rhs(predicted) + 8.0 * f0 - f1)
            }
            (Scheme::AdamsMoulton4, 2) => {
                let predicted = w + (h / 12.0) * (23.0 * f0 - 16.0 * f1 + 5.0 * f2);
                w + (h / 24.0) * (9.0 * rhs(predicted) + 19.0 * f0 - 5.0 * f1 + f2)
            }
            (Scheme::AdamsMoulton4, 3..) => {
                let predicted = w + (h / 24.0) * (55.0 * f0 - 59.0 * f1 + 37.0 * f2 - 9.0 * f3);
                w + (h / 24.0) * (9.0 * rhs(predicted) + 19.0 * f0 - 5.0 * f1 + f2)
            }
            // Heun, and the first step of the multi-step schemes.
            _ => w + (h / 2.0) * (f0 + rhs(w + h * f0)),
        }
    }

    /// Moves on to what [`Self::settle`] has made of `instant`.
    #[inline]
    pub(crate) fn accept(&mut self, instant: Instant, settled: &SettledPair) {
        let [first, second] = settled;
        let Some(newest) = second.or(*first) else {
            self.middle = Some(instant);
            return;
        };
        if let Some(last) = &self.last {
            let [f1, f2, _] = self.history;
            self.before_last = Some(last.instant);
            self.history = [last.angular_acceleration_shell_rad_s2, f1, f2];
            self.known = (self.known + 1).min(3);
        }
        self.middle = None;
        self.last = Some(newest);
    }

    /// What [`Self::finish`] would return after `instant`, of which [`Self::settle`] has made `settled`.
    #[inline]
    pub(crate) fn held(&self, instant: &Instant, settled: &SettledPair) -> Option<Settled> {
        let last = self.last.as_ref()?;
        settled[0].is_none().then(|| self.heun(last, *instant))
    }

    /// Settles what a Runge-Kutta pair left open at the end of the stream, by one Heun step.
    pub fn finish(&mut self) -> Option<Settled> {
        let (last, middle) = (self.last?, self.middle.take()?);
        let settled = self.heun(&last, middle);
        self.last = Some(settled);
        Some(settled)
    }

    /// One Heun step from `last` to `instant`.
    fn heun(&self, last: &Settled, instant: Instant) -> Settled {
        let w = last.rate_shell_rad_s;
        let f0 = last.angular_acceleration_shell_rad_s2;
        let f1 = instant.angular_acceleration_shell_rad_s2(w + self.step_s * f0);
        Settled::new(instant, w + (self.step_s / 2.0) * (f0 + f1))
    }

    fn runge_kutta_pair(&self, last: &Settled, middle: Instant, end: Instant) -> SettledPair {
        let step = 2.0 * self.step_s;
        let w = last.rate_shell_rad_s;
        let k1 = last.angular_acceleration_shell_rad_s2;
        let k2 = middle.angular_acceleration_shell_rad_s2(w + (step / 2.0) * k1);
        let k3 = middle.angular_acceleration_shell_rad_s2(w + (step / 2.0) * k2);
        let k4 = end.angular_acceleration_shell_rad_s2(w + step * k3);
        let end = Settled::new(end, w + (step / 6.0) * (k1 + 2.0 * (k2 + k3) + k4));
        let between = 0.5 * (w + end.rate_shell_rad_s)
            + (step / 8.0) * (k1 - end.angular_acceleration_shell_rad_s2);
        [Some(Settled::new(middle, between)), Some(end)]
    }
}

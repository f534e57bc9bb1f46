//! The mass's own rate: Euler's equations in principal axes, carried from sample to sample.
//!
//! In (8) put W for the mass's angular velocity in mass axes, R_r W = w* + w_r. Its derivative is
//! R_r W' = w*' + eps + w* x w_r (a vector that turns with the mass changes by w_r x R_r W = w_r x w* besides R_r W'), so
//! the relative acceleration eps, a second difference of measured lengths, leaves (8) altogether:
//!
//! ```text
//! I W' + W x I W = R_r^T sum (f/m) t x e,
//! ```
//!
//! and in principal axes each component is one product and one torque: W_1' = (I_2 - I_3)/I_1 W_2 W_3 + torque_1.
//! The two are the same equation; on a grid of samples they are two discretisations of the same order.
//!
//! The unit of time is the sample interval, so the step is one.

use super::number::Real;
use super::vec3::{Vec3, three, visit_three};
use crate::scheme::{HEUN_SUBSTEPS, Scheme};

/// W' for a rate and a torque over the moments, principal axes.
#[inline(always)]
pub fn derivative<T: Real>(gyroscopic: Vec3<T>, rate: Vec3<T>, torque: Vec3<T>) -> Vec3<T> {
    let yzx = rate.cycled();
    gyroscopic.mul_elem(yzx).mul_elem_plus(yzx.cycled(), torque)
}

/// Torques at the sample that is to be reached, beside it, and the one after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torques<T: Real> {
    /// At the sample that is to be reached.
    pub now: Vec3<T>,
    /// At the sample after it: known early, since a torque needs no neighbours.
    pub next: Vec3<T>,
}

/// W and what a scheme remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateIntegrator<T: Real> {
    /// W, principal axes, rad per sample.
    pub rate: Vec3<T>,
    /// W', rad per sample squared.
    pub derivative: Vec3<T>,
    /// W' at earlier samples, newest first.
    history: [Vec3<T>; 3],
    /// How many of them there are.
    known: u8,
    /// Torque at this sample and the one before: interpolation's other points.
    torque: [Vec3<T>; 2],
    /// The end of the Runge-Kutta pair whose middle has just been reached: if it has.
    end: Vec3<T>,
    at_middle: bool,
}

/// One step of a scheme, not yet taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<T: Real> {
    /// W at the sample reached.
    pub rate: Vec3<T>,
    /// W' there.
    pub derivative: Vec3<T>,
    torque: Vec3<T>,
    end: Vec3<T>,
}

impl<T: Real> Step<T> {
    /// Converted to another number type.
    #[inline(always)]
    pub(crate) fn map<U: Real>(self, f: impl Fn(T) -> U) -> Step<U> {
        Step {
            rate: self.rate.map(&f),
            derivative: self.derivative.map(&f),
            torque: self.torque.map(&f),
            end: self.end.map(&f),
        }
    }
}

impl<T: Real> RateIntegrator<T> {
    /// Every number in its place, always in the same order.
    #[inline(always)]
    pub(crate) fn visit(&mut self, f: &mut impl FnMut(T) -> T) {
        let Self {
            rate,
            derivative,
            history,
            known: _,
            torque: [torque, before],
            end,
            at_middle: _,
        } = self;
        rate.visit(f);
        derivative.visit(f);
        visit_three(history, f);
        torque.visit(f);
        before.visit(f);
        end.visit(f);
    }

    /// Takes over how far another one has come.
    pub(crate) fn keep_count<U: Real>(&mut self, other: &RateIntegrator<U>) {
        self.known = other.known;
        self.at_middle = other.at_middle;
    }
}

impl<T: Real> RateIntegrator<T> {
    /// The same in another number.
    #[inline(always)]
    pub fn map<U: Real>(&self, f: impl Fn(T) -> U + Copy) -> RateIntegrator<U> {
        let [now, before] = self.torque;
        RateIntegrator {
            rate: self.rate.map(f),
            derivative: self.derivative.map(f),
            history: three(self.history, f),
            known: self.known,
            torque: [now.map(f), before.map(f)],
            end: self.end.map(f),
            at_middle: self.at_middle,
        }
    }

    /// At a rate and a torque.
    #[inline(always)]
    pub fn start(g: Vec3<T>, rate: Vec3<T>, torque: Vec3<T>) -> Self {
        let zero = Vec3::all(rate.constant(0.0));
        Self {
            rate,
            derivative: derivative(g, rate, torque),
            history: [zero; 3],
            known: 0,
            torque: [torque; 2],
            end: zero,
            at_middle: false,
        }
    }

    /// What a scheme makes of the next sample; `g` is [`super::constants::Constants::gyroscopic`].
    #[inline(always)]
    pub fn step(&self, scheme: Scheme, g: Vec3<T>, torques: Torques<T>) -> Step<T> {
        let Torques { now, next } = torques;
        let mut end = self.end;
        let w = self.rate;
        let k = self.derivative;
        let [k1, k2, k3] = self.history;
        let rate = match (scheme, self.known) {
            (Scheme::Heun, _) => heun(g, w, k, now),
            (Scheme::Euler, _) => w + k,
            (Scheme::HeunSubstepped, _) => self.substepped(g, now),
            (Scheme::RungeKutta4, _) => match self.at_middle {
                true => self.end,
                false => {
                    let (middle, at_end) = runge_kutta_pair(g, w, k, now, next);
                    end = at_end;
                    middle
                }
            },
            (Scheme::AdamsBashforth2, 1..) => {
                k.times_plus(w.constant(1.5), k1.times_plus(w.constant(-0.5), w))
            }
            (Scheme::AdamsMoulton4, 1) => {
                let predicted = k.times_plus(w.constant(1.5), k1.times_plus(w.constant(-0.5), w));
                let known = k.times_plus(
                    w.constant(8.0 / 12.0),
                    k1.times_plus(w.constant(-1.0 / 12.0), w),
                );
                derivative(g, predicted, now).times_plus(w.constant(5.0 / 12.0), known)
            }
            (Scheme::AdamsMoulton4, 2) => {
                let predicted = k.times_plus(
                    w.constant(23.0 / 12.0),
                    k1.times_plus(
                        w.constant(-16.0 / 12.0),
                        k2.times_plus(w.constant(5.0 / 12.0), w),
                    ),
                );
                self.moulton(derivative(g, predicted, now))
            }
            (Scheme::AdamsMoulton4, 3..) => {
                let older = k2.times_plus(
                    w.constant(37.0 / 24.0),
                    k3.times_plus(w.constant(-9.0 / 24.0), w),
                );
                let predicted = k.times_plus(
                    w.constant(55.0 / 24.0),
                    k1.times_plus(w.constant(-59.0 / 24.0), older),
                );
                self.moulton(derivative(g, predicted, now))
            }
            // The first step of the multi-step schemes.
            (Scheme::AdamsBashforth2 | Scheme::AdamsMoulton4, 0) => heun(g, w, k, now),
        };
        Step {
            rate,
            derivative: derivative(g, rate, now),
            torque: now,
            end,
        }
    }

    /// Another rate of the mass at this sample.
    pub(crate) fn change_rate(&mut self, g: Vec3<T>, change: Vec3<T>) {
        let zero = Vec3::all(change.constant(0.0));
        let rate = self.rate + change;
        self.derivative =
            self.derivative + (derivative(g, rate, zero) - derivative(g, self.rate, zero));
        self.rate = rate;
    }

    /// Another torque at the sample after this one: of use to a scheme that has stepped there already.
    pub(crate) fn change_next_torque(&mut self, scheme: Scheme, g: Vec3<T>, change: Vec3<T>) {
        if scheme != Scheme::RungeKutta4 || !self.at_middle {
            return;
        }
        // As in `runge_kutta_pair`: the last of its slopes is the torque's, and a third of it goes to the end; the middle
        // has half of the end and less a quarter of the slope there.
        let end = change.times_plus(change.constant(1.0 / 3.0), self.end);
        let slope =
            derivative(g, end, change) - derivative(g, self.end, Vec3::all(change.constant(0.0)));
        let middle = slope.times_plus(
            change.constant(-0.25),
            (end - self.end).times(change.constant(0.5)),
        );
        self.end = end;
        self.change_rate(g, middle);
    }

    /// Takes a step.
    #[inline(always)]
    pub fn take(&mut self, scheme: Scheme, step: Step<T>) {
        match scheme {
            Scheme::Euler | Scheme::Heun => {}
            Scheme::HeunSubstepped => {
                self.torque = [step.torque, self.torque[0]];
                self.known = 1;
            }
            Scheme::RungeKutta4 => {
                self.end = step.end;
                self.at_middle = !self.at_middle;
            }
            Scheme::AdamsBashforth2 | Scheme::AdamsMoulton4 => {
                let [k1, k2, _] = self.history;
                self.history = [self.derivative, k1, k2];
                self.known = (self.known + 1).min(3);
            }
        }
        self.rate = step.rate;
        self.derivative = step.derivative;
    }

    /// Adams-Moulton's corrector of fourth order.
    #[inline(always)]
    fn moulton(&self, predicted: Vec3<T>) -> Vec3<T> {
        let [k1, k2, _] = self.history;
        let older = k1.times_plus(
            predicted.constant(-5.0 / 24.0),
            k2.times_plus(predicted.constant(1.0 / 24.0), self.rate),
        );
        let known = self
            .derivative
            .times_plus(predicted.constant(19.0 / 24.0), older);
        predicted.times_plus(predicted.constant(9.0 / 24.0), known)
    }

    /// Heun in equal sub-steps, the torque between samples from the parabola through the last three.
    #[inline(always)]
    fn substepped(&self, g: Vec3<T>, to: Vec3<T>) -> Vec3<T> {
        let [from, before] = self.torque;
        let substep = 1.0 / f64::from(HEUN_SUBSTEPS);
        let mut w = self.rate;
        let mut torque = from;
        for i in 1..=HEUN_SUBSTEPS {
            let x = f64::from(i) * substep;
            // Lagrange weights for nodes -1, 0, 1; the line where there is none before.
            let [u, v, y] = if self.known > 0 {
                [0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)]
            } else {
                [0.0, 1.0 - x, x]
            };
            let there = to.times_plus(
                w.constant(y),
                from.times_plus(w.constant(v), before.times(w.constant(u))),
            );
            let k0 = derivative(g, w, torque);
            let k1 = derivative(g, k0.times_plus(w.constant(substep), w), there);
            w = (k0 + k1).times_plus(w.constant(0.5 * substep), w);
            torque = there;
        }
        w
    }
}

/// Improved Euler: the mean of the slopes at both ends.
#[inline(always)]
fn heun<T: Real>(g: Vec3<T>, w: Vec3<T>, k: Vec3<T>, torque: Vec3<T>) -> Vec3<T> {
    let half = w.constant(0.5);
    derivative(g, w + k, torque).times_plus(half, k.times_plus(half, w))
}

/// Middle and end of a pair of steps: classical Runge-Kutta over both, the middle by cubic Hermite interpolation.
#[inline(always)]
fn runge_kutta_pair<T: Real>(
    g: Vec3<T>,
    w: Vec3<T>,
    k1: Vec3<T>,
    middle: Vec3<T>,
    end: Vec3<T>,
) -> (Vec3<T>, Vec3<T>) {
    let k2 = derivative(g, w + k1, middle);
    let k3 = derivative(g, w + k2, middle);
    let k4 = derivative(g, k3.times_plus(w.constant(2.0), w), end);
    let inner = (k2 + k3).times_plus(w.constant(2.0), k1 + k4);
    let at_end = inner.times_plus(w.constant(1.0 / 3.0), w);
    let k_end = derivative(g, at_end, end);
    let between = (k1 - k_end).times_plus(w.constant(0.25), (w + at_end).times(w.constant(0.5)));
    (between, at_end)
}

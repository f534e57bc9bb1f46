//! Least squares on the decay by variable projection: the linear unknowns are solved for at every step, the others by Gauss-Newton.
//!
//! Channel i shows u_i = d_i + exp(g_i) h_i (f_i/m), h_i = 1/((s_i/m) c_i). Linear are the offset d_i and the twelve initial
//! values; the others are ln k/m, the damping ratio, six I/m and the nine ln gain errors g_i, of which I/m and g_i have
//! priors: rows of the same system. g_i and d_i occur in one channel only, so that each channel is reduced alone and contributes its
//! rows for the twenty unknowns that all share.
//!
//! Steps are those of all unknowns together (Kaufman's form of variable projection), halved until the sum of squares falls.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{Matrix6, SMatrix, Vector6};

use super::WHAT;
use super::model::{Instant, MODES, RingDown, SHARED};
use crate::error::{Error, Result};
use crate::float::{exp, sqrt};
use crate::geometry::{Geometry, LIMBS};
use crate::identify::least_squares::Accumulator;
use crate::identify::least_squares::factor::Factor;
use crate::identify::least_squares::gauss_newton::{Limits, Nonlinear, Outcome, iterate};
use crate::model::InertiaPerMass;

/// Initial values.
pub(super) const INITIAL: usize = 2 * MODES;
/// Unknowns of one channel at given k/m, damping, I/m and gains: d_i, then the initial values.
const LINEAR: usize = 1 + INITIAL;
/// Unknowns that all channels share, and those of one channel's step: g_i, d_i, then the shared.
const COMMON: usize = SHARED + INITIAL;
const OWN: usize = 2;
const ALL: usize = OWN + COMMON;

/// From within a few per cent a fit takes five steps.
const LIMITS: Limits = Limits {
    steps: 40,
    shares: 12,
};
/// Steps below this share of their own standard error change nothing that can be known.
const SETTLED: f64 = 1e-3;
/// Steps of this relative size are rounding.
const ROUNDING: f64 = 1e-13;

/// A stretch of free decay.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window<'a> {
    pub voltage_v: &'a [[f64; LIMBS]],
    pub step_s: f64,
    /// h_i: voltage over limb force per mass, V s^2/m.
    pub volts_per_m_s2: [f64; LIMBS],
    /// Standard deviation of each channel's noise.
    pub noise_v: [f64; LIMBS],
}

/// Priors of I/m and gains.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prior {
    pub geometry: Geometry,
    pub inertia_m2: [f64; 6],
    /// Inverse of the covariance's lower root, 1/m^2.
    pub whitening: Matrix6<f64>,
    pub gain_deviation: [f64; LIMBS],
}

/// The unknowns on which the decay depends nonlinearly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unknowns {
    pub stiffness_per_mass_per_s2: f64,
    pub damping_ratio: f64,
    pub inertia_m2: [f64; 6],
    pub gain_ln: [f64; LIMBS],
}

/// The best decay for given [`Unknowns`].
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    pub unknowns: Unknowns,
    pub ring: RingDown,
    pub initial: [f64; INITIAL],
    pub offset_v: [f64; LIMBS],
    /// Residual sums of squares, V^2.
    pub squares_v2: [f64; LIMBS],
    /// Sum of squares over noise, priors included.
    pub cost: f64,
}

/// Covariance of the shared unknowns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shared {
    /// Covariance of ln k/m, damping ratio and I/m.
    pub covariance: SMatrix<f64, SHARED, SHARED>,
    /// What of the variance of ln k/m is not the recording's noise but the errors of what is known beforehand. The estimate
    /// is linear in both, e = P (A^T noise + K errors) with P the covariance and K the information of what is known: this
    /// is (P K P) of ln k/m.
    pub from_known_ln2: f64,
}

struct Step {
    shared: [f64; SHARED],
    gain_ln: [f64; LIMBS],
    shared_covariance: Shared,
}

/// Departure of I/m from its prior, in standard deviations.
fn departure_from_prior(prior: &Prior, inertia_m2: &[f64; 6]) -> Vector6<f64> {
    let departure: [f64; 6] = core::array::from_fn(|k| inertia_m2[k] - prior.inertia_m2[k]);
    prior.whitening * Vector6::from(departure)
}

impl Window<'_> {
    fn instants(&self, ring: &RingDown) -> Vec<Instant> {
        (0..self.voltage_v.len())
            .map(|sample| ring.at(sample as f64 * self.step_s))
            .collect()
    }

    /// Voltage over limb force per mass with the gain errors in.
    fn response(&self, unknowns: &Unknowns) -> [f64; LIMBS] {
        core::array::from_fn(|i| exp(unknowns.gain_ln[i]) * self.volts_per_m_s2[i])
    }

    /// Solves for offsets and initial values.
    pub fn solve(&self, prior: &Prior, unknowns: &Unknowns) -> Result<Fitted> {
        let ring = RingDown::new(
            &prior.geometry,
            &InertiaPerMass::from_paper_order(unknowns.inertia_m2),
            unknowns.stiffness_per_mass_per_s2,
            unknowns.damping_ratio,
        )?;
        let response = self.response(unknowns);
        let instants = self.instants(&ring);
        let mut common = Accumulator::<INITIAL>::default();
        let channels: Vec<Factor<LINEAR, 1>> = (0..LIMBS)
            .map(|limb| {
                let mut rows = Factor::<LINEAR, 1>::default();
                let weight = 1.0 / self.noise_v[limb];
                let shape = ring.shape(limb).map(|w| response[limb] * weight * w);
                for (row, now) in self.voltage_v.iter().zip(&instants) {
                    let mut regressor = [0.0; LINEAR];
                    regressor[0] = weight;
                    for j in 0..MODES {
                        regressor[1 + j] = shape[j] * now.cosine[j];
                        regressor[1 + MODES + j] = shape[j] * now.sine[j];
                    }
                    rows.push(&regressor, &[weight * row[limb]]);
                }
                let rows = rows.settled();
                common.append(&rows.last::<INITIAL>());
                rows
            })
            .collect();
        let initial = common.solve(WHAT)?.values;
        let mut offset_v = [0.0; LIMBS];
        let mut squares_v2 = [0.0; LIMBS];
        let mut cost = departure_from_prior(prior, &unknowns.inertia_m2).norm_squared();
        for (limb, rows) in channels.iter().enumerate() {
            let left = |row: usize| -> f64 {
                let explained: f64 = initial
                    .iter()
                    .zip(&rows.triangle()[row][1..])
                    .map(|(x, r)| x * r)
                    .sum();
                rows.rotated()[row][0] - explained
            };
            offset_v[limb] = left(0) / rows.triangle()[0][0];
            let squares = rows.residual_squares()[0]
                + (1..LINEAR).map(|row| left(row) * left(row)).sum::<f64>();
            let known = unknowns.gain_ln[limb] / prior.gain_deviation[limb];
            squares_v2[limb] = squares * self.noise_v[limb] * self.noise_v[limb];
            cost += squares + known * known;
        }
        Ok(Fitted {
            unknowns: *unknowns,
            ring,
            initial,
            offset_v,
            squares_v2,
            cost,
        })
    }

    /// The next step from a fit, with the covariance of what all channels share.
    fn step(&self, prior: &Prior, fitted: &Fitted) -> Result<Step> {
        let (ring, initial) = (&fitted.ring, &fitted.initial);
        let response = self.response(&fitted.unknowns);
        let mut channels = vec![Factor::<ALL, 1>::default(); LIMBS];
        for (row, now) in self.voltage_v.iter().zip(self.instants(ring)) {
            let force = now.force(ring, initial);
            let slopes = now.sensitivities(ring, initial);
            for (limb, rows) in channels.iter_mut().enumerate() {
                let weight = 1.0 / self.noise_v[limb];
                let size = response[limb] * weight;
                let mut regressor = [0.0; ALL];
                regressor[0] = size * force[limb];
                regressor[1] = weight;
                for (entry, slope) in regressor[OWN..].iter_mut().zip(&slopes) {
                    *entry = size * slope[limb];
                }
                let shape = ring.shape(limb);
                for j in 0..MODES {
                    regressor[OWN + SHARED + j] = size * shape[j] * now.cosine[j];
                    regressor[OWN + SHARED + MODES + j] = size * shape[j] * now.sine[j];
                }
                let residual = row[limb] - fitted.offset_v[limb] - response[limb] * force[limb];
                rows.push(&regressor, &[weight * residual]);
            }
        }
        let mut common = Accumulator::<COMMON>::default();
        for (limb, rows) in channels.iter_mut().enumerate() {
            let mut known = [0.0; ALL];
            known[0] = 1.0 / prior.gain_deviation[limb];
            rows.push(&known, &[-known[0] * fitted.unknowns.gain_ln[limb]]);
            *rows = rows.settled();
            common.append(&rows.last::<COMMON>());
        }
        let departure = departure_from_prior(prior, &fitted.unknowns.inertia_m2);
        for k in 0..6 {
            let mut known = [0.0; COMMON];
            for (entry, w) in known[2..SHARED]
                .iter_mut()
                .zip(prior.whitening.row(k).iter())
            {
                *entry = *w;
            }
            common.push(known, -departure[k]);
        }
        let estimate = common.solve(WHAT)?;
        // What a gain is, given the shared unknowns: the offset of its own channel put in.
        let own = |limb: usize| -> (f64, [f64; COMMON]) {
            let [first, second, ..] = channels[limb].triangle();
            let [[b], [offset], ..] = channels[limb].rotated();
            let share = first[1] / second[1];
            (
                (b - share * offset) / first[0],
                core::array::from_fn(|k| (share * second[OWN + k] - first[OWN + k]) / first[0]),
            )
        };
        let along = estimate.covariance.column(0);
        let mut from_known_ln2 = (prior.whitening * along.fixed_rows::<6>(2)).norm_squared();
        let mut gain_ln = [0.0; LIMBS];
        for (limb, gain_ln) in gain_ln.iter_mut().enumerate() {
            let (alone, slopes) = own(limb);
            let with = |shared: &[f64]| -> f64 {
                slopes.iter().zip(shared).map(|(slope, x)| slope * x).sum()
            };
            *gain_ln = alone + with(&estimate.values);
            let known = with(along.as_slice()) / prior.gain_deviation[limb];
            from_known_ln2 += known * known;
        }
        Ok(Step {
            shared: core::array::from_fn(|k| estimate.values[k]),
            gain_ln,
            shared_covariance: Shared {
                covariance: estimate
                    .covariance
                    .fixed_view::<SHARED, SHARED>(0, 0)
                    .into_owned(),
                from_known_ln2,
            },
        })
    }

    /// Fits from a start within a few per cent of k/m.
    pub fn fit(&self, prior: &Prior, start: &Unknowns) -> Result<(Fitted, Shared)> {
        let decay = Decay {
            window: self,
            prior,
        };
        let end = iterate(&decay, self.solve(prior, start)?, LIMITS)?;
        // Where no share of a step gains, the point is the minimum to rounding.
        if end.outcome == Outcome::OutOfSteps {
            return Err(Error::NotConverged {
                what: WHAT,
                iterations: end.steps,
            });
        }
        Ok((end.at, end.step.shared_covariance))
    }

    /// Residuals of a fit, V.
    pub fn residuals_v(&self, fitted: &Fitted) -> Vec<[f64; LIMBS]> {
        let response = self.response(&fitted.unknowns);
        self.voltage_v
            .iter()
            .zip(self.instants(&fitted.ring))
            .map(|(row, now)| {
                let force = now.force(&fitted.ring, &fitted.initial);
                core::array::from_fn(|i| row[i] - fitted.offset_v[i] - response[i] * force[i])
            })
            .collect()
    }
}

/// The fit of one window.
struct Decay<'a> {
    window: &'a Window<'a>,
    prior: &'a Prior,
}

impl Nonlinear for Decay<'_> {
    type Point = Fitted;
    type Step = Step;

    fn step(&self, from: &Fitted) -> Result<Step> {
        self.window.step(self.prior, from)
    }

    fn is_negligible(&self, step: &Step) -> bool {
        let covariance = &step.shared_covariance.covariance;
        let size = (0..SHARED).fold(0.0_f64, |size, k| {
            size.max(step.shared[k].abs() / sqrt(covariance[(k, k)]))
        });
        size < SETTLED || step.shared[0].abs() < ROUNDING
    }

    fn moved(&self, from: &Fitted, step: &Step, share: f64) -> Result<Fitted> {
        self.window
            .solve(self.prior, &from.unknowns.moved(step, share))
    }

    fn is_better(&self, next: &Fitted, than: &Fitted) -> bool {
        next.cost < than.cost
    }
}

impl Unknowns {
    fn moved(&self, step: &Step, share: f64) -> Self {
        Self {
            stiffness_per_mass_per_s2: self.stiffness_per_mass_per_s2 * exp(share * step.shared[0]),
            damping_ratio: (self.damping_ratio + share * step.shared[1]).max(0.0),
            inertia_m2: core::array::from_fn(|k| self.inertia_m2[k] + share * step.shared[2 + k]),
            gain_ln: core::array::from_fn(|i| self.gain_ln[i] + share * step.gain_ln[i]),
        }
    }
}

#[cfg(test)]
mod tests;

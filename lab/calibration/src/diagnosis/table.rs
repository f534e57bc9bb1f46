//! What all trials agree on: the nine scale factors and the six inertias, read off the channels' responses one by one and
//! robustly, so that a few odd trials do not bend them.

use glam::{DMat3, DVec3};
use nalgebra::{DMatrix, DVector};
use sixaxis_core::LIMBS;
use sixaxis_core::identify::inertia::between;

use super::gravity::turned_gravity_m_s2;
use super::trial_case::{TrialCase, angles};
use crate::conditioning::Conditioned;
use crate::response::Response;
use crate::series::median;
use crate::trial::Trial;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_recordings::session::Role;

/// Shares below this are no basis for a ratio.
const SMALLEST_SHARE: f64 = 0.08;
/// Departure, relative to a trial's own size, at which an observation loses its weight in the fit of the inertias.
const ROBUST_DEPARTURE: f64 = 0.02;
/// Share of the largest singular value from which the inertias are resolved.
const RESOLVED: f64 = 1e-3;
/// One over the departure that is noticed.
const HUNDRED_FOLD: f64 = 100.0;
/// Rounds of reweighting; weights settle in a handful.
const ROUNDS: usize = 12;

/// Scale factors and inertias that most trials agree on.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// How the limbs share a load.
    pub shares: StaticLoadSharing,
    /// m/s_i of each channel: measured force over force per mass, kg.
    pub mass_over_scale_kg: [f64; LIMBS],
    /// Inertia per mass, m^2, if angular trials gave one.
    pub inertia_m2: Option<DMat3>,
    /// Relative error of the angles by which weight is taken off.
    pub angle_error: f64,
    /// Channels left out.
    pub silent: [bool; LIMBS],
}

impl Table {
    /// Scale factors from the trials that travel without turning.
    pub fn linear(
        shares: &StaticLoadSharing,
        cases: &[TrialCase<'_>],
        silent: &[bool; LIMBS],
    ) -> Option<Self> {
        let mut table = Self {
            shares: *shares,
            mass_over_scale_kg: [0.0; LIMBS],
            inertia_m2: None,
            angle_error: 0.0,
            silent: *silent,
        };
        table.fit_scale(cases);
        table
            .mass_over_scale_kg
            .iter()
            .zip(silent)
            .all(|(h, silent)| *silent || *h != 0.0)
            .then_some(table)
    }

    /// With what is no longer taken to be usable left out, and with the inertias.
    #[must_use]
    pub fn fitted(mut self, cases: &[TrialCase<'_>]) -> Self {
        self.fit_scale(cases);
        self.fit_inertia(cases);
        self
    }

    fn fit_scale(&mut self, cases: &[TrialCase<'_>]) {
        for channel in 0..LIMBS {
            if self.silent[channel] {
                continue;
            }
            let share_of = |d: DVec3| self.shares.of_acceleration(channel).dot(d);
            let mut ratios: Vec<(f64, f64)> = usable(cases)
                .filter(|(case, _)| {
                    !matches!(case.trial.role, Role::Angular | Role::Validation)
                        && !case.ignored[channel]
                })
                .filter_map(|(case, response)| {
                    let share = share_of(case.trial.direction_ground);
                    (share.abs() > SMALLEST_SHARE)
                        .then(|| (response.channels[channel].response / share, share.abs()))
                })
                .collect();
            self.mass_over_scale_kg[channel] = weighted_median(&mut ratios).unwrap_or(0.0);
        }
    }

    /// Inertias from the angular trials, by iteratively reweighted least squares.
    fn fit_inertia(&mut self, cases: &[TrialCase<'_>]) {
        let observations: Vec<(usize, [f64; 6], f64)> = usable(cases)
            .enumerate()
            .filter(|(_, (case, _))| case.trial.role == Role::Angular)
            .flat_map(|(index, (case, response))| {
                let n = case.trial.direction_ground;
                (0..LIMBS)
                    .filter(|channel| !self.silent[*channel] && !case.ignored[*channel])
                    .map(|channel| {
                        let t = self.shares.of_torque_per_m(channel);
                        let row = between(t, n);
                        let seen =
                            response.channels[channel].response / self.mass_over_scale_kg[channel];
                        (index, row, seen)
                    })
                    .collect::<Vec<_>>()
            })
            .collect();
        self.inertia_m2 = None;
        if observations.len() < 6 {
            return;
        }
        let mut weights = vec![1.0; observations.len()];
        let size = median(observations.iter().map(|(_, _, y)| y.abs())).unwrap_or(1.0);
        for round in 0..ROUNDS {
            let matrix = DMatrix::from_fn(observations.len(), 6, |i, j| {
                observations[i].1[j] * weights[i]
            });
            let mut right =
                DVector::from_fn(observations.len(), |i, _| observations[i].2 * weights[i]);
            // Many rows first made six: the singular values are the same, and this is done thousands of times.
            let rotated = matrix.qr();
            rotated.q_tr_mul(&mut right);
            let Some(svd) = rotated.r().try_svd(true, true, f64::EPSILON, 1000) else {
                return;
            };
            // Written so that NaN resolves nothing.
            let resolved = svd.singular_values.min() > RESOLVED * svd.singular_values.max();
            if !resolved {
                return;
            }
            let Ok(solution) = svd.solve(&right.rows(0, 6), 0.0) else {
                return;
            };
            let i: [f64; 6] = core::array::from_fn(|k| solution[k]);
            self.inertia_m2 = Some(DMat3::from_cols(
                DVec3::new(i[0], i[3], i[4]),
                DVec3::new(i[3], i[1], i[5]),
                DVec3::new(i[4], i[5], i[2]),
            ));
            if round + 1 == ROUNDS {
                break;
            }
            // Whole trials lose weight together: what is odd is a trial, or a channel of one.
            for (w, (_, row, seen)) in weights.iter_mut().zip(&observations) {
                let predicted: f64 = row.iter().zip(&i).map(|(a, b)| a * b).sum();
                let departure = (seen - predicted).abs() / size / ROBUST_DEPARTURE;
                *w = 1.0 / (1.0 + departure * departure);
            }
        }
    }

    /// What a channel's force should be over the waveform of a trial with the given direction, per direction component, over
    /// its m/s: m/s^2 over m/s^2, or m^2 over 1.
    pub fn share(&self, channel: usize, response: &Response) -> DVec3 {
        let linear = response.linear_over_waveform * self.shares.of_acceleration(channel);
        let turning = response.angular_over_waveform;
        match self.inertia_m2 {
            // I is symmetric: t . I n = (I t) . n.
            Some(inertia) if turning != 0.0 => {
                linear + turning * (inertia * self.shares.of_torque_per_m(channel))
            }
            _ => linear,
        }
    }

    /// Force per mass that the standards of a trial make one expect of a channel at each of its samples, m/s^2, with the weight that
    /// turns; none where something turns and no inertia is known.
    pub fn force_per_mass_m_s2(
        &self,
        channel: usize,
        trial: &Trial,
        conditioned: &Conditioned,
    ) -> Option<Vec<f64>> {
        let of_acceleration = self.shares.of_acceleration(channel);
        let of_torque_per_m = self.shares.of_torque_per_m(channel);
        let turns = matches!(trial.role, Role::Angular | Role::Validation);
        let inertia = match turns {
            true => self.inertia_m2?,
            false => DMat3::ZERO,
        };
        let turning = (conditioned.angular_shell_rad_s2.iter()).zip(&conditioned.rate_shell_rad_s);
        let motion = conditioned.linear_ground_m_s2.iter().zip(turning);
        let force = motion.zip(angles(conditioned, trial));
        let force = force.map(|((acceleration, (angular, rate)), angle)| {
            let (gravity, axis) = (trial.gravity_ground_m_s2, trial.direction_ground);
            let weight = match turns {
                true => turned_gravity_m_s2(gravity, axis, angle),
                false => DVec3::ZERO,
            };
            let torque = inertia * *angular + rate.cross(inertia * *rate);
            of_acceleration.dot(*acceleration + weight) + of_torque_per_m.dot(torque)
        });
        Some(force.collect())
    }

    /// Observed and expected responses of a trial, both over m/s.
    pub fn compare(
        &self,
        case: &TrialCase<'_>,
        response: &Response,
    ) -> ([f64; LIMBS], [f64; LIMBS]) {
        let d = case.trial.direction_ground;
        let seen = core::array::from_fn(|i| {
            if self.silent[i] {
                0.0
            } else {
                response.channels[i].response / self.mass_over_scale_kg[i]
            }
        });
        let expected = core::array::from_fn(|i| {
            if self.silent[i] {
                0.0
            } else {
                self.share(i, response).dot(d)
            }
        });
        (seen, expected)
    }

    /// What the error of the angle leaves in the forces per mass, all nine together, of the weight that turns in the sensor
    /// during a trial, m/s^2.
    pub fn weight_left_m_s2(&self, case: &TrialCase<'_>, response: &Response) -> f64 {
        let trial = case.trial;
        if matches!(trial.role, Role::Linear | Role::HighFrequencyLinear) {
            return 0.0;
        }
        let weight = trial
            .gravity_ground_m_s2
            .reject_from(trial.direction_ground)
            .length();
        let shares: f64 = (0..LIMBS)
            .map(|limb| self.shares.of_acceleration(limb).length_squared())
            .sum();
        // The rig's rotation is a sine of the drive's frequency.
        let angle = response.peak_rate_rad_s / (core::f64::consts::TAU * trial.frequency_hz);
        weight * shares.sqrt() * self.angle_error * angle
    }

    /// Size that a trial's departures are relative to: its expected responses and, where it turns against gravity, a hundred times
    /// what the error of the angle leaves of the weight, so that as much is not noticed.
    pub fn size(&self, case: &TrialCase<'_>, response: &Response, expected: &[f64; LIMBS]) -> f64 {
        let turning = self.weight_left_m_s2(case, response) / response.peak;
        norm(expected) + HUNDRED_FOLD * turning
    }

    /// Departure of all trials from the table, each relative to its own size and none counting for more than `cap`.
    pub fn cost(&self, cases: &[TrialCase<'_>], cap: f64) -> f64 {
        usable(cases)
            .filter(|(case, _)| match case.trial.role {
                Role::Validation => false,
                Role::Angular => self.inertia_m2.is_some(),
                _ => true,
            })
            .map(|(case, response)| {
                let (seen, expected) = self.compare(case, response);
                let size = self.size(case, response, &expected);
                (0..LIMBS)
                    .filter(|i| !case.ignored[*i])
                    .map(|i| ((seen[i] - expected[i]) / size).abs().min(cap))
                    .map(|e| e * e)
                    .sum::<f64>()
            })
            .sum()
    }
}

/// Trials with a response that no earlier finding explains.
pub fn usable<'s, 'a>(
    cases: &'s [TrialCase<'a>],
) -> impl Iterator<Item = (&'s TrialCase<'a>, &'s Response)> {
    cases
        .iter()
        .filter(|case| !case.explained)
        .filter_map(|case| case.response.as_ref().map(|response| (case, response)))
}

/// Length of a vector of nine.
pub fn norm(v: &[f64; LIMBS]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Value at which half of the weight is below. Reorders its argument.
pub fn weighted_median(pairs: &mut [(f64, f64)]) -> Option<f64> {
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * pairs.iter().map(|p| p.1).sum::<f64>();
    let mut below = 0.0;
    pairs
        .iter()
        .find(|(_, weight)| {
            below += weight;
            below >= half
        })
        .map(|(value, _)| *value)
}

//! One trial's part in its step's own error, and what its step makes of the earlier ones.

use glam::DVec3;
use nalgebra::{SMatrix, SVector};
use sixaxis_core::decouple::uncertainty::influence::{
    ComplianceInfluence, InertiaInfluence, ScaleInfluence, column, force_per_volt, torque_per_volt,
};
use sixaxis_core::decouple::uncertainty::parameters::{Chain, Covariance, Errors};
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::parameter::{COMPLIANCE, DRIFT, INERTIA, SCALE};
use sixaxis_core::{Geometry, LIMBS, Parameters, Result};

use super::TrialNoise;
use crate::conditioning::{Conditioned, Conditioning};
use crate::steps::{Campaign, rows};
use crate::trial::{Trial, same_wedge};
use sixaxis_recordings::session::Role;

/// What a trial adds.
#[derive(Debug, Clone, Default)]
pub(super) struct StepError {
    chain: Chain,
    noise: Covariance,
    gain: [Errors; 2],
}

impl StepError {
    pub(super) fn add_to(&self, chain: &mut Chain, noise: &mut Covariance, gain: &mut [Errors; 2]) {
        chain.append(&self.chain);
        *noise += self.noise;
        for (sum, more) in gain.iter_mut().zip(&self.gain) {
            *sum += more;
        }
    }

    /// Adds white noise of deviation `sd` that reaches N parameters from `place` on with this influence at each sample.
    fn add_white<const N: usize>(
        &mut self,
        place: usize,
        sd: f64,
        influence: impl Iterator<Item = SVector<f64, N>>,
    ) {
        let mut sum = SMatrix::<f64, N, N>::zeros();
        for h in influence {
            sum.ger(1.0, &h, &h, 1.0);
        }
        let mut block = self.noise.fixed_view_mut::<N, N>(place, place);
        block += sum * (sd * sd);
    }

    /// Adds what errors of the drifts and scale factors do to N parameters from `place` on through the torques of a sample that
    /// the parameters answer with `answer`.
    fn add_torques<const N: usize>(
        &mut self,
        place: usize,
        answer: &SMatrix<f64, N, 3>,
        per_volt: &[DVec3; LIMBS],
        arms_m: &[DVec3; LIMBS],
        measured_n: &[f64; LIMBS],
    ) {
        for i in 0..LIMBS {
            // A drift taken too high is a voltage taken too low.
            let drift = -(answer * column(per_volt[i]));
            self.chain.add(place, &drift, DRIFT.start + i);
            let scale = answer * column(arms_m[i]) * measured_n[i];
            self.chain.add(place, &scale, SCALE.start + i);
        }
    }

    fn add_gain<const N: usize>(&mut self, standard: usize, place: usize, error: &SVector<f64, N>) {
        let mut part = self.gain[standard].fixed_rows_mut::<N>(place);
        part += error;
    }
}

/// How the steps answer, and to what.
pub(super) struct Sensitivities<'a> {
    pub geometry: Geometry,
    pub conditioning: &'a Conditioning,
    pub parameters: &'a Parameters,
    pub scale: ScaleInfluence,
    pub inertia: InertiaInfluence,
    pub fourth: FourthStep,
}

/// Step 4 at its solution: for each trial of the campaign the change of w* with the compliance, (rad/s)/s^2, at each decoupled
/// sample, the first of which is sample 1; nothing for trials of other steps.
#[derive(Debug)]
pub(super) struct FourthStep {
    slopes: Vec<Vec<DVec3>>,
    slope_squares: f64,
}

impl FourthStep {
    pub(super) fn new(campaign: &Campaign, parameters: &Parameters) -> Result<Self> {
        let mut slopes = vec![Vec::new(); campaign.trials.len()];
        let fit = campaign.compliance_fit(parameters, |index, slope| slopes[index].push(slope))?;
        Ok(Self {
            slopes,
            slope_squares: fit.slope_squares(),
        })
    }
}

/// First decoupled sample.
const FIRST: usize = 1;

impl Sensitivities<'_> {
    pub(super) fn linear(
        &self,
        trial: &Trial,
        conditioned: &Conditioned,
        noise: &TrialNoise,
    ) -> Result<StepError> {
        let mut own = StepError::default();
        let signal = SignalChain::new(&trial.gains, self.parameters);
        let force = force_per_volt(&signal);
        let direction = column(trial.direction_ground);
        let mut sensitivities = vec![SMatrix::<f64, LIMBS, 3>::zeros(); trial.voltage_v.len()];
        for t in rows(trial) {
            let answer = self.scale_at(trial, conditioned, t);
            for (i, f) in force.iter().enumerate() {
                // A drift taken too high is a voltage taken too low.
                own.chain
                    .add(SCALE.start, &(answer * column(*f)), DRIFT.start + i);
            }
            own.add_gain(
                0,
                SCALE.start,
                &(answer * column(conditioned.linear_ground_m_s2[t])),
            );
            sensitivities[t] = answer;
        }
        let mut raw = sensitivities.clone();
        each_series(&mut raw, &mut |series| {
            self.conditioning.voltage_transposed(trial, series)
        })?;
        for (f, sd) in force.iter().zip(noise.channels_v) {
            own.add_white(SCALE.start, sd, raw.iter().map(|z| -(z * column(*f))));
        }
        let mut along: Vec<SMatrix<f64, LIMBS, 1>> = sensitivities
            .iter()
            .map(|answer| answer * direction)
            .collect();
        each_series(&mut along, &mut |series| {
            self.conditioning.accelerometer_transposed(trial, series)
        })?;
        own.add_white(SCALE.start, noise.accelerometer_m_s2, along.into_iter());
        Ok(own)
    }

    fn scale_at(
        &self,
        trial: &Trial,
        conditioned: &Conditioned,
        t: usize,
    ) -> SMatrix<f64, LIMBS, 3> {
        self.scale.of_sample(&self.measured(trial, conditioned, t))
    }

    fn measured(&self, trial: &Trial, conditioned: &Conditioned, t: usize) -> [f64; LIMBS] {
        trial
            .gains
            .measured_force_n(&conditioned.voltage_v[t], &self.parameters.zero_drift_v)
    }

    pub(super) fn angular(
        &self,
        trial: &Trial,
        conditioned: &Conditioned,
        noise: &TrialNoise,
    ) -> Result<StepError> {
        let mut own = StepError::default();
        let signal = SignalChain::new(&trial.gains, self.parameters);
        let torque = torque_per_volt(&self.geometry, &signal);
        let arms = self.geometry.arms_m();
        let axis = trial.direction_ground;
        let samples = trial.voltage_v.len();
        let mut sensitivities = vec![SMatrix::<f64, 6, 3>::zeros(); samples];
        let mut of_rate = vec![SVector::<f64, 6>::zeros(); samples];
        let mut of_derivative = of_rate.clone();
        for t in rows(trial) {
            let (rate, derivative) = (
                conditioned.rate_shell_rad_s[t],
                conditioned.angular_shell_rad_s2[t],
            );
            let answer = self.inertia.of_sample(rate, derivative);
            let measured = self.measured(trial, conditioned, t);
            own.add_torques(INERTIA.start, &answer, &torque, &arms, &measured);
            own.add_gain(
                1,
                INERTIA.start,
                &(answer * column(self.inertia.of_gain(rate, derivative))),
            );
            let discrepancy = |more_rate, more_derivative| {
                answer * column(self.inertia.of_reading(rate, more_rate, more_derivative))
            };
            of_rate[t] = discrepancy(axis, DVec3::ZERO);
            of_derivative[t] = discrepancy(DVec3::ZERO, axis);
            sensitivities[t] = answer;
        }
        each_series(&mut sensitivities, &mut |series| {
            self.conditioning.voltage_transposed(trial, series)
        })?;
        for (m, sd) in torque.iter().zip(noise.channels_v) {
            own.add_white(
                INERTIA.start,
                sd,
                sensitivities.iter().map(|z| z * column(*m)),
            );
        }
        let mut gyroscope = vec![SVector::<f64, 6>::zeros(); samples];
        for entry in 0..6 {
            let series = |of: &[SVector<f64, 6>]| of.iter().map(|h| h[entry]).collect::<Vec<_>>();
            let raw = self.conditioning.gyroscope_transposed(
                trial,
                &series(&of_rate),
                &series(&of_derivative),
            )?;
            for (h, value) in gyroscope.iter_mut().zip(raw) {
                h[entry] = value;
            }
        }
        own.add_white(INERTIA.start, noise.gyroscope_rad_s, gyroscope.into_iter());
        Ok(own)
    }

    /// None where step 4 does not determine the compliance.
    pub(super) fn fast_linear(
        &self,
        trial: &Trial,
        conditioned: &Conditioned,
        noise: &TrialNoise,
        index: usize,
    ) -> Result<Option<StepError>> {
        let influence = ComplianceInfluence::new(
            &self.parameters.inertia_per_mass,
            trial.sample_rate_hz,
            self.fourth.slope_squares,
        );
        let Some(influence) = influence else {
            return Ok(None);
        };
        let mut own = StepError::default();
        let mut weights = self.fourth.slopes[index].clone();
        influence.of_trial(&mut weights);
        let signal = SignalChain::new(&trial.gains, self.parameters);
        let torque = torque_per_volt(&self.geometry, &signal);
        let arms = self.geometry.arms_m();
        let mut sensitivities = vec![SMatrix::<f64, 1, 3>::zeros(); trial.voltage_v.len()];
        for (t, weight) in (FIRST..).zip(&weights) {
            let answer = column(*weight).transpose();
            let measured = self.measured(trial, conditioned, t);
            own.add_torques(COMPLIANCE, &answer, &torque, &arms, &measured);
            sensitivities[t] = answer;
        }
        each_series(&mut sensitivities, &mut |series| {
            self.conditioning.voltage_transposed(trial, series)
        })?;
        for (m, sd) in torque.iter().zip(noise.channels_v) {
            own.add_white(COMPLIANCE, sd, sensitivities.iter().map(|z| z * column(*m)));
        }
        Ok(Some(own))
    }
}

/// Own errors of the steps for a unit tilt, rad, of each wedge about either axis square to it. Trials of steps 2 and 3 that say
/// the same direction stand on the same wedge.
pub(super) fn wedge_errors(sensitivities: &Sensitivities, campaign: &Campaign) -> Vec<Errors> {
    let mut wedges: Vec<DVec3> = Vec::new();
    let used = |role| matches!(role, Role::Linear | Role::Angular);
    for (trial, _) in campaign.trials.iter().filter(|(t, _)| used(t.role)) {
        let direction = trial.direction_ground;
        if !wedges.iter().any(|w| same_wedge(*w, direction)) {
            wedges.push(direction);
        }
    }
    let mut errors = Vec::new();
    for wedge in wedges {
        let (first, second) = wedge.any_orthonormal_pair();
        for tilt in [first, second] {
            let mut own = Errors::zeros();
            for (trial, conditioned) in &campaign.trials {
                let direction = trial.direction_ground;
                if !used(trial.role) || !same_wedge(direction, wedge) {
                    continue;
                }
                // The sensor turned by the tilt: what the session says lacks it.
                for t in rows(trial) {
                    if trial.role == Role::Linear {
                        let lacking = -tilt * conditioned.linear_ground_m_s2[t].dot(direction);
                        let answer =
                            sensitivities.scale_at(trial, conditioned, t) * column(lacking);
                        let mut part = own.fixed_rows_mut::<LIMBS>(SCALE.start);
                        part += answer;
                    } else {
                        let (rate, derivative) = (
                            conditioned.rate_shell_rad_s[t],
                            conditioned.angular_shell_rad_s2[t],
                        );
                        let lacking = sensitivities.inertia.of_reading(
                            rate,
                            -tilt * rate.dot(direction),
                            -tilt * derivative.dot(direction),
                        );
                        let answer =
                            sensitivities.inertia.of_sample(rate, derivative) * column(lacking);
                        let mut part = own.fixed_rows_mut::<6>(INERTIA.start);
                        part += answer;
                    }
                }
            }
            errors.push(own);
        }
    }
    errors
}

/// Runs a transposed stage over each entry's series; one that is zero throughout stays so.
fn each_series<const N: usize, const M: usize>(
    samples: &mut [SMatrix<f64, N, M>],
    stage: &mut dyn FnMut(&mut Vec<f64>) -> Result<()>,
) -> Result<()> {
    for i in 0..N {
        for j in 0..M {
            let mut series: Vec<f64> = samples.iter().map(|s| s[(i, j)]).collect();
            if series.iter().all(|x| *x == 0.0) {
                continue;
            }
            stage(&mut series)?;
            for (s, value) in samples.iter_mut().zip(series) {
                s[(i, j)] = value;
            }
        }
    }
    Ok(())
}

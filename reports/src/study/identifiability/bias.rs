//! Step 4's curve in closed form, to first order in the limbs' compliance and in the scale factors' errors.

use anyhow::Result;
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use sixaxis_calibration::conditioning::Conditioned;
use sixaxis_calibration::steps::{Campaign, FourSteps, rows};
use sixaxis_calibration::trial::Trial;
use sixaxis_core::identify::bias::{ComplianceEffect, LinearMotion};
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::identify::stiffness;
use sixaxis_core::{LIMBS, LimbLaw, Parameters, Scheme};
use sixaxis_recordings::session::Role;

use crate::study::results::identifiability::{Bias, Records};

/// Rates that step 4's trials would have by first-order theory.
pub struct FirstOrderSearch {
    effect: ComplianceEffect,
    true_compliance_s2: f64,
    trials: Vec<TrialRates>,
}

/// One trial, sample by sample: integrals of torques over the inertia.
struct TrialRates {
    /// Rate per unit of 1/(k/m), rad/s^3.
    of_compliance: Vec<DVec3>,
    /// Rate per unit of each scale factor's relative error, rad/s.
    of_scale: Vec<[DVec3; LIMBS]>,
}

impl FirstOrderSearch {
    /// From the motions of step 4's trials.
    ///
    /// # Errors
    /// Those of [`ComplianceEffect::new`].
    pub fn new(campaign: &Campaign, truth: &Parameters) -> Result<Self> {
        let effect = ComplianceEffect::new(&campaign.geometry, &truth.inertia_per_mass)?;
        let back = truth.inertia_per_mass.matrix_mass_m2().inverse();
        let trials = of_role(campaign, Role::HighFrequencyLinear)
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|(trial, conditioned)| rates(&effect, back, trial, conditioned))
            .collect();
        Ok(Self {
            effect,
            true_compliance_s2: 1.0 / truth.stiffness_per_mass_per_s2,
            trials,
        })
    }

    /// Mean |w*| over the paper's grid with scale factors that are in error by `eps`, relative.
    pub fn curve(&self, eps: &[f64; LIMBS]) -> Vec<(f64, f64)> {
        self.curve_of(&self.trials, eps)
    }

    fn curve_of(&self, trials: &[TrialRates], eps: &[f64; LIMBS]) -> Vec<(f64, f64)> {
        let grid: Vec<f64> = stiffness::paper_grid().collect();
        // Away from the sample loop, which is then free of divisions and goes through vector registers.
        let compliance_error: Vec<f64> = grid
            .iter()
            .map(|k| 1.0 / k - self.true_compliance_s2)
            .collect();
        let mut sums = vec![0.0; grid.len()];
        let mut samples = 0;
        for trial in trials {
            for (of_compliance, of_scale) in trial.of_compliance.iter().zip(&trial.of_scale) {
                let constant = scaled_sum(of_scale, eps);
                for (sum, error) in sums.iter_mut().zip(&compliance_error) {
                    *sum += (*of_compliance * *error + constant).length();
                }
                samples += 1;
            }
        }
        let mean = |sum: f64| sum / f64::from(samples.max(1));
        grid.into_iter().zip(sums.into_iter().map(mean)).collect()
    }
}

fn scaled_sum(of_scale: &[DVec3; LIMBS], eps: &[f64; LIMBS]) -> DVec3 {
    let parts = of_scale.iter().zip(eps);
    parts.fold(DVec3::ZERO, |sum, (rate, eps)| sum + *rate * *eps)
}

fn of_role(campaign: &Campaign, role: Role) -> impl Iterator<Item = (&Trial, &Conditioned)> {
    let trials = campaign.trials.iter();
    trials
        .filter(move |(trial, _)| trial.role == role)
        .map(|(trial, conditioned)| (trial, conditioned))
}

/// What the standards say of a sample. The ends of a trial take their neighbours' second difference.
fn motion(trial: &Trial, conditioned: &Conditioned, sample: usize) -> LinearMotion {
    let a = &conditioned.linear_ground_m_s2;
    let second = match a.len() {
        0..3 => DVec3::ZERO,
        n => {
            let middle = sample.clamp(1, n - 2);
            let difference = a[middle + 1] - 2.0 * a[middle] + a[middle - 1];
            difference * trial.sample_rate_hz.powi(2)
        }
    };
    LinearMotion {
        acceleration_m_s2: a[sample],
        acceleration_second_derivative_m_s4: second,
        gravity_m_s2: trial.gravity_ground_m_s2,
    }
}

fn unit(limb: usize) -> [f64; LIMBS] {
    core::array::from_fn(|i| if i == limb { 1.0 } else { 0.0 })
}

fn rates(
    effect: &ComplianceEffect,
    back: DMat3,
    trial: &Trial,
    conditioned: &Conditioned,
) -> TrialRates {
    let half_step_s = 0.5 / trial.sample_rate_hz;
    let mut out = TrialRates {
        of_compliance: Vec::new(),
        of_scale: Vec::new(),
    };
    let mut before = None;
    let mut compliance = DVec3::ZERO;
    let mut scale = [DVec3::ZERO; LIMBS];
    for sample in 0..conditioned.linear_ground_m_s2.len() {
        let now = motion(trial, conditioned, sample);
        let torques = (
            back * effect.torque_m2_s4(&now),
            core::array::from_fn::<DVec3, LIMBS, _>(|limb| {
                back * effect.torque_of_scale_error(&unit(limb), now.acceleration_m_s2)
            }),
        );
        if let Some((d, e)) = before.replace(torques) {
            compliance += (d + torques.0) * half_step_s;
            for limb in 0..LIMBS {
                scale[limb] += (e[limb] + torques.1[limb]) * half_step_s;
            }
        }
        out.of_compliance.push(compliance);
        out.of_scale.push(scale);
    }
    out
}

/// Relative errors that step 2 makes of its scale factors because it takes the limbs as rigid.
///
/// # Errors
/// Those of step 2.
fn scale_error(
    campaign: &Campaign,
    effect: &ComplianceEffect,
    compliance_s2: f64,
    gravity: bool,
) -> Result<[f64; LIMBS]> {
    let mut step = ScaleIdentification::default();
    for (trial, conditioned) in of_role(campaign, Role::Linear) {
        for sample in rows(trial) {
            let mut now = motion(trial, conditioned, sample);
            if !gravity {
                now.gravity_m_s2 = DVec3::ZERO;
            }
            let forces = effect.rigid_forces_m_s2(now.acceleration_m_s2);
            step.push(&forces, effect.neglected_force_m_s4(&now))?;
        }
    }
    Ok(step.solve()?.estimate.values.map(|eps| eps * compliance_s2))
}

/// k/m that each of step 4's trials finds alone, s^-2.
fn single_trials(campaign: &Campaign, found: &FourSteps) -> Result<Vec<f64>> {
    of_role(campaign, Role::HighFrequencyLinear)
        .map(|(trial, conditioned)| {
            let one = Campaign {
                geometry: campaign.geometry,
                design: campaign.design,
                static_voltage_v: Vec::new(),
                trials: vec![(trial.clone(), conditioned.clone())],
            };
            let law = LimbLaw::CompressionShortens;
            let curve = one.search(&found.found(), Scheme::Heun, 1, law)?;
            Ok(stiffness::judge(&curve)?.interpolated_per_s2)
        })
        .collect()
}

/// Smallest and largest of some positive numbers.
pub fn ends(values: &[f64]) -> (f64, f64) {
    let ends = (f64::INFINITY, 0.0_f64);
    values
        .iter()
        .fold(ends, |(low, high), v| (low.min(*v), high.max(*v)))
}

/// Measured and predicted.
///
/// # Errors
/// Those of step 2 and of the judgement of a curve.
pub fn study(
    records: Records,
    campaign: &Campaign,
    found: &FourSteps,
    truth: &Parameters,
    theory: &FirstOrderSearch,
) -> Result<Bias> {
    let (effect, y) = (&theory.effect, theory.true_compliance_s2);
    let predicted = scale_error(campaign, effect, y, true)?;
    let curve_predicted = theory.curve(&predicted);
    let stiffness_predicted_per_s2 = stiffness::judge(&curve_predicted)?.interpolated_per_s2;
    let (mut limb, mut compliance, mut scale, mut samples) = (0.0, 0.0, 0.0, 0u32);
    for (trial, conditioned) in of_role(campaign, Role::HighFrequencyLinear) {
        for sample in 0..conditioned.linear_ground_m_s2.len() {
            let now = motion(trial, conditioned, sample);
            let a = now.acceleration_m_s2;
            limb += (a * campaign.geometry.half_edge_m).length_squared();
            compliance += (effect.torque_m2_s4(&now) * y).length_squared();
            scale += effect.torque_of_scale_error(&predicted, a).length_squared();
            samples += 1;
        }
    }
    let rms = |squares: f64| (squares / f64::from(samples.max(1))).sqrt();
    let measured = found.scale.estimate.values;
    let single_predicted = theory
        .trials
        .iter()
        .map(|trial| {
            let curve = theory.curve_of(core::slice::from_ref(trial), &predicted);
            Ok(stiffness::judge(&curve)?.interpolated_per_s2)
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(Bias {
        records,
        scale_error_measured: core::array::from_fn(|i| {
            measured[i] / truth.scale_per_mass_per_kg[i] - 1.0
        }),
        scale_error_predicted: predicted,
        scale_error_without_gravity: scale_error(campaign, effect, y, false)?,
        torque_of_a_limb: rms(limb),
        torque_of_compliance: rms(compliance),
        torque_of_scale_error: rms(scale),
        stiffness_measured_per_s2: found
            .stiffness
            .as_ref()
            .map_or(f64::NAN, |s| s.interpolated_per_s2),
        stiffness_predicted_per_s2,
        single_trial_measured_per_s2: ends(&single_trials(campaign, found)?),
        single_trial_predicted_per_s2: ends(&single_predicted),
        left_after_a_pass: -(1.0 / stiffness_predicted_per_s2 / y - 1.0),
        curve_measured: found.curve.clone(),
        curve_predicted,
    })
}

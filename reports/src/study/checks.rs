//! The reference against theory, and what single defects of the signal chain cost.

use anyhow::Result;
use core::f64::consts::PI;
use rand_pcg::Pcg64;
use sixaxis_core::dsp::lag::undo_high_pass;
use sixaxis_core::paper::preload::static_preload_m_s2;
use sixaxis_core::{Geometry, LIMBS, Parameters, Scheme};
use sixaxis_props::truth;
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::chain::{Chain, Coupling};
use sixaxis_reference::laboratory::instruments::Instruments;
use sixaxis_reference::laboratory::plan::RigPlan;
use sixaxis_reference::laboratory::schedule::PlannedTrial;
use sixaxis_reference::laboratory::schedule::compound_trials;
use sixaxis_reference::linear_theory::relative_acceleration;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::mujoco::simulation::Simulation;
use sixaxis_reference::mujoco::threshold;
use sixaxis_reference::paper;
use sixaxis_reference::rig::run::{Mode, Mounting, ROTATION_AMPLITUDE_RAD, Run};

use super::compound::COMPARED_DIVISOR;
use super::decoupling::{decouple, largest_error, six_series, truth};
use super::plan::{CAMPAIGN_RATE_HZ, CAMPAIGN_STEPS, COMPOUND_RATE_HZ, COMPOUND_STEPS, Plan};
use super::results::{Defects, Gravity, ModeSet, ReferenceCheck, Sweep};
use super::session::{self, Preset};
use super::simulations::{Simulations, sweep_kinds};

/// Corner of the AC-coupled amplifier whose cost is shown, Hz: a tenth of the lowest drive frequency.
const AMPLIFIER_CORNER_HZ: f64 = 0.1;
/// Sensitivity of the standard gyroscope, V per deg/s.
const GYROSCOPE_V_PER_DEG_S: f64 = 10e-3;

/// How good the reference is.
///
/// # Errors
/// Those of the simulation and of the equilibrium.
pub fn reference(plan: &Plan, simulations: &Simulations) -> Result<ReferenceCheck> {
    let parameters = truth::identified_parameters();
    let [trial, ..] = compound_trials(&RigPlan::one_turn(Mounting::AxisVertical));
    let model = truth::model(&parameters, trial.gravity_ground_m_s2());
    let held = Run::new(Mode::Rest, 1.0, trial.run.direction_ground);
    let mut simulation = Simulation::new(&model, 1.0 / CAMPAIGN_RATE_HZ / CAMPAIGN_STEPS as f64)?;
    let measured = simulation.snapshot(&held).limb_elongation_m;
    let predicted = static_preload_m_s2(
        &Geometry::PAPER,
        parameters.stiffness_per_mass_per_s2,
        model.gravity_ground_m_s2,
    )?
    .map(|force| -force / parameters.stiffness_per_mass_per_s2);
    let largest = predicted.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let difference = (0..LIMBS).fold(0.0_f64, |a, i| a.max((measured[i] - predicted[i]).abs()));
    Ok(ReferenceCheck {
        static_elongation_relative: difference / largest,
        static_elongation_m: largest,
        modes: ["design", "identified"]
            .into_iter()
            .zip(simulations.ring_downs)
            .map(|(sensor, modes)| ModeSet {
                sensor: sensor.to_owned(),
                predicted_hz: modes.map(|m| m.predicted_hz),
                measured_hz: modes.map(|m| m.measured_hz),
            })
            .collect(),
        campaign_step_s: 1.0 / CAMPAIGN_RATE_HZ / plan.campaign_steps() as f64,
        compound_step_s: 1.0 / COMPOUND_RATE_HZ / COMPOUND_STEPS as f64,
    })
}

/// Fig. 7.
pub fn sweeps(simulations: &Simulations) -> Vec<Sweep> {
    sweep_kinds()
        .into_iter()
        .zip(&simulations.sweeps)
        .map(|((name, sensor, mode), points)| {
            let threshold = if mode == Mode::Angular {
                paper::ANGULAR_THRESHOLD_RAD_S2
            } else {
                paper::LINEAR_THRESHOLD_M_S2
            };
            let at = |frequency: f64| {
                points
                    .windows(2)
                    .find(|pair| pair[1].frequency_hz >= frequency)
                    .map_or(f64::NAN, |pair| {
                        let share = (frequency / pair[0].frequency_hz).ln()
                            / (pair[1].frequency_hz / pair[0].frequency_hz).ln();
                        pair[0].relative_acceleration
                            * (pair[1].relative_acceleration / pair[0].relative_acceleration)
                                .powf(share)
                    })
            };
            Sweep {
                sensor: name.to_owned(),
                mode,
                theory: points
                    .iter()
                    .map(|p| {
                        relative_acceleration(&sensor, &threshold::excitation(mode, p.frequency_hz))
                    })
                    .collect(),
                threshold,
                crossing_hz: threshold::crossing_hz(points, threshold),
                slope: threshold::log_slope(
                    points
                        .iter()
                        .map(|p| (p.frequency_hz, p.relative_acceleration)),
                ),
                at_2_and_4_hz: [at(2.0), at(4.0)],
                points: points.clone(),
            }
        })
        .collect()
}

/// What single defects cost.
///
/// # Errors
/// Those of identification and decoupling.
pub fn defects(simulations: &Simulations, parameters: &Parameters) -> Result<Defects> {
    let slow = simulations.compound[0].decimated(COMPARED_DIVISOR);
    let (amplifier_left_alone, amplifier_undone) = amplifier(&slow, parameters)?;
    let level = simulations.axis_level[0].decimated(COMPARED_DIVISOR);
    let recording = Laboratory::noise_free(truth::sensor(parameters)).record(&level, 0);
    let level_axis = |gravity| -> Result<f64> {
        let voltage_v = &recording.voltage_v;
        let scheme = Scheme::AdamsMoulton4;
        let samples = decouple(&recording, voltage_v, parameters, scheme, gravity)?;
        Ok(worst(&largest_error(&six_series(&samples), &truth(&level))))
    };
    Ok(Defects {
        amplifier_corner_hz: AMPLIFIER_CORNER_HZ,
        amplifier_left_alone,
        amplifier_undone,
        gyroscope_lag_left_alone: lag(&simulations.campaign, parameters, false)?,
        gyroscope_lag_undone: lag(&simulations.campaign, parameters, true)?,
        gravity_neglected_frequency_hz: level.motion.frequency_hz,
        gravity_neglected: level_axis(Gravity::Neglected)?,
        gravity_kept: level_axis(Gravity::Kept)?,
        gyroscope_output_v: GYROSCOPE_V_PER_DEG_S
            * (ROTATION_AMPLITUDE_RAD * core::f64::consts::TAU * 5.0)
            * (180.0 / PI),
    })
}

fn amplifier(run: &SimulatedRun, parameters: &Parameters) -> Result<(f64, f64)> {
    let coupled = Laboratory {
        chain: Chain {
            coupling: Coupling::AlternatingCurrent {
                corner_hz: AMPLIFIER_CORNER_HZ,
            },
            ..Chain::noise_free()
        },
        ..Laboratory::noise_free(truth::sensor(parameters))
    };
    let recording = coupled.record(run, 0);
    let error = |voltage: &[[f64; LIMBS]]| -> Result<f64> {
        let samples = decouple(
            &recording,
            voltage,
            parameters,
            Scheme::AdamsMoulton4,
            Gravity::Kept,
        )?;
        Ok(worst(&largest_error(&six_series(&samples), &truth(run))))
    };
    let mut undone = recording.voltage_v.clone();
    for channel in 0..LIMBS {
        let drift = parameters.zero_drift_v[channel];
        let shown: Vec<f64> = undone.iter().map(|row| row[channel] - drift).collect();
        let input = undo_high_pass(&shown, AMPLIFIER_CORNER_HZ, recording.sample_rate_hz)?;
        for (row, u) in undone.iter_mut().zip(input) {
            row[channel] = u + drift;
        }
    }
    Ok((error(&recording.voltage_v)?, error(&undone)?))
}

/// Error of step 3 with a gyroscope that lags and is perfect otherwise.
fn lag(
    campaign: &[(PlannedTrial, SimulatedRun)],
    parameters: &Parameters,
    undo_lag: bool,
) -> Result<f64> {
    let lagging = Laboratory {
        instruments: Instruments {
            signal_to_noise_db: None,
            accelerometer_gain_error: 0.0,
            gyroscope_gain_error: 0.0,
            ..Instruments::of_class(&mut Pcg64::new(0, 0))
        },
        ..Laboratory::noise_free(truth::sensor(parameters))
    };
    let angular: Vec<(PlannedTrial, SimulatedRun)> = campaign
        .iter()
        .filter(|(trial, _)| trial.role == Role::Angular)
        .cloned()
        .collect();
    let session = session::record(
        &lagging,
        &angular,
        if undo_lag {
            Preset::LagUndone
        } else {
            Preset::None
        },
    )?;
    let found = session
        .campaign
        .angular(parameters, |_| true)?
        .solve()?
        .inertia_per_mass
        .to_paper_order();
    let truth = parameters.inertia_per_mass.to_paper_order();
    let largest = truth.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    Ok((0..6).fold(0.0_f64, |a, i| a.max((found[i] - truth[i]).abs())) / largest)
}

fn worst(errors: &[f64; 6]) -> f64 {
    errors.iter().fold(0.0, |a, b| a.max(*b))
}

//! Detrending of a run that begins and ends at rest in the same place.
//!
//! The decoupler is open loop: whatever drift or noise the torque channels hold is integrated once into the rate and
//! twice into the attitude. A run of the calibration rig ends as it began, at rest and where it started. That fixes
//! six numbers, as many as a straight line in each of the three torque components has. Under white noise in the
//! torque the least change that makes a doubly integrated quantity end right is linear in time, so this line is the
//! maximum-likelihood correction, not a convenience. Expressed in channels it is the trend that the paper's
//! preprocessing removes.

use alloc::vec::Vec;

use glam::DVec3;
use nalgebra::{Matrix6, SMatrix, SVector, Vector6};

use crate::columns::{halves, stacked};
use crate::decouple::stream::Decoupler;
use crate::error::{Error, Result, require_samples};
use crate::geometry::LIMBS;
use crate::identify::static_load_sharing::StaticLoadSharing;
use crate::model::Parameters;
use crate::model::{Sensor, Settings};
use crate::paper::signal::SignalChain;

/// Newton steps; the map is close to linear and each gains about three digits.
const ITERATIONS: usize = 3;
/// Angular acceleration by which the derivative of the end state is probed, rad/s^2: moves the end of a run of 1 s by
/// 1e-2 rad, far above rounding and far below where the map bends.
const PROBE_RAD_S2: f64 = 1e-2;

/// How far the run was from closing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trend {
    /// Rate at the end before the correction, shell axes, rad/s.
    pub end_rate_before_rad_s: DVec3,
    /// Rotation at the end against the start before the correction, rad.
    pub end_rotation_before_rad: DVec3,
}

/// The voltages less the straight line, in the torque-carrying combination of channels, that makes the run end at
/// rest where it began.
///
/// # Errors
/// [`Error::TooFewSamples`] below five samples; the errors of [`Decoupler::new`] and [`Decoupler::push`];
/// [`Error::NotConverged`] if the end state does not respond to the torque.
pub fn detrend(
    sensor: &Sensor,
    parameters: &Parameters,
    settings: &Settings,
    voltage_v: &[[f64; LIMBS]],
) -> Result<(Vec<[f64; LIMBS]>, Trend)> {
    const NEEDED: usize = 5;
    require_samples("rest-to-rest detrending", NEEDED, voltage_v.len())?;
    let not_converged = Error::NotConverged {
        what: "rest-to-rest detrending",
        iterations: ITERATIONS,
    };
    let start = Decoupler::new(sensor, parameters, settings)?;
    let pattern = torque_pattern(sensor, parameters).ok_or(not_converged.clone())?;
    let end_state = |line: &Vector6<f64>| -> Result<Vector6<f64>> {
        let mut decoupler = start.clone();
        let mut last = None;
        for (sample, row) in voltage_v.iter().enumerate() {
            let corrected = corrected(row, &pattern, line, sample, voltage_v.len());
            if let Some(output) = decoupler.push(&corrected)? {
                last = Some(output);
            }
        }
        let last = last.ok_or(Error::TooFewSamples {
            what: "rest-to-rest detrending",
            needed: NEEDED,
            got: voltage_v.len(),
        })?;
        let turned = (settings.initial_attitude.inverse() * last.attitude).to_scaled_axis();
        Ok(stacked(last.rate_shell_rad_s, turned))
    };

    let mut line = Vector6::zeros();
    let before = end_state(&line)?;
    let mut end = before;
    for _ in 0..ITERATIONS {
        let mut derivative = Matrix6::zeros();
        for column in 0..6 {
            let mut probe = line;
            probe[column] += PROBE_RAD_S2;
            derivative.set_column(column, &((end_state(&probe)? - end) / PROBE_RAD_S2));
        }
        let step = derivative.lu().solve(&end).ok_or(not_converged.clone())?;
        line -= step;
        end = end_state(&line)?;
    }
    let rows = voltage_v
        .iter()
        .enumerate()
        .map(|(sample, row)| corrected(row, &pattern, &line, sample, voltage_v.len()))
        .collect();
    let [end_rate_before_rad_s, end_rotation_before_rad] = halves(&before);
    Ok((
        rows,
        Trend {
            end_rate_before_rad_s,
            end_rotation_before_rad,
        },
    ))
}

/// One row of voltages with the line added: `line` holds the angular acceleration at the first and the last sample.
fn corrected(
    row: &[f64; LIMBS],
    pattern: &SMatrix<f64, LIMBS, 3>,
    line: &Vector6<f64>,
    sample: usize,
    samples: usize,
) -> [f64; LIMBS] {
    let x = sample as f64 / (samples - 1) as f64;
    let change = pattern * (line.fixed_rows::<3>(0) * (1.0 - x) + line.fixed_rows::<3>(3) * x);
    core::array::from_fn(|i| row[i] + change[i])
}

/// Voltages whose forces are the smallest that give the shell a unit angular acceleration about each axis and no
/// linear one.
fn torque_pattern(sensor: &Sensor, parameters: &Parameters) -> Option<SMatrix<f64, LIMBS, 3>> {
    let sharing = StaticLoadSharing::new(&sensor.geometry).ok()?;
    let tensor = parameters.inertia_per_mass.matrix_mass_m2();
    let chain = SignalChain::new(&sensor.gains, parameters);
    let mut pattern = SMatrix::<f64, LIMBS, 3>::zeros();
    for axis in 0..3 {
        let force = sharing.of_wrench(DVec3::ZERO, tensor.col(axis));
        let voltage = chain.voltage_change_v(&force);
        pattern.set_column(axis, &SVector::from(voltage));
    }
    Some(pattern)
}

//! Frequencies of MuJoCo's own ring-downs, mode by mode, to set beside the eigenvalue solution.

use core::f64::consts::TAU;

use glam::DVec3;

use super::model::SensorModel;
use super::simulation::{Simulation, SimulationError};
use crate::linear_theory::NaturalMode;
use crate::rig::run::{Mode as RigMode, Run};

/// Step of a ring-down, s: Runge-Kutta's phase error (w h)^4/120 is 0.4 ppm for the stiffest mode of the design.
pub const STEP_S: f64 = 2e-6;
/// Simulated periods of the mode.
const PERIODS: f64 = 12.0;
/// Displacement at the start, as the largest node displacement, m: small enough that the geometric nonlinearity,
/// of relative order amplitude over limb length squared, is below 2e-11.
const AMPLITUDE_M: f64 = 1e-7;

/// One mode, predicted and measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingDown {
    /// Eigenvalue solution, Hz.
    pub predicted_hz: f64,
    /// From the simulated motion, Hz.
    pub measured_hz: f64,
}

/// Displaces the mass along each mode shape of linear theory in turn, lets go, and measures the frequency of its
/// modal coordinate. Damping and gravity are off; the shell is held.
///
/// # Errors
/// Those of [`Simulation`].
pub fn measure(model: &SensorModel) -> Result<[RingDown; 6], SimulationError> {
    let model = SensorModel {
        damping_ratio: 0.0,
        gravity_ground_m_s2: DVec3::ZERO,
        ..*model
    };
    let mut results = [RingDown {
        predicted_hz: 0.0,
        measured_hz: 0.0,
    }; 6];
    for (result, mode) in results.iter_mut().zip(model.modes()) {
        *result = RingDown {
            predicted_hz: mode.frequency_hz,
            measured_hz: ring(&model, &mode)?,
        };
    }
    Ok(results)
}

fn ring(model: &SensorModel, mode: &NaturalMode) -> Result<f64, SimulationError> {
    let held = Run::new(RigMode::Rest, 1.0, DVec3::Z);
    let mut simulation = Simulation::new(model, STEP_S)?;
    let moved = DVec3::new(mode.shape[0], mode.shape[1], mode.shape[2]);
    let turned = DVec3::new(mode.shape[3], mode.shape[4], mode.shape[5]);
    let size = moved.length() + turned.length() * model.geometry.half_edge_m;
    let scale = AMPLITUDE_M / size;
    simulation.displace_mass(moved * scale, turned * scale);

    // The mode shape is M-orthonormal, so the modal coordinate is shape . M x; one component of it will do because
    // no other mode is excited. The strongest one is the cleanest.
    let linear = moved.length() >= turned.length() * model.geometry.half_edge_m;
    let axis = if linear { moved } else { turned };
    let steps = (PERIODS / mode.frequency_hz / STEP_S) as usize;
    // q(t+d) + q(t-d) = 2 cos(w d) q(t): least squares over the whole record; d near a quarter of a period makes
    // the arccosine well conditioned.
    let lag = (0.25 / mode.frequency_hz / STEP_S).round() as usize;
    let mut q = Vec::with_capacity(steps);
    for step in 0..steps {
        simulation.set_time_s(step as f64 * STEP_S);
        let (r, phi) = simulation.step(&held)?.relative_pose();
        q.push(if linear { r } else { phi }.dot(axis));
    }
    let (mut top, mut bottom) = (0.0, 0.0);
    for i in lag..q.len() - lag {
        top += q[i] * (q[i + lag] + q[i - lag]);
        bottom += 2.0 * q[i] * q[i];
    }
    Ok((top / bottom).clamp(-1.0, 1.0).acos() / (TAU * lag as f64 * STEP_S))
}

//! Fig. 7: how the motion of the mass in the shell grows with frequency, and where it crosses the thresholds.

use core::f64::consts::TAU;

use glam::DVec3;
use nalgebra::{SMatrix, SVector};
use serde::Serialize;

use super::model::SensorModel;
use super::simulation::{Simulation, SimulationError};
use crate::rig::run::{Mode, Run};

/// One frequency of the sweep.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SweepPoint {
    /// Drive frequency, Hz.
    pub frequency_hz: f64,
    /// Amplitude of the relative acceleration at that frequency: m/s^2 or rad/s^2.
    pub relative_acceleration: f64,
    /// Root mean square of what the fitted harmonics leave of the displacement, times w^2: the reference's noise.
    pub residual: f64,
}

/// Simulates one run and reads the relative acceleration from its steady part.
///
/// The relative displacement of the two bodies is fitted by a constant and three harmonics of the drive; the
/// fundamental times w^2 is the relative acceleration's amplitude. Displacement is what the simulator integrates, so
/// its noise, 1e-17 m, is far below a differenced acceleration's.
///
/// # Errors
/// Those of [`Simulation`].
pub fn measure(model: &SensorModel, run: &Run, step_s: f64) -> Result<SweepPoint, SimulationError> {
    let mut simulation = Simulation::new(model, step_s)?;
    let (from, to) = run.steady_span_s();
    let steps = (to / step_s).ceil() as usize;
    let stride = (((to - from) / step_s) / 512.0).ceil() as usize;
    let omega = TAU * run.frequency_hz;
    let mut normal = SMatrix::<f64, 7, 7>::zeros();
    let mut right = SMatrix::<f64, 7, 3>::zeros();
    let mut squares = 0.0;
    let mut count = 0usize;
    for step in 0..steps {
        let time_s = step as f64 * step_s;
        simulation.set_time_s(time_s);
        let now = simulation.step(run)?;
        if time_s < from || step % stride != 0 {
            continue;
        }
        let (r, phi) = now.relative_pose();
        let moved = if run.mode == Mode::Angular { phi } else { r };
        let phase = omega * (time_s - from);
        let row = SVector::<f64, 7>::from([
            1.0,
            phase.cos(),
            phase.sin(),
            (2.0 * phase).cos(),
            (2.0 * phase).sin(),
            (3.0 * phase).cos(),
            (3.0 * phase).sin(),
        ]);
        normal += row * row.transpose();
        for axis in 0..3 {
            right.column_mut(axis).axpy(moved[axis], &row, 1.0);
        }
        squares += moved.length_squared();
        count += 1;
    }
    let fit = normal
        .cholesky()
        .map_or_else(SMatrix::zeros, |cholesky| cholesky.solve(&right));
    let explained: f64 = (0..3)
        .map(|axis| fit.column(axis).dot(&right.column(axis)))
        .sum();
    let amplitude = (fit.row(1).norm_squared() + fit.row(2).norm_squared()).sqrt();
    Ok(SweepPoint {
        frequency_hz: run.frequency_hz,
        relative_acceleration: amplitude * omega * omega,
        residual: ((squares - explained).max(0.0) / count.max(1) as f64).sqrt() * omega * omega,
    })
}

/// The two excitations of Fig. 7: the slider's whole stroke as amplitude along (1,1,2), and the rig's full rotation
/// about z.
pub fn excitation(mode: Mode, frequency_hz: f64) -> Run {
    let mut run = match mode {
        Mode::Angular => Run::new(mode, frequency_hz, DVec3::Z),
        _ => Run::new(mode, frequency_hz, DVec3::new(1.0, 1.0, 2.0)),
    };
    // "The amplitude is set to the slider's stroke": twice what the slider really does.
    run.slider_amplitude_m *= 2.0;
    run.rest_s = 0.0;
    run.ramp_periods = 0.6;
    run.steady_periods = 1.0;
    run
}

/// Frequency at which a sweep crosses `threshold`, by interpolation on log axes. None if it never does.
pub fn crossing_hz(sweep: &[SweepPoint], threshold: f64) -> Option<f64> {
    sweep.windows(2).find_map(|pair| {
        let [a, b] = [pair[0], pair[1]];
        (a.relative_acceleration < threshold && b.relative_acceleration >= threshold).then(|| {
            let share = (threshold / a.relative_acceleration).ln()
                / (b.relative_acceleration / a.relative_acceleration).ln();
            a.frequency_hz * (b.frequency_hz / a.frequency_hz).powf(share)
        })
    })
}

/// Least-squares slope of log y over log x: the exponent of a power law.
pub fn log_slope(points: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let points: Vec<(f64, f64)> = points.into_iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = points.len() as f64;
    let (mx, my) = points
        .iter()
        .fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (sxy, sxx) = points.iter().fold((0.0, 0.0), |(sxy, sxx), p| {
        (sxy + (p.0 - mx) * (p.1 - my), sxx + (p.0 - mx) * (p.0 - mx))
    });
    sxy / sxx
}

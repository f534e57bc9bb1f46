//! Accelerations of a run as six series, decoupled, true and as the standard instruments have them, and their errors.

use anyhow::Result;
use glam::DVec3;
use sixaxis_calibration::conditioning::Conditioned;
use sixaxis_core::{LIMBS, Parameters, Scheme, SixAxis};
use sixaxis_props::truth::InCore;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::motion::{SimulatedRun, TrueMotion};

use super::results::Gravity;

/// A run as six series: linear (ground axes), then angular (ground axes).
pub type SixSeries = [Vec<f64>; 6];

fn split(linear: impl Iterator<Item = (DVec3, DVec3)>) -> SixSeries {
    let mut series = SixSeries::default();
    for (a, w) in linear {
        for axis in 0..3 {
            series[axis].push(a[axis]);
            series[3 + axis].push(w[axis]);
        }
    }
    series
}

/// The true six accelerations of samples 1 to n - 2, which are those that the decoupler yields.
pub fn truth(run: &SimulatedRun) -> SixSeries {
    truth_of(&run.truth)
}

/// The same of a recording's true motion.
pub fn truth_of(motion: &[TrueMotion]) -> SixSeries {
    let decoupled = motion.iter().skip(1).take(motion.len().saturating_sub(2));
    split(decoupled.map(|t| (t.linear_ground_m_s2, t.angular_ground_rad_s2)))
}

/// What the standard instruments say of the same samples.
pub fn standards(conditioned: &Conditioned) -> SixSeries {
    let n = conditioned.linear_ground_m_s2.len();
    split((1..n - 1).map(|i| {
        (
            conditioned.linear_ground_m_s2[i],
            conditioned.angular_shell_rad_s2[i],
        )
    }))
}

/// Decouples a record sample by sample.
///
/// # Errors
/// Those of the decoupler.
pub fn decouple(
    recording: &SimulatedRecording,
    voltage_v: &[[f64; LIMBS]],
    parameters: &Parameters,
    scheme: Scheme,
    gravity: Gravity,
) -> Result<Vec<SixAxis>> {
    let mut settings = recording.settings(scheme);
    if gravity == Gravity::Neglected {
        settings.gravity_ground_m_s2 = DVec3::ZERO;
    }
    let sensor = recording.sensor();
    Ok(sixaxis_core::decouple::decouple(
        &sensor, parameters, &settings, voltage_v,
    )?)
}

/// The six series of a decoupled record.
pub fn six_series(samples: &[SixAxis]) -> SixSeries {
    split(
        samples
            .iter()
            .map(|s| (s.linear_ground_m_s2, s.angular_ground_rad_s2)),
    )
}

/// The first less the second, sample by sample.
pub fn difference(a: &SixSeries, b: &SixSeries) -> SixSeries {
    core::array::from_fn(|i| a[i].iter().zip(&b[i]).map(|(x, y)| x - y).collect())
}

/// Largest magnitude of each series.
pub fn peaks(series: &SixSeries) -> [f64; 6] {
    core::array::from_fn(|i| series[i].iter().fold(0.0, |a: f64, b| a.max(b.abs())))
}

/// Largest difference of two sets of series over the peaks of the second.
pub fn largest_error(ours: &SixSeries, standard: &SixSeries) -> [f64; 6] {
    let peak = peaks(standard);
    core::array::from_fn(|i| {
        ours[i]
            .iter()
            .zip(&standard[i])
            .fold(0.0, |a: f64, (x, y)| {
                let d = (x - y).abs();
                // NaN must not pass as small.
                if d.is_nan() { f64::INFINITY } else { a.max(d) }
            })
            / peak[i]
    })
}

/// Complex amplitude at the drive frequency over the whole turns at full speed.
pub fn harmonic(series: &[f64], run: &SimulatedRun) -> (f64, f64) {
    let (from, to) = run.motion.steady_span_s();
    let rate = run.sample_rate_hz;
    // Series begin at sample 1.
    let first = (from * rate).round() as usize - 1;
    let count = ((to - from) * rate).round() as usize;
    let omega = core::f64::consts::TAU * run.motion.frequency_hz / rate;
    let (mut c, mut s) = (0.0, 0.0);
    for (i, x) in series.iter().skip(first).take(count).enumerate() {
        let (sin, cos) = (omega * i as f64).sin_cos();
        c += x * cos;
        s += x * sin;
    }
    (2.0 * c / count as f64, 2.0 * s / count as f64)
}

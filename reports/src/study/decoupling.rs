//! Decoupling of the compound runs and comparison with truth and standard instruments: Tables 4 to 6.

use anyhow::Result;
use glam::DVec3;
use rayon::prelude::*;
use sixaxis_calibration::conditioning::Conditioned;
use sixaxis_core::decouple::rest_to_rest;
use sixaxis_core::decouple::stream::Decoupler;
use sixaxis_core::{LIMBS, Parameters, Scheme, SixAxis};
use sixaxis_props::truth;
use sixaxis_props::truth::InCore;
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::paper;
use sixaxis_reference::rig::run::Mounting;

use super::conditioning::Preset;
use super::results::{Comparison, Compound, Gravity, ParameterSet, Standard};

/// Number of the first compound run in the laboratory's count of runs: its random streams do not depend on how many
/// trials the steps had.
const FIRST_RUN: usize = 1000;

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
#[must_use]
pub fn truth(run: &SimulatedRun) -> SixSeries {
    let n = run.truth.len();
    split(
        run.truth[1..n - 1]
            .iter()
            .map(|t| (t.linear_ground_m_s2, t.angular_ground_rad_s2)),
    )
}

/// What the standard instruments say of the same samples.
fn standards(conditioned: &Conditioned) -> SixSeries {
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
    let mut decoupler = Decoupler::new(&recording.sensor(), parameters, &settings)?;
    let mut samples = Vec::with_capacity(voltage_v.len());
    for row in voltage_v {
        samples.extend(decoupler.push(row)?);
    }
    Ok(samples)
}

/// The six series of a decoupled record.
#[must_use]
pub fn six_series(samples: &[SixAxis]) -> SixSeries {
    split(
        samples
            .iter()
            .map(|s| (s.linear_ground_m_s2, s.angular_ground_rad_s2)),
    )
}

/// Largest magnitude of each series.
#[must_use]
pub fn peaks(series: &SixSeries) -> [f64; 6] {
    core::array::from_fn(|i| series[i].iter().fold(0.0, |a: f64, b| a.max(b.abs())))
}

/// Largest difference of two sets of series over the peaks of the second.
#[must_use]
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
fn harmonic(series: &[f64], run: &SimulatedRun) -> (f64, f64) {
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

fn harmonic_error(ours: &SixSeries, standard: &SixSeries, run: &SimulatedRun) -> [f64; 6] {
    core::array::from_fn(|i| {
        let (a, b) = (harmonic(&ours[i], run), harmonic(&standard[i], run));
        (a.0 - b.0).hypot(a.1 - b.1) / b.0.hypot(b.1)
    })
}

/// One way of decoupling a run.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    /// Which parameters.
    pub set: ParameterSet,
    /// Their values.
    pub parameters: Parameters,
    /// Which scheme.
    pub scheme: Scheme,
    /// Whether gravity is reckoned with.
    pub gravity: Gravity,
}

/// One compound run with everything that is decoupled from it.
pub struct Case<'a> {
    /// The run at the sample rate of the comparison.
    pub run: SimulatedRun,
    /// The same with the simulator's step halved.
    pub halved: SimulatedRun,
    /// Which run of the paper.
    pub index: usize,
    /// How it hangs.
    pub mounting: Mounting,
    /// The laboratory that records it.
    pub laboratory: &'a Laboratory,
    /// How it is conditioned.
    pub conditioning: Preset,
    /// Whether drift is closed from rest to rest.
    pub close: bool,
}

impl Case<'_> {
    /// Records and cleans the run.
    ///
    /// # Errors
    /// Those of the conditioning.
    pub fn record(&self, run: &SimulatedRun) -> Result<(SimulatedRecording, Conditioned)> {
        let recording = self.laboratory.record(run, FIRST_RUN + self.index);
        let (_, conditioned) = self.conditioning.condition(&recording, Role::Validation)?;
        Ok((recording, conditioned))
    }

    /// Voltages ready to be decoupled with the given parameters.
    ///
    /// # Errors
    /// Those of the detrending.
    pub fn voltages(
        &self,
        recording: &SimulatedRecording,
        conditioned: &Conditioned,
        parameters: &Parameters,
    ) -> Result<Vec<[f64; LIMBS]>> {
        if !self.close {
            return Ok(conditioned.voltage_v.clone());
        }
        let (rows, _) = rest_to_rest::detrend(
            &recording.sensor(),
            parameters,
            // Plain Heun finds the line as well as any: its error is a thousandth of the noise's.
            &recording.settings(Scheme::Heun),
            &conditioned.voltage_v,
        )?;
        Ok(rows)
    }

    /// Decouples with each parameter set and scheme and compares.
    ///
    /// # Errors
    /// Those of recording and decoupling.
    pub fn compare(&self, ways: &[Way]) -> Result<Compound> {
        let truth = truth(&self.run);
        let (recording, conditioned) = self.record(&self.run)?;
        let standards = standards(&conditioned);
        let comparisons = ways
            .par_iter()
            .map(|way| {
                // Drift that nobody took off is part of what the design columns are shown for.
                let closable = !matches!(way.set, ParameterSet::Design);
                let voltages = if closable {
                    self.voltages(&recording, &conditioned, &way.parameters)?
                } else {
                    conditioned.voltage_v.clone()
                };
                let samples = decouple(
                    &recording,
                    &voltages,
                    &way.parameters,
                    way.scheme,
                    way.gravity,
                )?;
                let ours = six_series(&samples);
                Ok([
                    (Standard::Truth, &truth),
                    (Standard::Instruments, &standards),
                ]
                .map(|(against, standard)| Comparison {
                    parameters: way.set,
                    scheme: way.scheme,
                    gravity: way.gravity,
                    against,
                    error: largest_error(&ours, standard),
                    harmonic_error: harmonic_error(&ours, standard, &self.run),
                }))
            })
            .collect::<Result<Vec<_>>>()?;
        let amplitude = core::array::from_fn(|i| {
            let (c, s) = harmonic(&truth[i], &self.run);
            c.hypot(s)
        });
        Ok(Compound {
            table: paper::COMPOUND_TABLES[self.index].number,
            frequency_hz: self.run.motion.frequency_hz,
            mounting: self.mounting,
            sample_rate_hz: self.run.sample_rate_hz,
            peak: peaks(&truth),
            amplitude,
            comparisons: comparisons.into_iter().flatten().collect(),
            reference_error: self.reference_error()?,
        })
    }

    /// How much the difference between decoupled and true accelerations changes when the simulator's step is halved:
    /// with perfect recordings, true parameters and a scheme whose own error is far smaller.
    fn reference_error(&self) -> Result<[f64; 6]> {
        let perfect = Laboratory::noise_free(self.laboratory.sensor);
        let difference = |run: &SimulatedRun| -> Result<(SixSeries, SixSeries)> {
            let recording = perfect.record(run, FIRST_RUN + self.index);
            let samples = decouple(
                &recording,
                &recording.voltage_v,
                &truth::parameters(&perfect.sensor),
                Scheme::AdamsMoulton4,
                Gravity::Kept,
            )?;
            let (ours, truth) = (six_series(&samples), truth(run));
            let difference = core::array::from_fn(|i| {
                ours[i].iter().zip(&truth[i]).map(|(x, y)| x - y).collect()
            });
            Ok((difference, truth))
        };
        let (full, truth) = difference(&self.run)?;
        let (halved, _) = difference(&self.halved)?;
        let peak = peaks(&truth);
        Ok(core::array::from_fn(|i| {
            full[i]
                .iter()
                .zip(&halved[i])
                .fold(0.0, |a: f64, (x, y)| a.max((x - y).abs()))
                / peak[i]
        }))
    }
}

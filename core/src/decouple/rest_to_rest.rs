//! Detrending of a run that begins and ends at rest in the same place.
//!
//! The decoupler is open loop: whatever drift or noise the torque channels hold is integrated once into the rate and
//! twice into the attitude. A run of the calibration rig ends as it began, at rest and where it started. That fixes
//! six numbers, as many as a straight line in each of the three torque components has. Under white noise in the
//! torque the least change that makes a doubly integrated quantity end right is linear in time, so this line is the
//! maximum-likelihood correction, not a convenience. Expressed in channels it is the trend that the paper's
//! preprocessing removes.
//!
//! Rests before and after the motion are closed by lines of their own, a second each: what the torque channels hold is integrated over
//! the motion alone, however long the recorder ran before and after it.

use alloc::vec::Vec;
use core::ops::Range;

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

/// Samples of a piece at least.
const NEEDED: usize = 5;
/// What is said where the end state does not respond to the torque.
const NOT_CONVERGED: Error = Error::NotConverged {
    what: "rest-to-rest detrending",
    iterations: ITERATIONS,
};
/// Length of a piece of rest, s.
const PIECE_S: f64 = 1.0;
/// Time of which a mean is looked at, s: a period of mains.
const BLOCK_S: f64 = 0.02;
/// Such means that say where a channel stands at an end.
const STAND: usize = 5;
/// Share of the largest range of a channel, V, from which another one moves much.
const MUCH: f64 = 0.3;
/// Share of its range by which such a channel is away from where it stood.
const AWAY: f64 = 0.01;
/// Time before and after that which is the motion's, s; at least this share of it.
const MARGIN_S: f64 = 0.5;
const MARGIN_OF_SPAN: usize = 10;
/// Newton steps; the map is close to linear and each gains about three digits. As many again where a run is still this far from closing,
/// rad/s and rad.
const ITERATIONS: usize = 3;
const CLOSED: f64 = 1e-4;
/// Rate at the end times the run's duration, rad, from which its rotation may be some turns more than its attitude shows.
const TURNS_RAD: f64 = 3.0;
/// Time at the beginning that is rest, s: what turns the shell there, turns it throughout.
const AT_REST_S: f64 = 0.1;
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
    /// Whether the correction brings it there: no line does where a run begins or ends in motion.
    pub closes: bool,
}

/// The voltages less the straight line, in the torque-carrying combination of channels, that makes the run end at
/// rest where it began; less such lines for each second of rest before and after the motion.
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
    require_samples("rest-to-rest detrending", NEEDED, voltage_v.len())?;
    let mut decoupler = Decoupler::new(sensor, parameters, settings)?;
    let pattern = torque_pattern(sensor, parameters).ok_or(NOT_CONVERGED)?;
    let moving = motion(voltage_v, settings.sample_rate_hz);
    let piece = (PIECE_S * settings.sample_rate_hz) as usize;
    let mut rows = Vec::with_capacity(voltage_v.len());
    let mut trend = None;
    for part in parts(&moving, voltage_v.len(), piece.max(NEEDED)) {
        let run = &voltage_v[part.clone()];
        let (line, before) = closing(&decoupler, settings, &pattern, run)?;
        if part.start <= moving.start && moving.start < part.end {
            trend = Some(before);
        }
        for (sample, row) in run.iter().enumerate() {
            let row = corrected(row, &pattern, &line, sample, run.len());
            decoupler.push(&row)?;
            rows.push(row);
        }
    }
    Ok((rows, trend.ok_or(NOT_CONVERGED)?))
}

/// Where each line begins and ends: rests in pieces, the motion in one.
fn parts(
    moving: &Range<usize>,
    samples: usize,
    piece: usize,
) -> impl Iterator<Item = Range<usize>> {
    let rest = move |from: usize, to: usize| {
        let count = (to - from) / piece;
        (0..count).map(move |i| {
            let end = if i + 1 == count {
                to
            } else {
                from + (i + 1) * piece
            };
            from + i * piece..end
        })
    };
    rest(0, moving.start)
        .chain(core::iter::once(moving.clone()))
        .chain(rest(moving.end, samples))
}

/// The line that ends this piece of a run, which begins with the decoupler as it is, at rest in the initial attitude; and where the piece
/// ends without it.
fn closing(
    start: &Decoupler,
    settings: &Settings,
    pattern: &SMatrix<f64, LIMBS, 3>,
    run: &[[f64; LIMBS]],
) -> Result<(Vector6<f64>, Trend)> {
    let end_state = |line: &Vector6<f64>| -> Result<Vector6<f64>> {
        let mut decoupler = start.clone();
        let mut last = None;
        for (sample, row) in run.iter().enumerate() {
            let corrected = corrected(row, pattern, line, sample, run.len());
            if let Some(output) = decoupler.push(&corrected)? {
                last = Some(output);
            }
        }
        let last = last.ok_or(Error::TooFewSamples {
            what: "rest-to-rest detrending",
            needed: NEEDED,
            got: run.len(),
        })?;
        let turned = (settings.initial_attitude.inverse() * last.attitude).to_scaled_axis();
        Ok(stacked(last.rate_shell_rad_s, turned))
    };
    let newton = |(mut line, mut end): (Vector6<f64>, Vector6<f64>), steps: usize| {
        for _ in 0..steps {
            let mut derivative = Matrix6::zeros();
            for column in 0..6 {
                let mut probe = line;
                probe[column] += PROBE_RAD_S2;
                derivative.set_column(column, &((end_state(&probe)? - end) / PROBE_RAD_S2));
            }
            line -= derivative.lu().solve(&end).ok_or(NOT_CONVERGED)?;
            end = end_state(&line)?;
        }
        Ok((line, end))
    };
    let closes = |(_, end): &(Vector6<f64>, Vector6<f64>)| end.norm() < CLOSED;
    let before = end_state(&Vector6::zeros())?;
    let duration_s = run.len() as f64 / settings.sample_rate_hz;
    let turned_far = before.fixed_rows::<3>(0).norm() * duration_s > TURNS_RAD;
    // Newton's steps from there may close the run with a turn too many. Its own zeros bring it near.
    let by_zeros = || -> Result<_> {
        let still = turning_at_rest(start, settings, run)?;
        let line = stacked(-still, -still);
        newton((line, end_state(&line)?), 2 * ITERATIONS)
    };
    let near = turned_far
        .then(by_zeros)
        .and_then(Result::ok)
        .filter(closes);
    let found = match near {
        Some(near) => near,
        None => {
            let found = newton((Vector6::zeros(), before), ITERATIONS)?;
            // A run that no line closes is left as it is, and said to be.
            let more = || newton(found, ITERATIONS).ok().filter(closes);
            if closes(&found) {
                found
            } else {
                more().unwrap_or(found)
            }
        }
    };
    let [end_rate_before_rad_s, end_rotation_before_rad] = halves(&before);
    Ok((
        found.0,
        Trend {
            end_rate_before_rad_s,
            end_rotation_before_rad,
            closes: closes(&found),
        },
    ))
}

/// Mean angular acceleration that the channels show at the beginning of a run, shell axes, rad/s^2.
fn turning_at_rest(start: &Decoupler, settings: &Settings, run: &[[f64; LIMBS]]) -> Result<DVec3> {
    // A piece may be shorter than what is needed of a run.
    let samples = ((AT_REST_S * settings.sample_rate_hz) as usize).max(NEEDED);
    let mut decoupler = start.clone();
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for row in run.iter().take(samples) {
        if let Some(shown) = decoupler.push(row)? {
            sum += shown.attitude.inverse() * shown.angular_ground_rad_s2;
            count += 1.0;
        }
    }
    Ok(sum / count)
}

/// The samples of a run that are its motion: those between the first and the last at which a channel that moves much is away from where it stands
/// at that end, with half a second and more on either side. All samples where the run does not stand at an end, and of an end that would be
/// left a second of rest or less.
#[must_use]
pub fn motion(voltage_v: &[[f64; LIMBS]], sample_rate_hz: f64) -> Range<usize> {
    let samples = voltage_v.len();
    let block = ((BLOCK_S * sample_rate_hz) as usize).max(1);
    let means: Vec<[f64; LIMBS]> = voltage_v
        .chunks_exact(block)
        .map(|rows| {
            core::array::from_fn(|limb| {
                rows.iter().map(|row| row[limb]).sum::<f64>() / block as f64
            })
        })
        .collect();
    if means.len() < 2 * STAND {
        return 0..samples;
    }
    let range_v: [f64; LIMBS] = core::array::from_fn(|limb| {
        let (low, high) = means
            .iter()
            .map(|row| row[limb])
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (f64::min(low, v), f64::max(high, v))
            });
        high - low
    });
    let largest = range_v.iter().copied().fold(0.0, f64::max);
    let level = |blocks: &[[f64; LIMBS]]| -> [f64; LIMBS] {
        core::array::from_fn(|limb| {
            blocks.iter().map(|row| row[limb]).sum::<f64>() / blocks.len() as f64
        })
    };
    let away = |row: &[f64; LIMBS], level: &[f64; LIMBS]| {
        (0..LIMBS).any(|limb| {
            range_v[limb] > MUCH * largest && (row[limb] - level[limb]).abs() > AWAY * range_v[limb]
        })
    };
    let (first, last) = (level(&means[..STAND]), level(&means[means.len() - STAND..]));
    let begins = means.iter().position(|row| away(row, &first));
    let ends = means.iter().rposition(|row| away(row, &last));
    let (Some(begins), Some(ends)) = (begins, ends) else {
        return 0..samples;
    };
    let (begins, ends) = (begins * block, (ends + 1) * block);
    let span = ends.saturating_sub(begins);
    let margin = ((MARGIN_S * sample_rate_hz) as usize).max(span / MARGIN_OF_SPAN);
    let (begins, ends) = (begins.saturating_sub(margin), (ends + margin).min(samples));
    let piece = ((PIECE_S * sample_rate_hz) as usize).max(NEEDED);
    let begins = if begins < piece { 0 } else { begins };
    let ends = if samples - ends < piece {
        samples
    } else {
        ends
    };
    // A channel that creeps may be near where it stands at both ends.
    if begins < ends {
        begins..ends
    } else {
        0..samples
    }
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

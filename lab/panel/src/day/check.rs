//! Whether a trial is the one that was asked for, from its samples alone and before anything is calibrated.
//!
//! Directions are read with the design's scale factors and inertias, which a sensor misses by a third: they tell a wrong wedge, not
//! a wedge that is off by a degree. The calibration tells that.

use glam::DVec3;
use serde::Serialize;
use sixaxis_core::LIMBS;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_recordings::session::{Entry, Role, Session};

use crate::columns::Batch;

/// Directions further apart than this are of two wedges, degrees.
const WRONG_WEDGE_DEG: f64 = 25.0;
/// Frequencies and amplitudes may be off by so much.
const FREQUENCY: f64 = 0.02;
const AMPLITUDE: f64 = 0.05;
/// Time at either end that must be rest, s, and how still, over the peak.
const REST_S: f64 = 0.04;
const STILL: f64 = 0.03;
/// Shortest static record, s.
const STATIC_S: f64 = 5.0;

/// One line of a check.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// What.
    pub what: &'static str,
    /// What was found, with its unit.
    pub found: String,
    /// What was asked for.
    pub asked: String,
    /// Whether that is the same.
    pub ok: bool,
}

/// A trial's check.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Check {
    /// Line by line.
    pub lines: Vec<Line>,
}

impl Check {
    fn say(&mut self, what: &'static str, found: String, asked: String, ok: bool) {
        self.lines.push(Line {
            what,
            found,
            asked,
            ok,
        });
    }
}

/// Checks a trial.
pub fn check(
    card: &Session,
    entry: &Entry,
    gain_n_per_v: &[f64; LIMBS],
    samples: &Batch,
    rate_hz: f64,
) -> Check {
    let mut check = Check::default();
    let largest = samples
        .voltage_v
        .columns
        .iter()
        .flatten()
        .fold(0.0, |a: f64, u| a.max(u.abs()));
    let full = card.sensor.full_scale_v;
    let range = format!("{:.0} % of the range", 100.0 * largest / full);
    check.say("range", range, "below 100 %".to_owned(), largest < full);
    let seconds = samples.samples() as f64 / rate_hz;
    if entry.role == Role::Static {
        let asked = format!("at least {STATIC_S} s");
        check.say(
            "length",
            format!("{seconds:.1} s"),
            asked,
            seconds >= STATIC_S,
        );
        return check;
    }
    let (angular, readings) = match entry.role {
        Role::Angular => (true, &samples.standard[1]),
        _ => (false, &samples.standard[0]),
    };
    let frequency_hz = entry.frequency_hz.unwrap_or(0.0);
    let Some(motion) = Motion::of(readings, rate_hz) else {
        check.say(
            "standard",
            "shows no motion".to_owned(),
            "a motion".to_owned(),
            false,
        );
        return check;
    };
    let off = (motion.frequency_hz / frequency_hz - 1.0).abs();
    check.say(
        "frequency",
        format!("{:.3} Hz", motion.frequency_hz),
        format!("{frequency_hz:.3} Hz"),
        off < FREQUENCY,
    );
    amplitude(&mut check, card, angular, &motion, frequency_hz);
    check.say(
        "rest at both ends",
        format!(
            "{:.1} % and {:.1} % of the peak",
            100.0 * motion.ends[0],
            100.0 * motion.ends[1]
        ),
        format!("below {:.0} %", 100.0 * STILL),
        motion.ends.iter().all(|end| *end < STILL),
    );
    if let (Some(direction), Role::Linear | Role::HighFrequencyLinear | Role::Angular) =
        (entry.direction, entry.role)
    {
        let stated = DVec3::from_array(direction).normalize_or_zero();
        let seen = seen_direction(card, gain_n_per_v, samples, angular, rate_hz);
        let apart = seen.dot(stated).clamp(-1.0, 1.0).acos().to_degrees();
        check.say(
            "direction",
            format!("{apart:.0}° from the wedge's"),
            format!("within {WRONG_WEDGE_DEG:.0}°"),
            apart < WRONG_WEDGE_DEG,
        );
    }
    check
}

fn amplitude(check: &mut Check, card: &Session, angular: bool, motion: &Motion, frequency_hz: f64) {
    let Some(rig) = &card.rig else {
        return;
    };
    let omega = core::f64::consts::TAU * frequency_hz;
    let (stated, found, unit) = if angular {
        // The gyroscope shows less by its first-order bandwidth.
        let lag = card
            .gyroscope
            .bandwidth_hz
            .map_or(1.0, |hz| (1.0 + (frequency_hz / hz).powi(2)).sqrt());
        let found = (motion.peak * lag / omega).to_degrees();
        (rig.rotation_amplitude_deg, found, "°")
    } else {
        (
            rig.stroke_mm.map(|stroke| 0.5 * stroke),
            1e3 * motion.peak / (omega * omega),
            " mm",
        )
    };
    if let Some(stated) = stated {
        check.say(
            "amplitude",
            format!("{found:.1}{unit}"),
            format!("{stated:.1}{unit}"),
            (found / stated - 1.0).abs() < AMPLITUDE,
        );
    }
}

/// What a reference instrument shows of a run.
struct Motion {
    frequency_hz: f64,
    /// Amplitude at full speed, in the instrument's unit.
    peak: f64,
    /// Root mean square at the first and the last samples over the peak.
    ends: [f64; 2],
}

impl Motion {
    fn of(readings: &[f64], rate_hz: f64) -> Option<Self> {
        let peak = readings.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
        let end = (REST_S * rate_hz) as usize;
        if peak <= 0.0 || peak.is_nan() || readings.len() < 8 * end.max(1) {
            return None;
        }
        let rms = |part: &[f64]| {
            (part.iter().map(|x| x * x).sum::<f64>() / part.len().max(1) as f64).sqrt()
        };
        let ends = [
            rms(&readings[..end]),
            rms(&readings[readings.len() - end..]),
        ];
        // At full speed the sign changes twice a turn. Only swings that reach most of the peak are counted, so that running
        // up and down are left out, and noise about zero is none.
        let mut swings: Vec<(usize, f64)> = Vec::new();
        for (k, x) in readings.iter().enumerate() {
            if x.abs() < 0.5 * peak {
                continue;
            }
            match swings.last_mut().filter(|(_, largest)| *largest * x > 0.0) {
                Some(swing) => {
                    if x.abs() > swing.1.abs() {
                        *swing = (k, *x);
                    }
                }
                None => swings.push((k, *x)),
            }
        }
        let full: Vec<&(usize, f64)> = swings
            .iter()
            .filter(|(_, x)| x.abs() > 0.9 * peak)
            .collect();
        let inner = crossings(readings, full.first()?.0, full.last()?.0, 0.2 * peak);
        let (first, last) = (inner.first()?, inner.last()?);
        let turns = 0.5 * (inner.len().saturating_sub(1)) as f64;
        if turns < 0.5 {
            return None;
        }
        let of_full = full.iter().map(|(_, x)| x.abs()).sum::<f64>() / full.len() as f64;
        Some(Self {
            frequency_hz: turns * rate_hz / (last - first),
            peak: of_full,
            ends: ends.map(|end| end / peak),
        })
    }
}

/// Where the sign changes between two samples, with hysteresis, by linear interpolation of what lies within it.
fn crossings(readings: &[f64], from: usize, to: usize, hysteresis: f64) -> Vec<f64> {
    let mut found = Vec::new();
    let mut side = 0.0_f64;
    let mut left = from;
    for (k, x) in readings.iter().enumerate().take(to + 1).skip(from) {
        if x.abs() < hysteresis {
            continue;
        }
        if side * x < 0.0 {
            // A line through the samples about zero averages their noise.
            let share = readings[left].abs() / (readings[left].abs() + x.abs());
            found.push(left as f64 + share * (k - left) as f64);
        }
        side = x.signum();
        left = k;
    }
    found
}

/// Direction of the acceleration, or of the angular acceleration, that goes with the standard's.
fn seen_direction(
    card: &Session,
    gain_n_per_v: &[f64; LIMBS],
    samples: &Batch,
    angular: bool,
    rate_hz: f64,
) -> DVec3 {
    let design = card.sensor.design();
    let arms = card.sensor.geometry().arms_m();
    let count = samples.samples();
    let rest = ((REST_S * rate_hz) as usize).clamp(1, count.max(1));
    let columns = &samples.voltage_v.columns;
    let mut sum = DVec3::ZERO;
    let step = (count / 4000).max(1);
    for (limb, column) in columns.iter().enumerate() {
        let zero = column.iter().take(rest).sum::<f64>() / rest as f64;
        let force_per_v = design.scale_per_mass_per_kg[limb] * gain_n_per_v[limb];
        let axis = if angular {
            arms[limb]
        } else {
            DIRECTIONS_SHELL[limb]
        };
        let mut projected = 0.0;
        for k in (step..count.saturating_sub(step)).step_by(step) {
            let known = if angular {
                samples.standard[1][k + step] - samples.standard[1][k - step]
            } else {
                samples.standard[0][k]
            };
            projected += (column[k] - zero) * known;
        }
        sum += axis * (force_per_v * projected);
    }
    if angular {
        sum = design.inertia_per_mass.matrix_mass_m2().inverse() * sum;
    }
    sum.normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(frequency_hz: f64, rate_hz: f64) -> Vec<f64> {
        let samples = (6.0 / frequency_hz * rate_hz) as usize;
        let rest = (0.1 * rate_hz) as usize;
        let mut readings = vec![0.0; rest];
        readings.extend((0..samples).map(|k| {
            let turns = k as f64 / rate_hz * frequency_hz;
            let envelope = turns.min(6.0 - turns).clamp(0.0, 1.0);
            envelope * (core::f64::consts::TAU * turns).sin()
                + 1e-3 * ((k * 7919) % 13) as f64 / 13.0
        }));
        readings.extend(vec![0.0; rest]);
        readings
    }

    #[test]
    fn law_frequency_and_amplitude_are_found() {
        for frequency_hz in [1.0, 1.7, 5.0] {
            let motion = Motion::of(&run(frequency_hz, 2000.0), 2000.0).expect("a motion");
            assert!(
                (motion.frequency_hz / frequency_hz - 1.0).abs() < FREQUENCY / 4.0,
                "{}",
                motion.frequency_hz
            );
            assert!(
                (motion.peak - 1.0).abs() < AMPLITUDE / 4.0,
                "{}",
                motion.peak
            );
            assert!(motion.ends.iter().all(|end| *end < STILL));
        }
        assert!(Motion::of(&[0.0; 1000], 1000.0).is_none());
    }

    #[test]
    fn law_a_run_that_was_cut_does_not_rest() {
        let readings = run(1.0, 2000.0);
        let motion = Motion::of(&readings[..readings.len() - 1300], 2000.0).expect("a motion");
        assert!(motion.ends[1] > STILL);
    }
}

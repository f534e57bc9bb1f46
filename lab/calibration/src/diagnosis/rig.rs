//! The standards against the rig: what a crank of known radius, turning at the frequency that is seen, makes them read.
//!
//! Nothing else checks a certificate. The accelerometer alone sets the scale of all that is identified; if it reads too much by a
//! share, every s_i/m and I/m is off by it, and no trial shows that. Written sample rates are checked along: a clock that is fast
//! by a share m makes the accelerometer read too little by 2 m and the gyroscope by m, and the drive turn faster by it.

use super::fundamental;
use super::level::{cause_of, factor_in_words, reason, reason_of_a_rate};
use super::trial_case::{Facts, Standard, TrialCase, mark_explained, names};
use super::{Found, Word};
use crate::finding::{Cause, Finding};
use crate::series::median;
use crate::trial::same_wedge;
use sixaxis_recordings::session::Role;
use sixaxis_recordings::unit::STANDARD_GRAVITY_M_S2;

/// Relative tolerance of stroke and rotation amplitude: a workshop's.
pub const TOLERANCE: f64 = 3e-3;
/// Share of the trials from which what they show is said of a standard.
const MOST: f64 = 0.5;
/// Units of an accelerometer that are mistaken for each other: m/s^2 for g, metres for centimetres or millimetres. Any other factor in a few
/// trials may be another crank's.
const ACCELERATIONS: [f64; 3] = [STANDARD_GRAVITY_M_S2, 100.0, 1000.0];
/// The same of a gyroscope: radians for degrees, volts for millivolts.
const RATES: [f64; 2] = [57.29578, 1000.0];
/// A factor that no two cranks of a rig are apart.
const ANY_CRANK: f64 = 5.0;
/// Trials of a kind.
const FEWEST: usize = 3;
/// How near to one of them a factor is.
const A_UNIT: f64 = 0.03;
/// Part of an error by which two errors may differ that have one cause.
const ALIKE: f64 = 0.3;
/// Times what certificate and workshop allow by which a reading must be off at one of two frequencies to tell them apart.
const TOLD_APART: f64 = 3.0;

/// What one trial's standard reads over what the rig makes it read, less one.
struct Reading {
    case: usize,
    excess: f64,
    /// The same for a drive at the session's frequency.
    excess_as_stated: f64,
    /// Frequency of the drive over the session's, less one.
    faster: f64,
    /// That frequency.
    rate_rad_s: f64,
}

/// Standards and clock against the rig's stroke and rotation. What they show in all trials is certain, what they show in some is
/// suspected: `found` keeps them apart.
pub fn examine(facts: &Facts<'_>, cases: &mut [TrialCase<'_>], found: &mut Found) {
    let (linear, angular) = of_both_standards(facts, cases);
    if let Some(finding) = wrong_clock(&linear, &angular, facts) {
        let is_certain = finding.cause == Cause::ClockMismatch;
        found.findings.push(finding);
        found.mark(Word::Certain);
        for case in cases {
            case.explained |= is_certain;
        }
        return;
    }
    for (what, of, key, standard, readings, units) in [
        (
            "accelerometer",
            "stroke",
            "stroke_mm",
            &facts.accelerometer,
            linear,
            &ACCELERATIONS[..],
        ),
        (
            "gyroscope",
            "rotation",
            "rotation_amplitude_deg",
            &facts.gyroscope,
            angular,
            &RATES[..],
        ),
    ] {
        let limit = standard.gain_limit + TOLERANCE;
        let odd: Vec<&Reading> = readings.iter().filter(|r| r.excess.abs() > limit).collect();
        // What a few trials show beside the rig is theirs: a drive that slipped, samples that are missing. The limbs tell whether a
        // standard was at fault there.
        if odd.len() as f64 <= MOST * readings.len() as f64 {
            let of_one_kind = all_of_a_kind(&odd, &readings, cases);
            if let Some(usual) = median_excess(of_one_kind.iter().copied()) {
                let word = if limbs_say_so(&of_one_kind, usual, cases) {
                    Word::Certain
                } else {
                    Word::Suspected
                };
                let advice = format!(
                    "check unit and sensitivity of the {what} in these recordings, and whether the rig's {of} was another"
                );
                let finding = of_a_standard(what, of, 1.0 + usual, limit, advice);
                let recordings = mark_explained(cases, of_one_kind.iter().map(|r| r.case));
                found.findings.push(finding.in_recordings(recordings));
                found.mark(word);
                continue;
            }
            let in_other_units = odd.into_iter().filter(|r| {
                let factor = 1.0 + r.excess;
                let near = |unit: &f64| (factor / unit - 1.0).abs() < A_UNIT;
                let no_crank = !(ANY_CRANK.recip()..=ANY_CRANK).contains(&factor);
                no_crank || units.iter().any(|unit| near(unit) || near(&unit.recip()))
            });
            for reading in in_other_units {
                let advice = format!(
                    "check this recording's unit of the {what}, and whether its direction and role are its own"
                );
                let finding = of_a_standard(what, of, 1.0 + reading.excess, limit, advice);
                let recordings = mark_explained(cases, [reading.case]);
                found.findings.push(finding.in_recordings(recordings));
                found.mark(Word::Certain);
            }
            continue;
        }
        let Some(usual) = median_excess(odd.iter().copied()) else {
            continue;
        };
        if (what == "gyroscope" || standard.lag_s > 0.0) && shows_a_lag(&readings, standard) {
            continue;
        }
        let advice = format!(
            "check unit and sensitivity{} of the {what} against its certificate, and [rig] {key}",
            if standard.lag_s > 0.0 {
                ", and the stated bandwidth_hz,"
            } else {
                ""
            }
        );
        let finding = of_a_standard(what, of, 1.0 + usual, limit, advice);
        let recordings = mark_explained(cases, odd.iter().map(|r| r.case));
        let (finding, word) = if odd.len() == readings.len() {
            (finding, Word::Certain)
        } else {
            (finding.in_recordings(recordings), Word::Suspected)
        };
        found.findings.push(finding);
        found.mark(word);
    }
}

/// The odd ones, if they are all of a kind of trials, and alike, and no other is.
fn all_of_a_kind<'a>(
    odd: &[&'a Reading],
    readings: &[Reading],
    cases: &[TrialCase<'_>],
) -> Vec<&'a Reading> {
    let role = |reading: &Reading| cases[reading.case].trial.role;
    let Some(kind) = odd.first().map(|first| role(first)) else {
        return Vec::new();
    };
    let of_kind = readings.iter().filter(|r| role(r) == kind).count();
    let usual = median_excess(odd.iter().copied()).unwrap_or(0.0);
    let alike = |r: &&Reading| role(r) == kind && (r.excess - usual).abs() < ALIKE * usual.abs();
    let all = odd.len() == of_kind && of_kind >= FEWEST && odd.iter().all(alike);
    if all { odd.to_vec() } else { Vec::new() }
}

/// Whether the limbs show of these trials as much less for the standard's reading as it reads too much, in trials of another kind on the same
/// wedge: with another crank they would not.
fn limbs_say_so(odd: &[&Reading], usual: f64, cases: &[TrialCase<'_>]) -> bool {
    let responses = |case: &TrialCase<'_>| {
        let response = case.response.as_ref()?;
        Some(response.channels.map(|channel| channel.response))
    };
    let mut over_others: Vec<f64> = Vec::new();
    for reading in odd {
        let own = &cases[reading.case];
        let others = cases.iter().filter(|other| {
            matches!(other.trial.role, Role::Linear | Role::HighFrequencyLinear)
                && other.trial.role != own.trial.role
                && same_wedge(other.trial.direction_ground, own.trial.direction_ground)
        });
        for other in others {
            let (Some(own), Some(other)) = (responses(own), responses(other)) else {
                continue;
            };
            let product: f64 = own.iter().zip(other).map(|(a, b)| a * b).sum();
            let squares: f64 = other.iter().map(|b| b * b).sum();
            over_others.push(product / squares);
        }
    }
    let shown = median(over_others);
    shown.is_some_and(|shown| {
        let too_much = shown.recip() - 1.0;
        (too_much - usual).abs() < ALIKE * usual.abs()
    })
}

/// Recordings in which the drive turned as the session says, for their standard reads what the rig then makes it read, and not what it would
/// make it read at the frequency that is seen: their clocks are off.
pub fn of_wrong_clocks(facts: &Facts<'_>, cases: &[TrialCase<'_>]) -> Vec<String> {
    let (linear, angular) = of_both_standards(facts, cases);
    let wrong = |standard: Standard| {
        let allowed = standard.gain_limit + TOLERANCE;
        move |reading: &&Reading| {
            reading.excess_as_stated.abs() <= allowed && reading.excess.abs() > TOLD_APART * allowed
        }
    };
    let linear = linear.iter().filter(wrong(facts.accelerometer));
    let angular = angular.iter().filter(wrong(facts.gyroscope));
    names(linear.chain(angular).map(|r| &cases[r.case]))
}

/// What the gyroscope reads over what the rig's rotation makes it read, in the median trial; none if the rig's rotation is not stated.
pub fn gyroscope_reads(facts: &Facts<'_>, cases: &[TrialCase<'_>]) -> Option<f64> {
    let (_, angular) = of_both_standards(facts, cases);
    median_excess(&angular).map(|excess| 1.0 + excess)
}

/// A standard that shows so many times what the rig asks for, and what that usually is.
fn of_a_standard(what: &str, of: &str, factor: f64, limit: f64, advice: String) -> Finding {
    let evidence = format!(
        "the standard {what} shows {} what the rig's {of} and the drive's frequency ask for, where certificate and workshop leave {:.1} %; {}",
        factor_in_words(factor),
        100.0 * limit,
        if what == "gyroscope" {
            reason_of_a_rate(factor)
        } else {
            reason(factor)
        }
    );
    Finding::new(cause_of(factor), evidence, advice)
}

/// Whether a first-order lag that nobody stated, or one that was and is not there, explains the readings better than a factor does: what
/// is missing, or too much, grows with the frequency. Lags are [`super::timing`]'s to name, and the joint fit's.
fn shows_a_lag(readings: &[Reading], standard: &Standard) -> bool {
    // 1/|1 + i w T|^2 is less than 1 by w^2 T^2 of itself.
    let missing = |r: &Reading| (1.0 + r.excess).powi(-2) - 1.0;
    let squared = |r: &Reading| r.rate_rad_s * r.rate_rad_s;
    let product: f64 = readings.iter().map(|r| squared(r) * missing(r)).sum();
    let squares: f64 = readings.iter().map(|r| squared(r).powi(2)).sum();
    let mean = readings.iter().map(missing).sum::<f64>() / readings.len() as f64;
    let left = |of: &dyn Fn(&Reading) -> f64| -> f64 {
        readings.iter().map(|r| (missing(r) - of(r)).powi(2)).sum()
    };
    (product > 0.0 || standard.lag_s > 0.0)
        && left(&|r| product / squares * squared(r)) < left(&|_| mean)
}

/// One error of the clock that explains what both standards and the drive show.
fn wrong_clock(linear: &[Reading], angular: &[Reading], facts: &Facts<'_>) -> Option<Finding> {
    let accelerometer = median_excess(linear)?;
    let gyroscope = median_excess(angular)?;
    let faster = median_faster(linear, angular)?;
    let of_accelerometer = TOLERANCE + facts.accelerometer.gain_limit;
    let of_gyroscope = TOLERANCE + facts.gyroscope.gain_limit;
    if accelerometer.abs() <= of_accelerometer && gyroscope.abs() <= of_gyroscope {
        return None;
    }
    // What it says stands beside what the other two do, each within its own part: of a large error by a share of it, of a small one by what
    // certificate and workshop leave.
    let of_all_three = || {
        // The accelerometer's word counts twice.
        let by_reading = 1.0 / (1.0 + accelerometer).sqrt() - 1.0;
        let near = |other: f64, certificate: f64| {
            (other - by_reading).abs() < ALIKE * by_reading.abs() + certificate
        };
        let by_gyroscope = 1.0 / (1.0 + gyroscope) - 1.0;
        // A drive that turns as the session says is no word for another clock, however small its error.
        let shows = faster * by_reading.signum() > ALIKE * by_reading.abs();
        (accelerometer.abs() > of_accelerometer
            && shows
            && near(faster, TOLERANCE)
            && near(by_gyroscope, facts.gyroscope.gain_limit))
        .then(|| {
            format!(
                "both standards read what a clock that is {} by {:.2} % makes of the rig's stroke and rotation",
                if by_reading < 0.0 { "slow" } else { "fast" },
                100.0 * by_reading.abs()
            )
        })
    };
    if let Some(readings) = of_all_three() {
        return Some(of_a_clock(faster, &readings, None));
    }
    // One standard is beyond its limit, and neither is by a clock that makes the drive turn as the session says.
    let left = |excess: f64, power: i32| (1.0 + excess) * (1.0 + faster).powi(power) - 1.0;
    let explains = left(accelerometer, 2).abs() <= of_accelerometer
        && left(gyroscope, 1).abs() <= of_gyroscope;
    let readings = format!(
        "the standard accelerometer reads {:+.2} % and the gyroscope {:+.2} % over what the rig makes them read at that frequency; at the session's, both read what certificate and workshop leave",
        100.0 * accelerometer,
        100.0 * gyroscope
    );
    let or = "check the standards' sensitivities and the rig's stroke and rotation";
    explains.then(|| of_a_clock(faster, &readings, Some(or)))
}

/// That the recordings' clock is off, of which the drive's frequency by it is a sign, and something else another one. A difference as small
/// as a motor may have of itself leaves open whether it is the clock; `or` says what to look at then.
pub(crate) fn of_a_clock(faster: f64, other_sign: &str, or: Option<&str>) -> Finding {
    let or = or.filter(|_| faster.abs() <= TOLERANCE);
    let evidence = format!(
        "by the recordings' clock the drive turns {:.2} % {} than the session says{}, and {other_sign}",
        100.0 * faster.abs(),
        if faster < 0.0 { "slower" } else { "faster" },
        or.map_or("", |_| ", as a motor may")
    );
    let advice = "check the recordings' clock against the recorder: sample_rate_hz, or the rate or the time stamps in the files";
    match or {
        None => Finding::new(Cause::ClockMismatch, evidence, advice),
        Some(or) => {
            let advice = format!("{advice}; if it is right, {or}");
            Finding::new(Cause::Unexplained, evidence, advice)
        }
    }
}

/// By how much the drive turns faster by the recordings' clocks than the session says, relative; none if the rig's stroke and rotation are
/// not stated.
pub fn drive_faster(facts: &Facts<'_>, cases: &[TrialCase<'_>]) -> Option<f64> {
    let (linear, angular) = of_both_standards(facts, cases);
    median_faster(&linear, &angular)
}

/// By how much the accelerometer's reading over what the rig makes it read changes from the first trial to the last, relative, along a line;
/// none if the rig's stroke is not stated, or of too few trials.
pub fn accelerometer_changes(facts: &Facts<'_>, cases: &[TrialCase<'_>]) -> Option<f64> {
    let (linear, _) = of_both_standards(facts, cases);
    let fitted = |cases: &[TrialCase<'_>]| {
        let runs = cases
            .iter()
            .filter(|case| case.trial.role != Role::Validation);
        runs.count() as f64
    };
    let last = fitted(cases) - 1.0;
    let count = linear.len() as f64;
    let place = |reading: &Reading| fitted(&cases[..reading.case]) / last;
    let middle = linear.iter().map(place).sum::<f64>() / count;
    let product: f64 = linear.iter().map(|r| (place(r) - middle) * r.excess).sum();
    let squares: f64 = linear.iter().map(|r| (place(r) - middle).powi(2)).sum();
    (linear.len() >= FEWEST).then(|| product / squares)
}

fn median_faster(linear: &[Reading], angular: &[Reading]) -> Option<f64> {
    median(linear.iter().chain(angular).map(|r| r.faster))
}

/// The accelerometer's readings and the gyroscope's, as far as the session states the rig.
fn of_both_standards(facts: &Facts<'_>, cases: &[TrialCase<'_>]) -> (Vec<Reading>, Vec<Reading>) {
    let slider = facts.rig.and_then(|rig| rig.stroke_mm);
    let slider = slider.map(|stroke_mm| 0.5 * (stroke_mm * 1e-3));
    let pinion = facts.rig.and_then(|rig| rig.rotation_amplitude_deg);
    let pinion = pinion.map(f64::to_radians);
    (
        readings(cases, slider, &facts.accelerometer, true),
        readings(cases, pinion, &facts.gyroscope, false),
    )
}

fn readings(
    cases: &[TrialCase<'_>],
    amplitude: Option<f64>,
    standard: &Standard,
    travels: bool,
) -> Vec<Reading> {
    let Some(amplitude) = amplitude else {
        return Vec::new();
    };
    let of = |(index, case): (usize, &TrialCase<'_>)| -> Option<Reading> {
        let trial = case.trial;
        let (series, whole) = match trial.role {
            Role::Linear | Role::HighFrequencyLinear if travels => (&trial.accelerometer_m_s2, 2),
            Role::Angular if !travels => (&trial.gyroscope_rad_s, 1),
            _ => return None,
        };
        let seen_hz = case
            .response
            .as_ref()
            .and_then(|response| response.frequency_hz)
            .unwrap_or(trial.frequency_hz);
        let found = fundamental::measure(series, trial.sample_rate_hz, seen_hz)?;
        let stated_rad_s = core::f64::consts::TAU * trial.frequency_hz;
        let excess_at = |rate_rad_s: f64| {
            let followed = 1.0_f64.hypot(rate_rad_s * standard.lag_s);
            followed * found.amplitude / (amplitude * rate_rad_s.powi(whole)) - 1.0
        };
        Some(Reading {
            case: index,
            excess: excess_at(found.rate_rad_s),
            excess_as_stated: excess_at(stated_rad_s),
            faster: found.rate_rad_s / stated_rad_s - 1.0,
            rate_rad_s: found.rate_rad_s,
        })
    };
    cases.iter().enumerate().filter_map(of).collect()
}

fn median_excess<'a>(readings: impl IntoIterator<Item = &'a Reading>) -> Option<f64> {
    median(readings.into_iter().map(|r| r.excess))
}

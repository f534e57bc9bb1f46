//! What happened to a recording between the converter and its file: its zero was taken off, values were repeated or rounded, samples
//! were lost. Noise of a converter does none of these.

use sixaxis_core::LIMBS;
use sixaxis_page::number::significant;
use sixaxis_recordings::runs::{Runs, stands_still};
use sixaxis_recordings::session::Role;

use super::raw::converter_step_v;
use super::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::trial::Trial;

/// Probability that a day without it is accused.
const CHANCE: f64 = 1e-9;
/// Samples that are at rest at the beginning of any recording.
const AT_REST: usize = 16;
/// Part of a converter's step within which a mean is exactly zero.
const EXACTLY: f64 = 1e-2;
/// Rows from which one says that all of them are repeated.
const FEWEST: usize = 64;
/// Times that a standard's readings are held from which its trial is no longer taken: what is held less is a delay, which the joint fit
/// finds.
const FEWEST_HELD: usize = 4;
/// Significant digits that a converter's values have more of.
const DIGITS: i32 = 3;
/// Steps that a channel must span for its digits to be told from its steps.
const SPANNED: f64 = 2e3;
/// Samples in a row that are equal, from which some are lost.
const FEWEST_LOST: usize = 8;
/// Times the usual change from sample to sample by which a channel jumps where samples are lost.
const JUMP: f64 = 4.0;
/// Share of the changes that are usual.
const USUAL: f64 = 0.99;

/// Recordings that are not as the converter gave them.
pub fn examine(at_rest: Option<&Trial>, cases: &mut [TrialCase<'_>], findings: &mut Vec<Finding>) {
    tared(at_rest, cases, findings);
    for (how, advice) in [
        (
            repeated as fn(&Trial) -> Option<String>,
            "export the recording at the rate at which it was recorded",
        ),
        (rounded, "export with all digits: %.9g or more"),
        (
            channels_held,
            "read all channels on one card at one rate, or export each at its own",
        ),
        (
            standard_held,
            "read the standard at the channels' rate, or give its own recording as reference_file: between its readings it is then interpolated",
        ),
    ] {
        let recordings = at_rest
            .into_iter()
            .chain(cases.iter().map(|case| case.trial));
        let mut found: Vec<(String, Vec<String>)> = Vec::new();
        for trial in recordings {
            let Some(evidence) = how(trial) else {
                continue;
            };
            match found.iter_mut().find(|(known, _)| *known == evidence) {
                Some((_, names)) => names.push(trial.name.clone()),
                None => found.push((evidence, vec![trial.name.clone()])),
            }
        }
        for (evidence, names) in found {
            for case in cases.iter_mut() {
                case.explained |= names.contains(&case.trial.name);
            }
            findings.push(Finding::new(Cause::Unreadable, evidence, advice).in_recordings(names));
        }
    }
    for case in cases.iter_mut().filter(|case| !case.explained) {
        lost(case, findings);
        stuck(case, findings);
    }
}

/// Which zero was taken off.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Taken {
    First,
    Mean,
}

/// Recordings whose own zero was taken off, each.
fn tared(at_rest: Option<&Trial>, cases: &mut [TrialCase<'_>], findings: &mut Vec<Finding>) {
    for taken in [Taken::First, Taken::Mean] {
        let all = at_rest
            .into_iter()
            .chain(cases.iter().map(|case| case.trial));
        let such: Vec<(&str, f64)> = all
            .filter_map(|trial| Some((trial.name.as_str(), by_chance(trial, taken)?)))
            .collect();
        if such.iter().map(|(_, chance)| chance).product::<f64>() > CHANCE {
            continue;
        }
        let what = match taken {
            Taken::First => "the first sample",
            Taken::Mean => "the mean",
        };
        let evidence = format!(
            "{what} is exactly 0 V in all nine channels: its own zero was taken off each recording, with the noise of that zero"
        );
        let advice = "export the voltages as they were recorded: zeros are those of the static record, and of it alone";
        let finding = Finding::new(Cause::Unreadable, evidence, advice);
        findings.push(finding.in_recordings(such.into_iter().map(|(name, _)| name)));
    }
}

/// How often a recording of a sensor whose zeros are within half a step would be so, by its first samples, at rest; none where it is not.
fn by_chance(trial: &Trial, taken: Taken) -> Option<f64> {
    let rows = &trial.voltage_v;
    let first = rows.first()?;
    let at_rest = &rows[..rows.len().min(AT_REST)];
    let mut chance = 1.0;
    for channel in 0..LIMBS {
        let zeros = at_rest.iter().filter(|row| row[channel] == 0.0).count();
        match taken {
            Taken::First if first[channel] == 0.0 => chance *= zeros as f64 / at_rest.len() as f64,
            Taken::Mean if zeros < at_rest.len() => {
                let mean = rows.iter().map(|row| row[channel]).sum::<f64>() / rows.len() as f64;
                let step = converter_step_v(trial, channel);
                // A channel that never changes has no step, and its mean is its value.
                if !(step.is_finite() && mean.abs() <= EXACTLY * step) {
                    return None;
                }
                chance *= 2.0 * EXACTLY;
            }
            Taken::First | Taken::Mean => return None,
        }
    }
    Some(chance)
}

/// Each row stands there several times.
fn repeated(trial: &Trial) -> Option<String> {
    let times = times_held(&trial.voltage_v)?;
    Some(format!(
        "each row stands there {times} times: values were held, or repeated to a higher rate"
    ))
}

/// Each reading of some channels, not of all, stands there so many times that they lag and have steps.
fn channels_held(trial: &Trial) -> Option<String> {
    let times = |channel: usize| {
        let series: Vec<f64> = trial.voltage_v.iter().map(|row| row[channel]).collect();
        times_held_evenly(&series).filter(|times| *times >= FEWEST_HELD)
    };
    let times: [Option<usize>; LIMBS] = core::array::from_fn(times);
    let such = (0..LIMBS).filter(|channel| times[*channel].is_some());
    let such: Vec<String> = such.map(|channel| (channel + 1).to_string()).collect();
    let least = times.iter().flatten().min()?;
    (such.len() < LIMBS).then(|| {
        format!(
            "each reading of channel{} {} stands there {least} times: it was read at {} Hz, and is late by half a period of that",
            if such.len() == 1 { "" } else { "s" },
            such.join(", "),
            significant(trial.sample_rate_hz / *least as f64, 4)
        )
    })
}

/// Each reading of the standard that a trial needs stands there so many times that it lags and has steps.
fn standard_held(trial: &Trial) -> Option<String> {
    let (name, series) = match trial.role {
        Role::Angular => ("gyroscope", &trial.gyroscope_rad_s),
        Role::Static | Role::Tap => return None,
        _ => ("accelerometer", &trial.accelerometer_m_s2),
    };
    let times = times_held(series).filter(|times| *times >= FEWEST_HELD)?;
    Some(format!(
        "each reading of the standard {name} stands there {times} times: it was read at {} Hz, and is late by half a period of that",
        significant(trial.sample_rate_hz / times as f64, 4)
    ))
}

/// How many times each of some values stands there, where it is more than once.
fn times_held<T: PartialEq>(values: &[T]) -> Option<usize> {
    let runs: Vec<usize> = values.chunk_by(|a, b| a == b).map(<[_]>::len).collect();
    // Cut anywhere, the first and the last may be shorter.
    let inner = runs.get(1..runs.len().checked_sub(1)?)?;
    let times = inner.iter().min().filter(|_| inner.len() >= FEWEST)?;
    (*times > 1).then_some(*times)
}

/// The same of a channel, where each stands there just so many times, or a multiple where two are equal: coarse readings of little motion are held for
/// any time.
pub(super) fn times_held_evenly(series: &[f64]) -> Option<usize> {
    let times = times_held(series)?;
    let runs: Vec<usize> = series.chunk_by(|a, b| a == b).map(<[_]>::len).collect();
    let inner = &runs[1..runs.len() - 1];
    inner.iter().all(|run| run % times == 0).then_some(times)
}

/// No value has more digits than a hand would write.
fn rounded(trial: &Trial) -> Option<String> {
    let few = |u: &f64| {
        let leading = u.abs().log10().floor();
        let scaled = u * 10_f64.powf(f64::from(DIGITS - 1) - leading);
        // A zero has no digits, and its logarithm no floor.
        *u == 0.0 || (scaled.round() - scaled).abs() < 1e-6
    };
    let spans = |channel: usize| {
        let peak = trial.voltage_v.iter().map(|row| row[channel].abs());
        peak.fold(0.0, f64::max) > SPANNED * converter_step_v(trial, channel)
    };
    let such = (0..LIMBS).filter(|channel| spans(*channel)).count() > LIMBS / 2;
    (such && trial.voltage_v.iter().flatten().all(few))
        .then(|| format!("no voltage has more than {DIGITS} significant digits"))
}

/// Samples that stand still while the motion goes on.
struct Lost {
    from: usize,
    samples: usize,
    value: f64,
}

impl Lost {
    fn of(series: &[f64]) -> Option<Self> {
        let mut changes: Vec<f64> = series.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
        changes.retain(|change| *change > 0.0);
        let place = (USUAL * changes.len() as f64) as usize;
        if place >= changes.len() {
            return None;
        }
        let (_, usual, _) = changes.select_nth_unstable_by(place, f64::total_cmp);
        // A spike is no jump: what comes after it is where it was.
        let elsewhere = |at: usize, other: Option<usize>| {
            other
                .and_then(|other| series.get(other))
                .is_some_and(|u| (u - series[at]).abs() > JUMP * *usual)
        };
        let (mut from, mut ordinary) = (0_usize, 0);
        let mut longest: Option<Self> = None;
        for run in series.chunk_by(|a, b| a == b) {
            let to = from + run.len();
            let jumped = [1, 2].iter().all(|n| elsewhere(from, from.checked_sub(*n)))
                || [0, 1].iter().all(|n| elsewhere(from, Some(to + n)));
            if !jumped {
                ordinary = ordinary.max(run.len());
            } else if longest.as_ref().is_none_or(|lost| lost.samples < run.len()) {
                longest = Some(Self {
                    from,
                    samples: run.len(),
                    value: run[0],
                });
            }
            from = to;
        }
        longest.filter(|lost| lost.samples >= FEWEST_LOST && lost.samples > ordinary)
    }

    fn in_words(&self, unit: &str) -> String {
        format!(
            "{} samples in a row, from sample {} on, stand at {:.4} {unit} to the last bit, with a jump before or after them",
            self.samples, self.from, self.value
        )
    }
}

/// Channels of a trial that stand still for a while, or from some sample on, without a jump that would tell of lost samples.
fn stuck(case: &mut TrialCase<'_>, findings: &mut Vec<Finding>) {
    let trial = case.trial;
    if matches!(trial.role, Role::Static | Role::Tap) {
        return;
    }
    let runs: [Runs; LIMBS] =
        core::array::from_fn(|channel| Runs::of(trial.voltage_v.iter().map(|row| row[channel])));
    for channel in 0..LIMBS {
        let Some(run) = stands_still(&runs, channel).filter(|_| !case.ignored[channel]) else {
            continue;
        };
        case.ignored[channel] = true;
        let evidence = format!(
            "it stands at {:.4} V to the last bit for {} of {} samples, from sample {} on, while the other channels move",
            trial.voltage_v[run.first as usize][channel],
            run.samples,
            trial.voltage_v.len(),
            run.first
        );
        let advice = format!(
            "see plugs, cable and amplifier of limb {}, and record the trial again",
            channel + 1
        );
        let finding = Finding::new(Cause::DeadLimb, evidence, advice);
        findings.push(finding.in_trial(trial).on_channels([channel]));
    }
}

/// Samples of a trial's channels and standards that were lost.
fn lost(case: &mut TrialCase<'_>, findings: &mut Vec<Finding>) {
    let trial = case.trial;
    if matches!(trial.role, Role::Static | Role::Tap) {
        return;
    }
    let mut finding = |channels: Vec<usize>, evidence: String| {
        let advice = "samples were lost there: record the trial again, or leave it out";
        let finding = Finding::new(Cause::Unreadable, evidence, advice);
        findings.push(finding.in_trial(trial).on_channels(channels));
    };
    let of_channels: Vec<(usize, Lost)> = (0..LIMBS)
        .filter_map(|channel| {
            let series: Vec<f64> = trial.voltage_v.iter().map(|row| row[channel]).collect();
            Some((channel, Lost::of(&series)?))
        })
        .collect();
    if let Some((_, lost)) = of_channels.first() {
        for (channel, _) in &of_channels {
            case.ignored[*channel] = true;
        }
        let channels: Vec<usize> = of_channels.iter().map(|(channel, _)| *channel).collect();
        let all = channels.len() > LIMBS / 2;
        case.explained |= all;
        finding(if all { Vec::new() } else { channels }, lost.in_words("V"));
    }
    for (name, unit, series) in [
        ("accelerometer", "m/s²", &trial.accelerometer_m_s2),
        ("gyroscope", "rad/s", &trial.gyroscope_rad_s),
    ] {
        if let Some(lost) = Lost::of(series) {
            case.explained = true;
            finding(
                Vec::new(),
                format!("of the standard {name}, {}", lost.in_words(unit)),
            );
        }
    }
}

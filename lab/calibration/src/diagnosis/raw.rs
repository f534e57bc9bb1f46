//! What one recording shows by itself: channels at the converter's limit or beyond it, standards that are cut off, one channel that stands
//! there twice.

use sixaxis_core::LIMBS;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;

use super::flat_top::flat_top;
use super::level::{cause_of, factor_in_words, is_thousand};
use super::structure::{all_over_design, over_design};
use super::trial_case::{Facts, TrialCase};
use crate::finding::{Cause, Finding};
use crate::series::{extent, mean_of, median};
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Voltages beyond this multiple of the converter's limit did not come from it as volts.
const BEYOND: f64 = 1.2;
/// Samples of the day beyond it that are wild ones, each by itself.
const WILD: usize = 10;

/// Clipped channels and standards, and copied channels.
pub fn examine(
    facts: &Facts<'_>,
    at_rest: Option<&Trial>,
    cases: &mut [TrialCase<'_>],
    findings: &mut Vec<Finding>,
) {
    let beyond = beyond_converter(facts, at_rest, cases, findings);
    if let Some(rest) = at_rest {
        for channel in (0..LIMBS).filter(|channel| !beyond[*channel]) {
            if clipped(rest, channel) == Some(Clipping::AtLimit) {
                findings.push(clipping(rest, channel, Clipping::AtLimit));
            }
        }
    }
    for channel in (0..LIMBS).filter(|channel| !beyond[*channel]) {
        let mut of_channel: Option<Finding> = None;
        for case in cases.iter_mut().filter(|case| !case.explained) {
            if let Some(how) = clipped(case.trial, channel) {
                case.ignored[channel] = true;
                match &mut of_channel {
                    Some(first) => first.recordings.push(case.trial.name.clone()),
                    none => *none = Some(clipping(case.trial, channel, how)),
                }
            }
        }
        findings.extend(of_channel.map(|finding| match finding.recordings.len() {
            1 => finding,
            _ => Finding {
                evidence: format!("in the first of them {}", finding.evidence),
                ..finding
            },
        }));
    }
    twins(cases, findings);
    standards(cases, findings);
}

/// Limbs' channels that are another one's copy.
fn twins(cases: &mut [TrialCase<'_>], findings: &mut Vec<Finding>) {
    for (a, b) in (0..LIMBS).flat_map(|a| (a + 1..LIMBS).map(move |b| (a, b))) {
        let mut recordings = Vec::new();
        for case in cases.iter_mut() {
            let rows = &case.trial.voltage_v;
            let moves = rows.iter().any(|row| row[a] != rows[0][a]);
            if moves && rows.iter().all(|row| row[a] == row[b]) {
                (case.ignored[a], case.ignored[b]) = (true, true);
                recordings.push(case.trial.name.clone());
            }
        }
        if recordings.is_empty() {
            continue;
        }
        if recordings.len() == cases.len() {
            recordings.clear();
        }
        let evidence = format!(
            "channels {} and {} are the same, sample by sample",
            a + 1,
            b + 1
        );
        let advice =
            "see whether a column was copied, or one name stands twice in [channels]; export again";
        let finding = Finding::new(Cause::Unreadable, evidence, advice);
        findings.push(finding.in_recordings(recordings).on_channels([a, b]));
    }
}

/// Standards whose readings are cut off at their ends.
fn standards(cases: &mut [TrialCase<'_>], findings: &mut Vec<Finding>) {
    for (name, unit) in [("accelerometer", "m/s²"), ("gyroscope", "rad/s")] {
        let mut recordings = Vec::new();
        let mut largest = 0.0_f64;
        // Readings that are held have flat tops, too.
        for case in cases.iter_mut().filter(|case| !case.explained) {
            let series = if name == "gyroscope" {
                &case.trial.gyroscope_rad_s
            } else {
                &case.trial.accelerometer_m_s2
            };
            if let Some(top) = flat_top(series, step_of(series)) {
                largest = largest.max(top.abs());
                recordings.push(case.trial.name.clone());
                case.explained = true;
            }
        }
        if !recordings.is_empty() {
            let evidence = format!(
                "the standard {name} is cut off: it stands at its largest reading, up to {largest:.4} {unit}, for several samples together"
            );
            let advice = format!(
                "set the range of the standard {name} or of its channel wider and record again"
            );
            let finding = Finding::new(Cause::ClippedConverter, evidence, advice);
            findings.push(finding.in_recordings(recordings));
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Clipping {
    AtLimit,
    FlatTop(f64),
}

fn clipping(trial: &Trial, channel: usize, how: Clipping) -> Finding {
    let limit = trial.full_scale_v;
    let beyond = trial
        .voltage_v
        .iter()
        .filter(|row| match how {
            Clipping::AtLimit => row[channel].abs() >= limit,
            Clipping::FlatTop(top) => row[channel] == top,
        })
        .count();
    let evidence = match how {
        Clipping::AtLimit => format!(
            "{beyond} of {} samples stand at the converter's limit of {limit} V",
            trial.voltage_v.len()
        ),
        Clipping::FlatTop(top) => format!(
            "flat at {top:.4} V in {beyond} samples, below the limit of {limit} V that the session states"
        ),
    };
    let advice = "set the amplifier to its next coarser range and record the trial again";
    let finding = Finding::new(Cause::ClippedConverter, evidence, advice);
    finding.in_trial(trial).on_channels([channel])
}

/// Whether a trial holds a voltage that no converter of the stated range delivers.
pub(crate) fn reads_beyond_converter(trial: &Trial) -> bool {
    let limit_v = BEYOND * trial.full_scale_v;
    trial.voltage_v.iter().flatten().any(|u| u.abs() > limit_v)
}

/// Values that no converter of the stated range delivers: they are in another unit than the file or the session says, or times a
/// factor. Returns the channels concerned.
fn beyond_converter(
    facts: &Facts<'_>,
    at_rest: Option<&Trial>,
    cases: &mut [TrialCase<'_>],
    findings: &mut Vec<Finding>,
) -> [bool; LIMBS] {
    let largest = |trial: &Trial, channel: usize| {
        trial
            .voltage_v
            .iter()
            .fold(0.0_f64, |a, row| a.max(row[channel].abs()))
    };
    let mut recordings = Vec::new();
    let mut channels = [false; LIMBS];
    let mut most = (0.0, 0.0);
    let mut samples = 0;
    let mut first: Option<(String, usize)> = None;
    let shares = StaticLoadSharing::new(&facts.geometry).ok();
    let mut factors: Vec<f64> = Vec::new();
    let mut look = |trial: &Trial| -> [bool; LIMBS] {
        let peaks: [f64; LIMBS] = core::array::from_fn(|channel| largest(trial, channel));
        let beyond = peaks.map(|peak| peak > BEYOND * trial.full_scale_v);
        if beyond.contains(&true) {
            recordings.push(trial.name.clone());
            for (sample, row) in trial.voltage_v.iter().enumerate() {
                if row.iter().any(|u| u.abs() > BEYOND * trial.full_scale_v) {
                    samples += 1;
                    first.get_or_insert_with(|| (trial.name.clone(), sample));
                }
            }
            for channel in 0..LIMBS {
                channels[channel] |= beyond[channel];
                if peaks[channel] > most.0 {
                    most = (peaks[channel], trial.full_scale_v);
                }
            }
        }
        beyond
    };
    if let Some(rest) = at_rest {
        look(rest);
    }
    for case in cases.iter_mut() {
        let beyond = look(case.trial);
        for channel in (0..LIMBS).filter(|channel| beyond[*channel]) {
            case.ignored[channel] = true;
            let over = shares
                .as_ref()
                .and_then(|shares| over_design(shares, facts, case, channel));
            factors.extend(over);
        }
        // Channels of one recorder share its unit; those that stay within the range by chance are no better.
        let all = beyond.iter().filter(|b| **b).count() > LIMBS / 2;
        if all && case.trial.role == Role::Validation {
            let over = shares
                .as_ref()
                .and_then(|shares| all_over_design(shares, facts, case));
            factors.extend(over);
        }
        case.explained |= all;
    }
    if recordings.is_empty() {
        return channels;
    }
    // By the design, which is right to a factor of two, where a trial moves these channels; else by the zeros of the trials.
    let by_design = median(factors).map(|factor| (factor, "what the design makes one expect"));
    let by_zeros = || {
        let at_rest = at_rest.filter(|rest| recordings.contains(&rest.name))?;
        let factor = over_zeros(at_rest, cases)?;
        Some((factor, "the zeros of the linear trials"))
    };
    let (factor, of_what) = by_design
        .or_else(by_zeros)
        .unwrap_or((most.0 / most.1, "the range"));
    // A cell that lost its decimal mark is no unit.
    let wild = first.filter(|_| samples <= WILD);
    let (cause, what, advice) = match &wild {
        Some((name, sample)) => (
            Cause::Unreadable,
            format!("in {samples} of all samples, the first of them sample {sample} of {name}"),
            "mend these samples in the file, or take single wild ones out with [preprocessing] outliers",
        ),
        None => (
            cause_of(factor),
            format!("{} {of_what}", factor_in_words(factor)),
            if is_thousand(factor) {
                "the numbers are millivolts: say so in the file's heading, or where it states no unit in [channels] limbs_unit"
            } else {
                "check the unit of the limbs' channels and sensor.full_scale_v"
            },
        ),
    };
    let evidence = format!(
        "voltages up to {:.1} V from a converter that ends at {} V, {what}",
        most.0, most.1
    );
    let mut finding = Finding::new(cause, evidence, advice);
    if recordings.len() <= cases.len() / 2 {
        finding = finding.in_recordings(recordings);
    }
    if channels.iter().filter(|b| **b).count() <= LIMBS / 2 {
        finding = finding.on_channels((0..LIMBS).filter(|channel| channels[*channel]));
    }
    findings.push(finding);
    channels
}

/// Means of a static record's channels over those of the linear trials, which begin and end at rest, in the median channel.
fn over_zeros(rest: &Trial, cases: &[TrialCase<'_>]) -> Option<f64> {
    let of_channel = |channel: usize| {
        let linear = cases.iter().filter(|case| case.trial.role == Role::Linear);
        let zero = median(linear.map(|case| mean_of(&case.trial.voltage_v, channel)))?;
        Some(mean_of(&rest.voltage_v, channel) / zero)
    };
    median((0..LIMBS).filter_map(of_channel)).filter(|factor| factor.is_finite())
}

/// The converter's step, V: the smallest difference that occurs between neighbours; infinite for a channel that never changes.
pub(crate) fn converter_step_v(trial: &Trial, channel: usize) -> f64 {
    smallest(
        trial
            .voltage_v
            .windows(2)
            .map(|pair| pair[1][channel] - pair[0][channel]),
    )
}

/// The same of a series.
pub(crate) fn step_of(series: &[f64]) -> f64 {
    smallest(series.windows(2).map(|pair| pair[1] - pair[0]))
}

fn smallest(differences: impl Iterator<Item = f64>) -> f64 {
    differences
        .map(f64::abs)
        .filter(|d| *d > 0.0)
        .fold(f64::INFINITY, f64::min)
}

fn clipped(trial: &Trial, channel: usize) -> Option<Clipping> {
    let (low, high) = extent(trial.voltage_v.iter().map(|row| row[channel]));
    let (peak, limit) = (high.max(-low), trial.full_scale_v);
    if peak > BEYOND * limit {
        return None;
    }
    let step = converter_step_v(trial, channel);
    // What stands at the limit does not go beyond it: a converter that does has another limit.
    if peak >= limit && peak <= limit + 0.5 * step {
        return Some(Clipping::AtLimit);
    }
    if trial.role == Role::Static {
        return None;
    }
    let series: Vec<f64> = trial.voltage_v.iter().map(|row| row[channel]).collect();
    flat_top(&series, step).map(Clipping::FlatTop)
}

//! Whether the static record's zeros are those of the trials. A linear run begins and ends at rest, so that its channels show their
//! zeros in the mean; a record of another sensor, of an open input, in another unit or of a moving sensor does not show them.

use sixaxis_core::LIMBS;
use sixaxis_core::identify::zero_drift::{self, ZeroDrift};

use super::table::{usable, weighted_median};
use super::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::series::median;
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Trials from which one says what is usual.
const FEWEST: usize = 6;
/// Times that the static record's zero must be off by what the trials' zeros are from each other, in the mean.
const ELSEWHERE: f64 = 8.0;
/// Smallest share of the converter's range that is noticed where most channels show another zero altogether.
const OF_MOST: f64 = 3e-4;
/// Part of itself by which a zero is another one: amplifiers that warm up move theirs by less.
const ANOTHER: f64 = 0.5;
/// Smallest share of the converter's range that is noticed of single channels, where many trials show their zeros.
const OF_ONE: f64 = 5e-5;
/// The same from one static record to the next, hours later.
const OF_THE_DAY: f64 = 1e-3;
/// Samples of a trial's end at which it is at rest, if anywhere.
const AT_AN_END: usize = 16;
/// Part of what a zero is off in the mean by which it may be off at rest, if the motion alone makes it.
const AT_REST: f64 = 0.25;
/// Share of a linear trial's signal that a record at rest does not show.
const MOVES: f64 = 0.5;

/// Holds the static record, of converters with these steps, against the linear trials.
pub fn examine(
    rest: &Trial,
    drift: &ZeroDrift,
    steps_v: &[f64; LIMBS],
    cases: &[TrialCase<'_>],
    findings: &mut Vec<Finding>,
) {
    let known = |channel: &usize| {
        let concerned = |f: &Finding| f.concerns(&rest.name, channel + 1);
        findings.iter().any(concerned)
    };
    let open: Vec<usize> = (0..LIMBS).filter(|channel| !known(channel)).collect();
    let shares = open
        .iter()
        .filter_map(|channel| share_of_a_trial(rest, drift, cases, *channel));
    if let Some(share) = median(shares).filter(|share| *share > MOVES) {
        findings.push(of_the_record(
            rest,
            format!(
                "the static record's channels scatter by {:.0} % of what they show in a linear trial: the sensor moved, or it is the record of a trial",
                100.0 * share
            ),
        ));
        return;
    }
    let off = open
        .into_iter()
        .filter_map(|channel| Some((channel, elsewhere(drift, steps_v, channel, cases)?)));
    findings.extend(judged(rest, off, OF_ONE, in_words));
}

/// Holds a further static record against the first, whose zeros are taken. Both are of the same day.
pub fn of_a_further_record(first: &Trial, further: &Trial) -> Option<Finding> {
    let [zero, later] = [first, further].map(|rest| zero_drift::identify(&rest.voltage_v).ok());
    let (zero, later) = (zero?, later?);
    let off = (0..LIMBS).map(|channel| {
        let found = Elsewhere {
            zero_v: zero.drift_v[channel],
            off_v: later.drift_v[channel] - zero.drift_v[channel],
            scatter_v: 0.0,
        };
        (channel, found)
    });
    let in_words = |furthest: &(usize, Elsewhere)| {
        let (channel, found) = furthest;
        format!(
            "channel {}'s zero is {:+.3} mV from that of {}",
            channel + 1,
            1e3 * found.off_v,
            first.name
        )
    };
    judged(further, off, OF_THE_DAY, in_words)
}

/// What zeros that are `off`, single ones by a share of the range at least, say of a static record.
fn judged(
    rest: &Trial,
    off: impl Iterator<Item = (usize, Elsewhere)>,
    of_one: f64,
    in_words: impl Fn(&(usize, Elsewhere)) -> String,
) -> Option<Finding> {
    let off: Vec<(usize, Elsewhere)> = off.collect();
    let beyond = |found: &Elsewhere, share: f64| found.off_v.abs() > share * rest.full_scale_v;
    let furthest_of = |some: &[&(usize, Elsewhere)]| {
        let furthest = some
            .iter()
            .max_by(|(_, a), (_, b)| a.off_v.abs().total_cmp(&b.off_v.abs()));
        furthest.map_or(String::new(), |furthest| in_words(furthest))
    };
    let others: Vec<&(usize, Elsewhere)> = off
        .iter()
        .filter(|(_, found)| {
            beyond(found, OF_MOST) && found.off_v.abs() > ANOTHER * found.zero_v.abs()
        })
        .collect();
    if others.len() > LIMBS / 2 {
        let evidence = furthest_of(&others);
        let evidence = format!("{evidence}; {} channels show another one", others.len());
        return Some(of_the_record(rest, evidence));
    }
    let moved: Vec<&(usize, Elsewhere)> = off
        .iter()
        .filter(|(_, found)| beyond(found, of_one))
        .collect();
    (!moved.is_empty()).then(|| {
        let advice = "record at rest again, right before the trials";
        Finding::new(Cause::DriftDuringRun, furthest_of(&moved), advice)
            .in_trial(rest)
            .on_channels(moved.iter().map(|(channel, _)| *channel))
    })
}

fn in_words((channel, found): &(usize, Elsewhere)) -> String {
    format!(
        "the linear trials show channel {}'s zero {:+.3} mV from the static record's, and {:.3} mV from each other in the mean",
        channel + 1,
        1e3 * found.off_v,
        1e3 * found.scatter_v
    )
}

fn of_the_record(rest: &Trial, evidence: String) -> Finding {
    let advice = "see whether the static record is of this sensor, in the trials' unit and at rest; record at rest again";
    Finding::new(Cause::Unreadable, evidence, advice).in_trial(rest)
}

/// A channel's zero by the trials.
struct Elsewhere {
    zero_v: f64,
    /// From the static record's.
    off_v: f64,
    /// From trial to trial, in the mean.
    scatter_v: f64,
}

/// None where it is the static record's.
fn elsewhere(
    drift: &ZeroDrift,
    steps_v: &[f64; LIMBS],
    channel: usize,
    cases: &[TrialCase<'_>],
) -> Option<Elsewhere> {
    let mut offsets: Vec<(f64, f64)> = Vec::new();
    let mut errors: Vec<(f64, f64)> = Vec::new();
    for (case, response) in usable(cases) {
        let linear = matches!(case.trial.role, Role::Linear | Role::HighFrequencyLinear);
        if linear && !case.ignored[channel] {
            let gain = case.trial.gains.gain_n_per_v[channel];
            let own = &response.channels[channel];
            offsets.push((own.offset_n / gain, 1.0));
            errors.push(((own.offset_error_n / gain).abs(), 1.0));
        }
    }
    if offsets.len() < FEWEST {
        return None;
    }
    let off_v = weighted_median(&mut offsets)?;
    let away = offsets.iter().map(|(offset, _)| (offset - off_v).abs());
    let scatter_v = away.sum::<f64>() / offsets.len() as f64;
    let error_v = weighted_median(&mut errors)?.max(drift.standard_error_v[channel]);
    // A converter whose steps are as coarse as the noise shows a zero to half a step.
    let step_v = Some(steps_v[channel]).filter(|step| step.is_finite());
    let by_chance = ELSEWHERE * scatter_v.max(error_v) + step_v.unwrap_or(0.0);
    (off_v.abs() > by_chance && !rectified(drift, channel, off_v, cases)).then_some(Elsewhere {
        zero_v: drift.drift_v[channel] + off_v,
        off_v,
        scatter_v,
    })
}

/// Whether the linear trials begin and end at the static record's zero, and show another only in the mean of their motion: a limb that is stiffer
/// one way than the other does, and the record is right.
fn rectified(drift: &ZeroDrift, channel: usize, off_v: f64, cases: &[TrialCase<'_>]) -> bool {
    let at_ends = |case: &TrialCase<'_>| {
        let rows = &case.trial.voltage_v;
        let end = |rows: &[[f64; LIMBS]]| {
            rows.iter().map(|row| row[channel]).sum::<f64>() / rows.len() as f64
        };
        let (first, last) = (rows.get(..AT_AN_END)?, rows.last_chunk::<AT_AN_END>()?);
        Some(0.5 * (end(first) + end(last)) - drift.drift_v[channel])
    };
    let linear = usable(cases).filter(|(case, _)| case.trial.role == Role::Linear);
    let ends: Vec<f64> = linear.filter_map(|(case, _)| at_ends(case)).collect();
    let near = |share: f64, of: &f64| (of / off_v).abs() < share;
    median(ends.iter().copied()).is_some_and(|end| near(AT_REST, &end))
        && 2 * ends.iter().filter(|end| near(2.0 * AT_REST, end)).count() > ends.len()
}

/// What a channel shows at rest over what it shows in a linear trial, root mean squares: of voltages or of forces, whichever is less, since
/// noise of the converter grows with the range and hum of the limb does not.
fn share_of_a_trial(
    rest: &Trial,
    drift: &ZeroDrift,
    cases: &[TrialCase<'_>],
    channel: usize,
) -> Option<f64> {
    let gain = |trial: &Trial| trial.gains.gain_n_per_v[channel].abs();
    let at_rest_n = drift.noise_v[channel] * gain(rest);
    let linear = usable(cases).filter(|(case, _)| case.trial.role == Role::Linear);
    let shares = linear
        .filter(|(_, response)| response.channels[channel].signal_n > 0.0)
        .map(|(case, response)| {
            let over_signal = at_rest_n / response.channels[channel].signal_n;
            over_signal * (gain(case.trial) / gain(rest)).min(1.0)
        });
    median(shares)
}

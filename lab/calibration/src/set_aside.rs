//! Trials with which nothing can be done, taken out before anything else: copies of others, those with absurd readings of a standard, and
//! those that are not whole.

use std::cmp::Ordering;
use std::collections::HashMap;

use sixaxis_core::LIMBS;

use crate::diagnosis::raw::reads_beyond_converter;
use crate::drive;
use crate::finding::{Cause, Finding, unreadable};
use crate::joint::record;
use crate::trial::Trial;

/// Rows in a row that two recordings share where one holds a part of the other: noise does not repeat itself.
const SHARED: usize = 32;
/// Part of a wild reading that hardly any other reaches.
const HUNDREDTH: f64 = 0.01;
/// Readings of a trial up to which they are single ones.
const SINGLE: usize = 3;
/// Share of the trials up to which those that do not end where they began are the exception.
const FEW: f64 = 0.25;

/// Takes out trials that are another one's copy, whole or in part: they would count as evidence of their own.
pub(crate) fn copies(trials: &mut Vec<Trial>) -> Vec<Finding> {
    let mut findings = Vec::new();
    while let Some((copy, original)) = a_copy(trials) {
        let name = &trials[original].name;
        let whole = trials[copy].voltage_v == trials[original].voltage_v;
        let (evidence, advice) = if *name == trials[copy].name {
            (
                "it stands in the session twice".to_owned(),
                "see which file the second entry is meant to name: each trial is a recording of its own",
            )
        } else {
            (
                format!(
                    "the same samples as {}{name}",
                    if whole { "" } else { "a part of " }
                ),
                "take the copy out of the session: each trial is a recording of its own",
            )
        };
        let name = trials.remove(copy).name;
        unreadable(&mut findings, &name, &evidence, advice);
    }
    findings
}

/// A trial that is a copy, and of which: rows from the middle of one stand in the other.
fn a_copy(trials: &[Trial]) -> Option<(usize, usize)> {
    let middles: Vec<Option<&[[f64; LIMBS]]>> = trials.iter().map(middle).collect();
    // By the bits of their first voltage.
    let mut starting: HashMap<u64, Vec<usize>> = HashMap::new();
    for (index, rows) in middles.iter().enumerate() {
        if let Some(rows) = rows {
            starting
                .entry(rows[0][0].to_bits())
                .or_default()
                .push(index);
        }
    }
    let stands_in = |(holder, trial): (usize, &Trial)| {
        trial.voltage_v.windows(SHARED).find_map(|rows| {
            let alike = starting.get(&rows[0][0].to_bits())?;
            let mut others = alike.iter().filter(|other| **other != holder);
            let other = others.find(|other| middles[**other] == Some(rows))?;
            Some((holder, *other))
        })
    };
    let (a, b) = trials.iter().enumerate().find_map(stands_in)?;
    let (first, second) = (a.min(b), a.max(b));
    // The copy is the shorter one, or else the one that does not turn as the session says.
    let far = |trial: &Trial| {
        match drive::seen_hz(trial) {
            Some(seen_hz) => (seen_hz / trial.frequency_hz).ln().abs(),
            // The standard of another kind of trials.
            None if drive::shows_noise_alone(trial) => f64::INFINITY,
            None => 0.0,
        }
    };
    let lengths = [first, second].map(|index| trials[index].voltage_v.len());
    let first_is_copy = match lengths[0].cmp(&lengths[1]) {
        Ordering::Less => true,
        Ordering::Greater => false,
        Ordering::Equal => far(&trials[first]) > far(&trials[second]),
    };
    Some(if first_is_copy {
        (first, second)
    } else {
        (second, first)
    })
}

/// Rows from the middle of a recording, where it moves; none of one that does not.
fn middle(trial: &Trial) -> Option<&[[f64; LIMBS]]> {
    let from = trial.voltage_v.len().saturating_sub(SHARED) / 2;
    let rows = trial.voltage_v.get(from..from + SHARED)?;
    (rows.first() != rows.last()).then_some(rows)
}

/// Takes out trials in which single readings of a standard dwarf all others: of what moves or makes noise many come near the largest.
pub(crate) fn wild_standards(trials: &mut Vec<Trial>) -> Vec<Finding> {
    let mut findings = Vec::new();
    trials.retain(|trial| {
        let standards = [
            ("accelerometer", &trial.accelerometer_m_s2),
            ("gyroscope", &trial.gyroscope_rad_s),
        ];
        let wild = standards
            .into_iter()
            .find_map(|(name, series)| Some((name, series, wild(series)?)));
        let Some((standard, series, sample)) = wild else {
            return true;
        };
        let evidence = format!(
            "the {standard}'s reading of {:.1e} at sample {sample} is more than a hundred times all but a few others",
            series[sample]
        );
        let advice = "mend such readings in the file, or take single wild ones out with [preprocessing] outliers";
        unreadable(&mut findings, &trial.name, &evidence, advice);
        false
    });
    findings
}

/// The sample of a series' largest reading, if only a few of the others reach a hundredth of it. A coarse converter at rest reads zero but
/// for single steps: of a series that is mostly zero nothing is said.
fn wild(series: &[f64]) -> Option<usize> {
    let sizes = series.iter().map(|reading| reading.abs());
    let (sample, largest) = sizes
        .clone()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let near = sizes.filter(|size| *size > HUNDREDTH * largest).count();
    let reading = series.iter().filter(|reading| **reading != 0.0).count();
    (near <= SINGLE && 2 * reading > series.len() && reading > SINGLE * SINGLE).then_some(sample)
}

/// Takes out the few trials that do not end where they began, where all others do. Where many do not, that is how they were recorded.
pub(crate) fn not_whole(trials: &mut Vec<Trial>) -> Option<Finding> {
    // One voltage that none can be hides where the motion begins and ends; it has a finding of its own.
    let sane = |trial: &&Trial| !reads_beyond_converter(trial);
    let jump = |trial: &Trial| match record(Some(trial).filter(sane)?)?.closes() {
        Err(sixaxis_core::Error::NotClosed { jump_over_step, .. }) => Some(jump_over_step),
        _ => None,
    };
    let jumps: Vec<f64> = trials.iter().filter_map(jump).collect();
    if jumps.is_empty() || jumps.len() as f64 > FEW * trials.len() as f64 {
        return None;
    }
    let evidence = format!(
        "not whole: from its last sample back to its first the standard jumps by {:.1} times its largest step, where a trial begins and ends at rest or holds whole turns",
        jumps.into_iter().fold(0.0, f64::max)
    );
    let advice = "see whether the file was cut off, and record the trial again";
    let open = trials.extract_if(.., |trial| jump(trial).is_some());
    let names: Vec<String> = open.map(|trial| trial.name).collect();
    Some(Finding::new(Cause::Unreadable, evidence, advice).in_recordings(names))
}

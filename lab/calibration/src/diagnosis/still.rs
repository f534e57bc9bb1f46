//! Channels of the static record that read nothing, not even noise: a plug that was seated late, or never.
//!
//! A mean over such a record is a number that nobody measured, and its spread over the batches is 0: the zero would be wrong and
//! look perfect. Noise repeats itself, too, where a converter is coarse. What counts is whether noise like that of the other eight
//! channels, in this converter, would ever stand still for so long.

use sixaxis_core::LIMBS;
use sixaxis_core::significance::chi_square_tail;

use super::raw::converter_step_v;
use crate::finding::{Cause, Finding};
use crate::series::{extent, median};
use crate::trial::Trial;

/// Probability that a record of noise is accused.
const CHANCE: f64 = 1e-9;
/// Times the other channels' longest run that a run must have. Runs of noise that remembers a few samples end, too, by a constant
/// chance a sample; if that makes n samples' longest run R, one of 3 R is as likely as 1 / n^2.
const LONGER: f64 = 3.0;
/// Times that the other channels must span this one's span for it to be quiet. Nine amplifiers of a kind differ by less; an open
/// input leaves the converter's last bit.
const QUIET: f64 = 10.0;

/// What stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Still {
    /// The same value again and again, where noise would have changed it.
    Run {
        /// That value, V.
        value_v: f64,
        /// Samples in a row.
        samples: usize,
        /// Samples in a row that noise may repeat itself for.
        limit: f64,
    },
    /// It spans less than a tenth of what the others span.
    Quiet {
        /// Its span, V.
        span_v: f64,
        /// Median of theirs, V.
        others_v: f64,
    },
}

/// The converters' steps, V: as the static record shows them, and where a channel never changes there, as its trials do.
pub fn steps_v<'a>(rest: &Trial, trials: impl Iterator<Item = &'a Trial> + Clone) -> [f64; LIMBS] {
    core::array::from_fn(|channel| {
        let own = converter_step_v(rest, channel);
        if own.is_finite() {
            return own;
        }
        let moving = trials.clone().map(|trial| converter_step_v(trial, channel));
        moving.fold(f64::INFINITY, f64::min)
    })
}

/// Channels that no earlier finding concerns.
pub fn examine(rest: &Trial, steps_v: &[f64; LIMBS], findings: &mut Vec<Finding>) {
    for (channel, still) in still(&rest.voltage_v, steps_v).into_iter().enumerate() {
        let known = findings.iter().any(|f| f.concerns(&rest.name, channel + 1));
        let evidence = match still {
            Some(Still::Run {
                value_v,
                samples,
                limit,
            }) if !known => format!(
                "{samples} of {} samples in a row are {value_v:.4} V to the last bit; noise like the other channels' repeats itself {limit:.0} times at most",
                rest.voltage_v.len()
            ),
            Some(Still::Quiet { span_v, others_v }) if !known => format!(
                "it stays within {:.3} mV, the other channels within {:.3} mV",
                1e3 * span_v,
                1e3 * others_v
            ),
            _ => continue,
        };
        let advice = format!(
            "seat the plugs of limb {}, then record at rest again",
            channel + 1
        );
        let finding = Finding::new(Cause::DeadLimb, evidence, advice);
        findings.push(finding.in_trial(rest).on_channels([channel]));
    }
}

/// What stands still in each channel of a static record, V, of converters with these steps, V.
pub fn still(voltage_v: &[[f64; LIMBS]], steps_v: &[f64; LIMBS]) -> [Option<Still>; LIMBS] {
    let samples = voltage_v.len();
    let spans_v: [f64; LIMBS] = core::array::from_fn(|channel| span_v(voltage_v, channel));
    let runs: [(f64, usize); LIMBS] =
        core::array::from_fn(|channel| longest_run(voltage_v, channel));
    // A step more or less is the rounding's; what is left of the span is the noise's.
    let by_noise_v: [f64; LIMBS] = core::array::from_fn(|i| {
        if spans_v[i] > 0.0 {
            (spans_v[i] - steps_v[i]).max(0.0)
        } else {
            0.0
        }
    });
    // Of that many Gaussian samples the largest lies about so many standard deviations out.
    let spanned = 2.0 * (2.0 * (samples.max(2) as f64).ln()).sqrt();
    core::array::from_fn(|channel| {
        let others = (0..LIMBS).filter(|other| *other != channel);
        let others_v = median(others.clone().map(|i| by_noise_v[i])).unwrap_or(0.0);
        let others_run = median(others.map(|i| runs[i].1 as f64)).unwrap_or(0.0);
        let finite = steps_v[channel].is_finite();
        let step_v = if finite {
            steps_v[channel]
        } else {
            steps_v
                .iter()
                .copied()
                .filter(|s| s.is_finite())
                .fold(0.0, f64::max)
        };
        let limit = longest_by_chance(samples, step_v, others_v / spanned).max(LONGER * others_run);
        let (value_v, run) = runs[channel];
        if run as f64 > limit {
            return Some(Still::Run {
                value_v,
                samples: run,
                limit,
            });
        }
        (QUIET * (spans_v[channel] + step_v) < others_v).then_some(Still::Quiet {
            span_v: spans_v[channel],
            others_v,
        })
    })
}

/// Samples in a row that are equal, of white noise of so many V in a converter of that step, longer than which there is a run in
/// one of nine such records once in 1 / CHANCE. At worst the zero lies in the middle of a step, and each sample stays there with
/// the probability of half a step: p. Of n samples at most n p^(L-1) begin a run of L.
fn longest_by_chance(samples: usize, step_v: f64, noise_v: f64) -> f64 {
    let out = 0.5 * step_v / noise_v;
    // Noise of 0, and NaN of it, stays for ever.
    let leaves = chi_square_tail(out * out, 1).unwrap_or(0.0);
    let stays = (-leaves).ln_1p();
    1.0 + (CHANCE / (LIMBS * samples) as f64).ln() / stays
}

fn span_v(voltage_v: &[[f64; LIMBS]], channel: usize) -> f64 {
    let (low, high) = extent(voltage_v.iter().map(|row| row[channel]));
    (high - low).max(0.0)
}

/// The first longest run of one value: that value, V, and its length.
fn longest_run(voltage_v: &[[f64; LIMBS]], channel: usize) -> (f64, usize) {
    voltage_v
        .chunk_by(|a, b| a[channel] == b[channel])
        .map(|run| (run[0][channel], run.len()))
        .fold(
            (0.0, 0),
            |longest, run| {
                if run.1 > longest.1 { run } else { longest }
            },
        )
}

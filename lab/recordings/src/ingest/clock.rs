//! Time stamps and sample rates: one rule for what a gap is, what jitter is, and when two statements of a rate differ.
//!
//! A step between two stamps is a *gap* if, rounded to whole steps, at least one sample is missing: it is longer than 1.5 usual
//! steps. A limit of 2.5 lets a single missing sample pass as jitter; every later sample then stands one step too early where
//! samples are taken as evenly spaced, and an invented value stands in the hole where they are resampled. The usual step is the
//! median of the first steps and not the stated one, so that a wrong statement of the rate is told as that and not as gaps, nor
//! the mean, which gaps lengthen.

use serde::Serialize;

use super::find::Column;
use crate::layout::Layout;

/// A step of more usual steps than this is a gap.
const GAP_STEPS: f64 = 1.5;
/// Usual step, s, below which stamps are no seconds: no converter of nine channels takes ten million samples a second.
pub const CLOSEST_S: f64 = 1e-7;
/// Of so many steps none is a gap where the stamps are a clock's: more of them are rounding.
const OFTEN: u64 = 20;
/// Gaps of which the place is kept.
pub const GAPS_KEPT: usize = 20;
/// Steps of which the median is the usual one.
const FIRST_STEPS: usize = 1 << 16;
/// Departure of a step from the even one, relative, from which samples do not stand on an even clock: a converter's clock is
/// good to 1e-4, a time column printed with a digit too few is not.
const UNEVEN: f64 = 1e-2;
/// Relative difference between two statements of one sample rate that is put down to rounding.
const STATED_TOLERANCE: f64 = 1e-6;
/// The same of a reference file's rate: ordinary quartzes are good to 1e-4 each, and the recordings tell by how much two of them differ.
const OF_QUARTZES: f64 = 200e-6;
/// Keys of a recording's rate and of its reference file's, and by how much what is stated there may differ from the file's own.
pub(super) const OWN_RATE: (&str, f64) = ("sample_rate_hz", STATED_TOLERANCE);
pub(super) const REFERENCE_RATE: (&str, f64) = ("reference_sample_rate_hz", OF_QUARTZES);
/// Relative difference between a stated rate and that of the time stamps from which the two contradict each other.
const STAMPS_TOLERANCE: f64 = 1e-3;

/// A gap in the time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gap {
    /// Sample after it.
    pub sample: u64,
    /// Its line, from 1, where it was looked up in a file of text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u64>,
    /// Time stamp before it, s.
    pub time_s: f64,
    /// From the stamp before to the stamp after, s.
    pub length_s: f64,
    /// Samples that are missing, to the nearest.
    pub missing: u64,
}

/// Statistics of the time stamps of a recording.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Stamps {
    /// Channel that holds them.
    pub channel: String,
    /// Unit they are read in, s; 1 where none is stated.
    pub unit_s: f64,
    /// First finite stamp, s.
    pub first_s: Option<f64>,
    /// Last finite stamp, s.
    pub last_s: Option<f64>,
    /// Mean step, s; gaps and steps that do not advance are left out.
    pub mean_step_s: Option<f64>,
    /// Samples per second by the mean step.
    #[serde(skip)]
    pub mean_rate_hz: Option<f64>,
    /// Root mean square of the same steps about their mean, s.
    pub jitter_rms_s: Option<f64>,
    /// Largest departure of one of them from the mean, s.
    pub jitter_max_s: Option<f64>,
    /// Steps longer than 1.5 usual ones.
    pub gaps: u64,
    /// The first twenty.
    pub first_gaps: Vec<Gap>,
    /// Samples that are missing in all gaps.
    pub missing: u64,
    /// Steps of zero or back.
    pub not_advancing: u64,
    /// Sample at the end of the first of them.
    pub first_not_advancing: Option<u64>,
    /// Stamps that are not finite.
    pub not_finite: u64,
    /// Shortest and longest of the steps that [`Self::mean_step_s`] is the mean of, s.
    #[serde(skip)]
    pub extreme_steps_s: Option<[f64; 2]>,
    /// Largest departure of a stamp from the even clock that starts with the first one, s, where [`Clock::new`] was told a
    /// rate.
    #[serde(skip)]
    pub largest_departure_s: f64,
}

/// What makes time stamps useless as a clock, at the first sample where it does.
#[derive(Debug, Clone, PartialEq)]
pub struct StampFault {
    /// The sample.
    pub sample: u64,
    /// What is wrong, and what to do.
    pub cause: String,
}

impl Stamps {
    /// Refuses a rate that the stamps contradict: by more than a part in a thousand, two clocks are two statements.
    ///
    /// # Errors
    /// A sentence, to which the caller adds the place.
    pub fn check_rate(&self, rate_hz: f64) -> Result<(), String> {
        match self.mean_rate_hz {
            Some(mean) if (mean / rate_hz - 1.0).abs() > STAMPS_TOLERANCE => Err(format!(
                "{rate_hz} Hz, but by its time stamps the recording has {mean:.3} Hz"
            )),
            _ => Ok(()),
        }
    }

    /// Whether a step departs from the even one by more than a hundredth of it.
    pub fn uneven(&self, rate_hz: f64) -> bool {
        let even = 1.0 / rate_hz;
        self.extreme_steps_s
            .is_some_and(|steps| steps.iter().any(|s| (s - even).abs() > UNEVEN * even))
    }
}

/// Takes time stamps as they come.
#[derive(Debug, Clone, Default)]
pub struct Clock {
    /// Counts so far; what is derived from sums is filled in at the end.
    stamps: Stamps,
    even_step_s: Option<f64>,
    row: u64,
    first_not_finite: Option<u64>,
    /// Usual step, s; known once the first steps have been seen.
    usual_s: Option<f64>,
    /// Sample after it, stamp before it and length of each of the first steps.
    waiting: Vec<(u64, f64, f64)>,
    steps: u64,
    /// Sum of the steps less the usual one, and of its squares.
    sum: f64,
    squares: f64,
}

impl Clock {
    /// A clock for stamps of this channel. With a rate, [`Stamps::largest_departure_s`] is held against it.
    pub fn new(time: &Column, rate_hz: Option<f64>) -> Self {
        Self {
            stamps: Stamps {
                channel: time.name.clone(),
                unit_s: time.size_si,
                ..Stamps::default()
            },
            even_step_s: rate_hz.map(|rate| 1.0 / rate),
            ..Self::default()
        }
    }

    /// Takes the next stamps, s.
    pub fn extend(&mut self, stamps_s: &[f64]) {
        for &time in stamps_s {
            let row = self.row;
            self.row += 1;
            if !time.is_finite() {
                self.stamps.not_finite += 1;
                self.first_not_finite.get_or_insert(row);
                continue;
            }
            let first = *self.stamps.first_s.get_or_insert(time);
            if let Some(step) = self.even_step_s {
                let departure = (time - (first + row as f64 * step)).abs();
                self.stamps.largest_departure_s = self.stamps.largest_departure_s.max(departure);
            }
            let Some(previous) = self.stamps.last_s.replace(time) else {
                continue;
            };
            match self.usual_s {
                Some(usual) => self.step(usual, row, previous, time - previous),
                None => {
                    self.waiting.push((row, previous, time - previous));
                    if self.waiting.len() == FIRST_STEPS {
                        self.settle();
                    }
                }
            }
        }
    }

    /// Usual step so far, s, if there is one.
    pub fn usual_step_s(&mut self) -> Option<f64> {
        self.settle();
        self.usual_s.filter(|step| *step > 0.0)
    }

    /// The first stamp so far that is not finite, does not advance or follows a gap.
    pub fn fault(&self) -> Option<StampFault> {
        let fault = |sample, cause: &str| StampFault {
            sample,
            cause: cause.to_owned(),
        };
        let not_finite = self
            .first_not_finite
            .map(|sample| fault(sample, "the time stamp is not a finite number"));
        let standing = self
            .stamps
            .first_not_advancing
            .map(|sample| fault(sample, "the time stamp does not come after the one before; if stamps are rounded too far, delete their column and state the sample rate, which does not overrule them"));
        let gap = self.stamps.first_gaps.first().map(|gap| StampFault {
            sample: gap.sample,
            cause: if OFTEN * self.stamps.gaps > self.steps && self.steps > OFTEN {
                format!(
                    "a step of {:.6} s after time {} s and as long ones in more than one place of {OFTEN}, others of {:.6} s: stamps that are rounded too far? Then delete their column and state the sample rate, which does not overrule them",
                    gap.length_s,
                    gap.time_s,
                    self.usual_s.unwrap_or_default()
                )
            } else {
                format!(
                    "a gap of {:.6} s after time {} s, in which samples are missing ({}, to the nearest); make the parts before and after it recordings of their own",
                    gap.length_s, gap.time_s, gap.missing
                )
            },
        });
        let too_close = self.usual_s.filter(|step| *step > 0.0 && *step < CLOSEST_S);
        let too_close = too_close.map(|step| StampFault {
            sample: 1,
            cause: format!(
                "the time stamps are {step:.1e} s apart: if they are days, as spreadsheets have them, or hours, say so in the heading, as in time [h], or delete their column and state the sample rate"
            ),
        });
        [not_finite, standing, gap, too_close]
            .into_iter()
            .flatten()
            .min_by_key(|fault| fault.sample)
    }

    /// Judges the steps that still wait for the usual one to be known: at the end, or where it is needed before.
    pub fn settle(&mut self) {
        if self.usual_s.is_some() || self.waiting.is_empty() {
            return;
        }
        let waiting = std::mem::take(&mut self.waiting);
        let steps = waiting.iter().map(|(.., step)| *step);
        let mut advancing: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
        let middle = advancing.len() / 2;
        // Without a step forward there is no usual step, and nothing is a gap.
        let usual = if advancing.is_empty() {
            0.0
        } else {
            *advancing.select_nth_unstable_by(middle, f64::total_cmp).1
        };
        self.usual_s = Some(usual);
        for (row, previous, step) in waiting {
            self.step(usual, row, previous, step);
        }
    }

    fn step(&mut self, usual: f64, row: u64, previous: f64, step: f64) {
        let stamps = &mut self.stamps;
        if step <= 0.0 {
            stamps.not_advancing += 1;
            stamps.first_not_advancing.get_or_insert(row);
        } else if step > GAP_STEPS * usual && usual > 0.0 {
            let gap = Gap {
                sample: row,
                line: None,
                time_s: previous,
                length_s: step,
                missing: (step / usual).round() as u64 - 1,
            };
            stamps.gaps += 1;
            stamps.missing = stamps.missing.saturating_add(gap.missing);
            if stamps.first_gaps.len() < GAPS_KEPT {
                stamps.first_gaps.push(gap);
            }
        } else {
            self.steps += 1;
            self.sum += step - usual;
            self.squares += (step - usual) * (step - usual);
            let [shortest, longest] = stamps.extreme_steps_s.get_or_insert([step; 2]);
            *shortest = shortest.min(step);
            *longest = longest.max(step);
        }
    }

    /// The statistics of all stamps taken.
    pub fn finish(mut self) -> Stamps {
        self.settle();
        let mut stamps = self.stamps;
        let (Some(usual), Some([shortest, longest])) = (self.usual_s, stamps.extreme_steps_s)
        else {
            return stamps;
        };
        let n = self.steps as f64;
        // Without a hole, first and last stamp give the mean free of the sum's rounding.
        let whole = stamps.gaps + stamps.not_advancing + stamps.not_finite == 0;
        let span = match (stamps.first_s, stamps.last_s) {
            (Some(first), Some(last)) if whole => last - first,
            _ => n * usual + self.sum,
        };
        let mean = span / n;
        let apart = self.sum / n;
        stamps.mean_step_s = Some(mean);
        stamps.mean_rate_hz = Some(n / span);
        stamps.jitter_rms_s = Some((self.squares / n - apart * apart).max(0.0).sqrt());
        stamps.jitter_max_s = Some((longest - mean).max(mean - shortest).max(0.0));
        stamps
    }
}

/// The sample rate that the file states for these channels, or else the one that somebody states beside it.
///
/// # Errors
/// A sentence, to which the caller adds the place, if two statements differ.
pub fn stated_rate_hz(
    layout: &Layout,
    columns: &[Column],
    stated: Option<f64>,
) -> Result<Option<f64>, String> {
    stated_rate_within(STATED_TOLERANCE, layout, columns, stated)
}

/// The same where two statements may differ by so much of the rate; the one beside the file counts.
pub(super) fn stated_rate_within(
    tolerance: f64,
    layout: &Layout,
    columns: &[Column],
    stated: Option<f64>,
) -> Result<Option<f64>, String> {
    let mut rate = stated;
    let mut first = None;
    for channel in columns.iter().map(|c| &layout.channels[c.index]) {
        match (rate, channel.sample_rate_hz) {
            (Some(a), Some(b)) if (a - b).abs() > tolerance * a => {
                let name = &channel.name;
                return Err(match first {
                    None => format!("{a} Hz here, but the file says {b} Hz for channel {name:?}"),
                    Some(first) => format!(
                        "the file has {a} Hz for channel {first:?} and {b} Hz for {name:?}: standards at a rate of their own are read where the \
                         file is named as reference_file, too"
                    ),
                });
            }
            (None, Some(b)) => (rate, first) = (Some(b), Some(&channel.name)),
            _ => {}
        }
    }
    Ok(rate)
}

#[cfg(test)]
mod tests;

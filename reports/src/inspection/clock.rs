//! Time stamps: rate, jitter, gaps, and where they do not advance.

use serde::Serialize;

/// A step of more than so many usual steps is a gap.
const GAP: f64 = 1.5;
/// Gaps of which the place is kept.
pub const GAPS_KEPT: usize = 20;
/// Steps of which the usual step is taken.
const FIRST_STEPS: usize = 1 << 16;

/// A hole in the time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gap {
    /// Sample after it.
    pub sample: u64,
    /// Time stamp before it, s.
    pub time_s: f64,
    /// From the stamp before to the stamp after, s.
    pub length_s: f64,
    /// Samples that are missing, to the nearest.
    pub missing: u64,
}

/// What the time stamps say.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stamps {
    /// Channel that holds them.
    pub channel: String,
    /// Unit they are read in, s; 1 where none is stated.
    pub unit_s: f64,
    /// First finite stamp, s.
    pub first_s: Option<f64>,
    /// Last finite stamp, s.
    pub last_s: Option<f64>,
    /// Mean step without gaps, s.
    pub mean_step_s: Option<f64>,
    /// Root mean square of the steps about their mean, gaps left out, s.
    pub jitter_rms_s: Option<f64>,
    /// Largest departure of a step from the mean, gaps left out, s.
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
}

/// Takes time stamps as they come.
#[derive(Debug, Clone, Default)]
pub struct Clock {
    unit_s: f64,
    row: u64,
    previous: Option<f64>,
    first: Option<f64>,
    /// Usual step, s; known once the first steps have been seen.
    usual: Option<f64>,
    waiting: Vec<(u64, f64, f64)>,
    steps: u64,
    /// Sum of steps less the usual one, and of its squares.
    sum: f64,
    squares: f64,
    shortest: f64,
    longest: f64,
    gaps: u64,
    first_gaps: Vec<Gap>,
    missing: f64,
    not_advancing: u64,
    first_not_advancing: Option<u64>,
    not_finite: u64,
}

impl Clock {
    /// Stamps in units of so many seconds.
    #[must_use]
    pub fn new(unit_s: f64) -> Self {
        Self {
            unit_s,
            shortest: f64::INFINITY,
            longest: f64::NEG_INFINITY,
            ..Self::default()
        }
    }

    /// Takes the next stamps.
    pub fn extend(&mut self, stamps: &[f64]) {
        for stamp in stamps {
            let time = stamp * self.unit_s;
            let row = self.row;
            self.row += 1;
            if !time.is_finite() {
                self.not_finite += 1;
                continue;
            }
            self.first.get_or_insert(time);
            let Some(previous) = self.previous.replace(time) else {
                continue;
            };
            let step = time - previous;
            if self.usual.is_none() {
                self.waiting.push((row, previous, step));
                if self.waiting.len() == FIRST_STEPS {
                    self.settle();
                }
            } else {
                self.step(row, previous, step);
            }
        }
    }

    /// Usual step so far, s, if there is one.
    pub fn usual_step_s(&mut self) -> Option<f64> {
        self.settle();
        self.usual.filter(|step| *step > 0.0)
    }

    fn settle(&mut self) {
        if self.usual.is_some() || self.waiting.is_empty() {
            return;
        }
        let waiting = std::mem::take(&mut self.waiting);
        let mut advancing: Vec<f64> = waiting
            .iter()
            .map(|w| w.2)
            .filter(|step| *step > 0.0)
            .collect();
        let middle = advancing.len() / 2;
        // Without a step forward there is no usual step, and nothing is a gap.
        let usual = if advancing.is_empty() {
            0.0
        } else {
            *advancing.select_nth_unstable_by(middle, f64::total_cmp).1
        };
        self.usual = Some(usual);
        for (row, previous, step) in waiting {
            self.step(row, previous, step);
        }
    }

    fn step(&mut self, row: u64, previous: f64, step: f64) {
        let usual = self.usual.unwrap_or(0.0);
        if step <= 0.0 {
            self.not_advancing += 1;
            self.first_not_advancing.get_or_insert(row);
        } else if step > GAP * usual && usual > 0.0 {
            self.gaps += 1;
            let missing = (step / usual).round() - 1.0;
            self.missing += missing;
            if self.first_gaps.len() < GAPS_KEPT {
                self.first_gaps.push(Gap {
                    sample: row,
                    time_s: previous,
                    length_s: step,
                    missing: missing as u64,
                });
            }
        } else {
            let departure = step - usual;
            self.steps += 1;
            self.sum += departure;
            self.squares += departure * departure;
            self.shortest = self.shortest.min(step);
            self.longest = self.longest.max(step);
        }
    }

    /// The answer.
    #[must_use]
    pub fn finish(mut self, channel: &str) -> Stamps {
        self.settle();
        let n = self.steps as f64;
        let usual = self.usual.filter(|step| *step > 0.0 && self.steps > 0);
        let mean = usual.map(|usual| usual + self.sum / n);
        let rms = usual.map(|_| {
            (self.squares / n - (self.sum / n) * (self.sum / n))
                .max(0.0)
                .sqrt()
        });
        let most = mean.map(|mean| (self.longest - mean).max(mean - self.shortest).max(0.0));
        Stamps {
            channel: channel.to_owned(),
            unit_s: self.unit_s,
            first_s: self.first,
            last_s: self.previous,
            mean_step_s: mean,
            jitter_rms_s: rms,
            jitter_max_s: most,
            gaps: self.gaps,
            first_gaps: self.first_gaps,
            missing: self.missing as u64,
            not_advancing: self.not_advancing,
            first_not_advancing: self.first_not_advancing,
            not_finite: self.not_finite,
        }
    }
}

//! Runs of equal samples: a channel that stands still to the last bit while the others of its recording move.

/// Samples that stand still for a channel to have failed, at least, and times its second longest run.
const FEWEST: u64 = 64;
const TIMES: u64 = 8;
/// Part of the recording that it stands still for at either end, at least: a coarse converter may hold a channel there for as long as the
/// sensor is at rest, and not the others.
const AT_AN_END: u64 = 4;

/// Consecutive samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Run {
    /// The first of them, from 0.
    pub first: u64,
    /// Their number.
    pub samples: u64,
}

impl Run {
    fn shared_with(&self, other: &Self) -> u64 {
        let end = (self.first + self.samples).min(other.first + other.samples);
        end.saturating_sub(self.first.max(other.first))
    }
}

/// The runs of one channel, sample by sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Runs {
    samples: u64,
    changes: u64,
    last: f64,
    present: Run,
    longest: Run,
    second: u64,
}

impl Runs {
    /// Of a whole channel.
    pub fn of(samples: impl IntoIterator<Item = f64>) -> Self {
        let mut runs = Self::default();
        for x in samples {
            runs.push(x);
        }
        runs
    }

    /// Takes the next sample.
    #[inline]
    pub fn push(&mut self, x: f64) {
        if self.samples > 0 && x.to_bits() == self.last.to_bits() {
            self.present.samples += 1;
        } else {
            self.changes += u64::from(self.samples > 0);
            self.present = Run {
                first: self.samples,
                samples: 1,
            };
        }
        if self.present.first == self.longest.first {
            self.longest = self.present;
        } else if self.present.samples > self.longest.samples {
            self.second = self.longest.samples;
            self.longest = self.present;
        } else {
            self.second = self.second.max(self.present.samples);
        }
        self.last = x;
        self.samples += 1;
    }

    /// Where it stands still, if noise or motion moves it elsewhere from nearly every sample to the next.
    fn still(&self) -> Option<Run> {
        let run = self.longest;
        let outside = self.samples - run.samples;
        let moves = outside >= FEWEST && 2 * self.changes >= outside;
        let at_an_end = run.first == 0 || run.first + run.samples == self.samples;
        let long = !at_an_end || AT_AN_END * run.samples >= self.samples;
        let failed = moves && long && run.samples >= FEWEST.max(TIMES * self.second);
        failed.then_some(run)
    }

    /// Whether it moves meanwhile: at rest a coarse converter holds every channel.
    fn moves_during(&self, run: &Run) -> bool {
        2 * self.changes >= self.samples && 2 * self.longest.shared_with(run) < run.samples
    }
}

/// Where one of several channels side by side stands still while more than half of the others, and two at least, move.
pub fn stands_still(all: &[Runs], channel: usize) -> Option<Run> {
    let run = all.get(channel)?.still()?;
    let others = all.iter().enumerate().filter(|(at, _)| *at != channel);
    let moving = others.filter(|(_, other)| other.moves_during(&run)).count();
    (moving >= 2 && 2 * moving > all.len() - 1).then_some(run)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: usize = 1000;

    /// Noise of a converter: no sample is the one before.
    fn moving(at: usize, channel: usize) -> f64 {
        ((at * 7 + channel * 3) % 11) as f64
    }

    fn day(holds: impl Fn(usize, usize) -> bool) -> Vec<Runs> {
        let of = |channel: usize| {
            Runs::of((0..SAMPLES).map(|at| {
                if holds(at, channel) {
                    2.5
                } else {
                    moving(at, channel)
                }
            }))
        };
        (0..9).map(of).collect()
    }

    #[test]
    fn one_channel_that_stands_still_is_told_with_its_samples() {
        for (from, to) in [(300, 600), (0, 500), (700, SAMPLES)] {
            let all = day(|at, channel| channel == 4 && (from..to).contains(&at));
            let expected = Run {
                first: from as u64,
                samples: (to - from) as u64,
            };
            assert_eq!(stands_still(&all, 4), Some(expected));
            assert!(
                (0..9)
                    .filter(|c| *c != 4)
                    .all(|c| stands_still(&all, c).is_none())
            );
        }
    }

    #[test]
    fn rests_of_all_channels_constants_and_coarse_converters_are_not() {
        let rest = day(|at, _| at < 300);
        assert!((0..9).all(|channel| stands_still(&rest, channel).is_none()));
        let coarse_at_rest = day(|at, channel| channel == 4 && at < 200);
        assert_eq!(stands_still(&coarse_at_rest, 4), None);
        let constant = day(|_, channel| channel == 4);
        assert_eq!(stands_still(&constant, 4), None);
        // Each value stands for ten samples: that it once does for twenty is nothing.
        let mut coarse = day(|_, _| false);
        coarse[4] = Runs::of((0..SAMPLES).map(|at| (at / 80) as f64));
        assert_eq!(stands_still(&coarse, 4), None);
    }
}

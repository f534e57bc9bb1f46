//! Whether a recorder hung: all channels stand still to the last bit in mid-motion, or are filled up with a constant.

use std::path::Path;

/// Samples of one value from which on they are told.
const FEWEST: u64 = 50;
/// Steps of a channel, over its smallest one, by which it jumps into or out of such a stretch: a sensor at rest on a coarse converter
/// comes to stand still by single steps. Without a converter or noise it does so by ever smaller ones.
const JUMP: f64 = 8.0;
/// The least that such a jump has of the largest step.
const OF_LARGEST: f64 = 0.05;
/// Samples from which a channel's smallest and largest steps are taken.
const LEARNT_FROM: u64 = 1 << 14;

/// Stretches in which all channels stand still.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Frozen {
    /// The last two rows.
    last: [Vec<f64>; 2],
    /// Smallest step of each channel that is one, and the largest.
    steps: Vec<[f64; 2]>,
    /// Samples that are like the one before them, up to the last row.
    run: u64,
    /// Whether the stretch began with a jump.
    jumped_in: bool,
    samples: u64,
    /// First sample and length of the longest stretch.
    longest: Option<(u64, u64)>,
    stretches: u64,
}

impl Frozen {
    /// Takes the next samples of the channels that are read, column by column.
    pub fn look(&mut self, columns: &[&[f64]]) {
        let count = columns.first().map_or(0, |column| column.len());
        let [older, newer] = &mut self.last;
        older.resize(columns.len(), f64::NAN);
        newer.resize(columns.len(), f64::NAN);
        self.steps.resize(columns.len(), [f64::INFINITY, 0.0]);
        if self.samples < LEARNT_FROM {
            for (column, extremes) in columns.iter().zip(&mut self.steps) {
                let steps = column.windows(2).map(|pair| (pair[1] - pair[0]).abs());
                *extremes = steps
                    .filter(|step| *step > 0.0)
                    .fold(*extremes, |[low, high], step| {
                        [low.min(step), high.max(step)]
                    });
            }
        }
        // Nearly all samples are told by the first channel alone.
        for sample in 0..count {
            let at = |back: usize, channel: usize| match sample.checked_sub(back) {
                Some(sample) => columns[channel][sample],
                None => self.last[1 - (back - sample - 1)][channel],
            };
            let still = (0..columns.len()).all(|channel| at(0, channel) == at(1, channel));
            if !still && self.run == 0 {
                self.samples += 1;
                continue;
            }
            let jumps = |back: usize| {
                let mut channels = (0..columns.len()).zip(&self.steps);
                channels.any(|(channel, [smallest, largest])| {
                    let step = (at(back, channel) - at(back + 1, channel)).abs();
                    step > (JUMP * smallest).max(OF_LARGEST * largest)
                })
            };
            match (still, self.run) {
                (true, 0) => (self.jumped_in, self.run) = (jumps(1), 1),
                (true, _) => self.run += 1,
                (false, _) => {
                    let jumps_out = jumps(0);
                    self.end(jumps_out);
                }
            }
            self.samples += 1;
        }
        for back in [2, 1] {
            if let Some(sample) = count.checked_sub(back) {
                self.last[2 - back] = columns.iter().map(|column| column[sample]).collect();
            } else if count == 1 {
                self.last.swap(0, 1);
            }
        }
    }

    fn end(&mut self, jumps_out: bool) {
        if self.run + 1 >= FEWEST && (self.jumped_in || jumps_out) {
            self.stretches += 1;
            let length = self.run + 1;
            if self.longest.is_none_or(|(_, longest)| length > longest) {
                self.longest = Some((self.samples - length, length));
            }
        }
        self.run = 0;
    }

    /// What is to be said when the recording has ended.
    pub fn warning(&self, path: &Path, sample_rate_hz: f64) -> Option<String> {
        let mut all = self.clone();
        all.end(false);
        let (first, length) = all.longest?;
        let [from_s, to_s] = [first, first + length].map(|sample| sample as f64 / sample_rate_hz);
        let more = match all.stretches {
            1 => String::new(),
            stretches => format!(", and {} more such stretches", stretches - 1),
        };
        Some(format!(
            "{}: from {from_s:.3} s to {to_s:.3} s after its first sample all channels stand still to the last bit{more}: did the recorder hang, or fill up what it had not? What is decoupled there is no motion",
            path.display()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(change: impl Fn(usize) -> Option<usize>) -> bool {
        let at = |sample: usize, limb: usize| {
            let t = sample as f64 / 500.0;
            (2.0 * (9.0 * t + limb as f64).sin() / 1e-3).round() * 1e-3
        };
        let columns: Vec<Vec<f64>> = (0..9)
            .map(|limb| {
                let value = |sample| change(sample).map_or(0.0, |sample| at(sample, limb));
                (0..1000).map(value).collect()
            })
            .collect();
        let mut frozen = Frozen::default();
        for piece in [0..300, 300..1000] {
            let part: Vec<&[f64]> = columns.iter().map(|c| &c[piece.clone()]).collect();
            frozen.look(&part);
        }
        frozen.warning(Path::new("a.csv"), 500.0).is_some()
    }

    #[test]
    fn a_recorder_that_hangs_is_told_and_a_rest_is_not() {
        assert!(!told(Some));
        // It hangs for 0.2 s across two blocks, at the end, or what is left is zeros.
        assert!(told(|s| Some(if (250..350).contains(&s) {
            250
        } else {
            s
        })));
        assert!(told(|s| Some(s.min(900))));
        assert!(told(|s| (s < 800).then_some(s)));
        // Shorter than anyone would notice.
        assert!(!told(|s| Some(if (250..280).contains(&s) {
            250
        } else {
            s
        })));
    }
}

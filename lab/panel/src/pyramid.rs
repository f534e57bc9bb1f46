//! The last minutes of one column in bounded memory, for drawing at any zoom: samples of the last seconds, and smallest and
//! largest sample of bins of 16, 64, 256 ... samples for longer.

/// Samples in a bin of the lowest level, and bins of a level in one of the next.
pub const BASE: u64 = 16;
const FACTOR: u64 = 4;
/// Levels above the samples.
const LEVELS: usize = 6;

/// Smallest and largest of some samples. NaN is passed over; of nothing else there is no extent.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Extent {
    min: f32,
    max: f32,
}

impl Extent {
    const NONE: Self = Self {
        min: f32::INFINITY,
        max: f32::NEG_INFINITY,
    };

    fn take(&mut self, value: f32) {
        if value < self.min {
            self.min = value;
        }
        if value > self.max {
            self.max = value;
        }
    }

    fn merge(&mut self, other: Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// As two numbers, NaN of nothing.
    fn pair(self) -> [f32; 2] {
        if self.min <= self.max {
            [self.min, self.max]
        } else {
            [f32::NAN; 2]
        }
    }
}

/// Complete bins of one width in a ring, and what is in the bin that is not complete of the level below.
#[derive(Debug, Clone)]
struct Level {
    bins: Vec<Extent>,
    open: Extent,
}

/// One column's history.
#[derive(Debug, Clone)]
pub struct Pyramid {
    samples: Vec<f32>,
    levels: Vec<Level>,
    count: u64,
}

/// Where the bins of an answer are: bin k holds samples from `first + k step` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    /// First sample of the first bin, a multiple of `step`.
    pub first: u64,
    /// Samples in a bin.
    pub step: u64,
    /// Bins.
    pub bins: usize,
}

impl Grid {
    /// Bins for samples `first..last` on about so many points, on multiples of their own width, so that the edges do not move
    /// while time goes on.
    pub fn covering(first: u64, last: u64, points: usize) -> Self {
        let span = last.saturating_sub(first).max(1);
        let wanted = (span / points.max(1) as u64).max(1);
        let step = if wanted < BASE {
            wanted
        } else {
            wanted / width(level_of(wanted)) * width(level_of(wanted))
        };
        let first = first / step * step;
        Self {
            first,
            step,
            bins: (last.saturating_sub(first)).div_ceil(step) as usize,
        }
    }
}

/// Samples in a bin of a level.
const fn width(level: usize) -> u64 {
    BASE * FACTOR.pow(level as u32)
}

/// The highest level whose bins are not wider than so many samples.
fn level_of(samples: u64) -> usize {
    (0..LEVELS)
        .rev()
        .find(|level| width(*level) <= samples)
        .unwrap_or(0)
}

/// Memory of a history that keeps so many samples whole and so many as bins, bytes.
pub const fn bytes(samples: usize, binned: usize) -> usize {
    // Each level has a quarter of the bins of the one below: 4/3 in all.
    4 * samples + 8 * binned / BASE as usize * 4 / 3
}

impl Pyramid {
    /// Keeps `samples` samples whole and `binned` in bins.
    pub fn new(samples: usize, binned: usize) -> Self {
        let level = |level| Level {
            bins: vec![Extent::NONE; (binned / width(level) as usize).max(1)],
            open: Extent::NONE,
        };
        Self {
            samples: vec![0.0; samples.max(1)],
            levels: (0..LEVELS).map(level).collect(),
            count: 0,
        }
    }

    /// Samples taken so far.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Takes a sample.
    pub fn push(&mut self, value: f32) {
        let kept = self.samples.len() as u64;
        self.samples[(self.count % kept) as usize] = value;
        self.count += 1;
        let Some(first) = self.levels.first_mut() else {
            return;
        };
        first.open.take(value);
        for level in 0..self.levels.len() {
            if !self.count.is_multiple_of(width(level)) {
                break;
            }
            let done = std::mem::replace(&mut self.levels[level].open, Extent::NONE);
            let bins = &mut self.levels[level].bins;
            let at = ((self.count / width(level) - 1) % bins.len() as u64) as usize;
            bins[at] = done;
            if let Some(next) = self.levels.get_mut(level + 1) {
                next.open.merge(done);
            }
        }
    }

    /// Appends smallest and largest sample of each bin; NaN where nothing is kept, or all samples are NaN.
    pub fn draw(&self, grid: &Grid, out: &mut Vec<f32>) {
        let oldest_whole = self.count.saturating_sub(self.samples.len() as u64);
        let whole = grid.step < BASE && grid.first >= oldest_whole;
        for bin in 0..grid.bins as u64 {
            let from = grid.first + bin * grid.step;
            let to = (from + grid.step).min(self.count);
            let extent = if whole {
                self.of_samples(from, to)
            } else {
                self.of_bins(from, to, level_of(grid.step))
            };
            out.extend(extent.pair());
        }
    }

    fn of_samples(&self, from: u64, to: u64) -> Extent {
        let mut extent = Extent::NONE;
        for at in from..to {
            extent.take(self.samples[(at % self.samples.len() as u64) as usize]);
        }
        extent
    }

    /// Of all bins of a level that begin in `from..to`, or hold `from`; the last may not be complete.
    fn of_bins(&self, from: u64, to: u64, level: usize) -> Extent {
        let (wide, bins) = (width(level), &self.levels[level].bins);
        let complete = self.count / wide;
        let oldest = complete.saturating_sub(bins.len() as u64);
        let mut extent = Extent::NONE;
        if from >= to {
            return extent;
        }
        for bin in (from / wide).max(oldest)..to.div_ceil(wide) {
            if bin < complete {
                extent.merge(bins[(bin % bins.len() as u64) as usize]);
            } else {
                for level in &self.levels[..=level] {
                    extent.merge(level.open);
                }
            }
        }
        extent
    }

    /// The last samples that are kept whole, oldest first, at most so many.
    pub fn last(&self, samples: usize) -> Vec<f64> {
        let kept = self.samples.len().min(samples) as u64;
        (self.count.saturating_sub(kept)..self.count)
            .map(|at| f64::from(self.samples[(at % self.samples.len() as u64) as usize]))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of a small generator, some of them NaN.
    fn series(samples: usize) -> Vec<f32> {
        let mut state = 12345_u64;
        (0..samples)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                let value = (state >> 40) as f32 / 1000.0 - 8000.0;
                if state.is_multiple_of(97) {
                    f32::NAN
                } else {
                    value
                }
            })
            .collect()
    }

    fn brute_force(values: &[f32]) -> [f32; 2] {
        let finite = || values.iter().copied().filter(|v| !v.is_nan());
        match finite().next() {
            None => [f32::NAN; 2],
            Some(_) => [
                finite().fold(f32::INFINITY, f32::min),
                finite().fold(f32::NEG_INFINITY, f32::max),
            ],
        }
    }

    fn same(a: f32, b: f32) -> bool {
        a == b || (a.is_nan() && b.is_nan())
    }

    #[test]
    fn law_every_bin_is_what_brute_force_finds() {
        let values = series(70_001);
        let mut pyramid = Pyramid::new(5_000, 80_000);
        let mut checked = 0;
        for (k, value) in values.iter().enumerate() {
            pyramid.push(*value);
            if k % 7_919 != 7_918 && k + 1 != values.len() {
                continue;
            }
            let count = k as u64 + 1;
            for (first, last, points) in [
                (0, count, 10),
                (0, count, 300),
                (count / 3, count / 2, 17),
                (count.saturating_sub(3_000), count, 900),
                (count.saturating_sub(3_000), count + 500, 250),
                (count - 1, count, 5),
            ] {
                let grid = Grid::covering(first, last, points);
                let mut drawn = Vec::new();
                pyramid.draw(&grid, &mut drawn);
                assert_eq!(drawn.len(), 2 * grid.bins);
                // Bins of samples that are no longer whole are drawn from bins of 16, which may reach beyond a bin.
                let exact = grid.step >= BASE || grid.first + 5_000 >= count;
                for bin in 0..grid.bins {
                    let from = grid.first as usize + bin * grid.step as usize;
                    let to = (from + grid.step as usize).min(values.len()).min(k + 1);
                    let expected = brute_force(values.get(from..to).unwrap_or_default());
                    let got = [drawn[2 * bin], drawn[2 * bin + 1]];
                    if exact {
                        assert!(
                            same(got[0], expected[0]) && same(got[1], expected[1]),
                            "{grid:?} bin {bin}: {got:?}, {expected:?}"
                        );
                    } else {
                        assert!(
                            got[0] <= expected[0] && got[1] >= expected[1],
                            "{grid:?} bin {bin}"
                        );
                    }
                    checked += 1;
                }
            }
        }
        assert!(checked > 5_000, "{checked} bins");
    }

    #[test]
    fn law_what_has_left_the_ring_is_nan() {
        let mut pyramid = Pyramid::new(100, 1_600);
        (0..10_000).for_each(|k| pyramid.push(k as f32));
        let mut drawn = Vec::new();
        pyramid.draw(&Grid::covering(0, 1_600, 10), &mut drawn);
        assert!(drawn.iter().all(|v| v.is_nan()));
        drawn.clear();
        pyramid.draw(
            &Grid {
                first: 9_600,
                step: 64,
                bins: 1,
            },
            &mut drawn,
        );
        assert_eq!(drawn, [9_600.0, 9_663.0]);
        assert_eq!(pyramid.last(3), [9_997.0, 9_998.0, 9_999.0]);
    }

    #[test]
    fn inv_memory_is_what_is_stated() {
        let pyramid = Pyramid::new(300_000, 6_000_000);
        let held = 4 * pyramid.samples.capacity()
            + pyramid
                .levels
                .iter()
                .map(|l| 8 * l.bins.capacity())
                .sum::<usize>();
        assert!(held <= bytes(300_000, 6_000_000), "{held}");
    }
}

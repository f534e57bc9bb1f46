//! Flat tops: a converter at its end repeats itself to the last bit.

use super::facts::FlatTop;
use super::resolution::Resolution;

/// Equal extreme samples in a row that make a flat top.
const FLAT_TOP: u64 = 4;
/// A flat top is no news in a channel that spans no more than so many converter steps.
const STEPS_SPANNED: f64 = 64.0;
/// Where the step below a flat top is wider than so many converter steps, the signal did not come to a stop by itself.
const STEEP: f64 = 2.5;
/// A rounded sine stands at its last step for up to 2.41 times as long as at the step before.
const TIMES_NEXT: u64 = 4;
/// Relative distance from a round number: a converter's last code is one step short of it.
const ROUND: f64 = 1e-3;
/// Heads of round numbers.
const HEADS: [f64; 5] = [1.0, 1.25, 2.0, 2.5, 5.0];

/// Largest value so far, how often it came and in what runs; and the next one below it.
///
/// Exact in one pass: a value that ends up among the two largest was so from its first sample on.
#[derive(Debug, Clone, Copy)]
pub struct Extreme {
    value: f64,
    count: u64,
    run: u64,
    longest: u64,
    first: u64,
    last: u64,
    next: f64,
    next_count: u64,
}

impl Default for Extreme {
    fn default() -> Self {
        Self {
            value: f64::NEG_INFINITY,
            count: 0,
            run: 0,
            longest: 0,
            first: 0,
            last: 0,
            next: f64::NEG_INFINITY,
            next_count: 0,
        }
    }
}

impl Extreme {
    /// Takes a finite sample.
    #[inline]
    pub fn push(&mut self, x: f64, row: u64) {
        if x < self.next {
            return;
        }
        if x > self.value {
            self.next = self.value;
            self.next_count = self.count;
            self.value = x;
            self.count = 1;
            self.run = 1;
            self.longest = 1;
            self.first = row;
            self.last = row;
        } else if x == self.value {
            self.count += 1;
            self.run = if self.last + 1 == row {
                self.run + 1
            } else {
                1
            };
            self.longest = self.longest.max(self.run);
            self.last = row;
        } else if x > self.next {
            self.next = x;
            self.next_count = 1;
        } else {
            self.next_count += 1;
        }
    }

    /// Largest value; minus infinity before the first.
    pub const fn value(&self) -> f64 {
        self.value
    }

    /// The flat top, if it is one. `span` is the channel's range, `whole` that all its values are whole numbers; `sign` is -1
    /// for an extreme that was fed with the negated samples.
    pub fn flat(
        &self,
        span: f64,
        resolution: &Resolution,
        whole: bool,
        sign: f64,
    ) -> Option<FlatTop> {
        if self.longest < FLAT_TOP || self.next_count == 0 {
            return None;
        }
        let round = is_round_limit(self.value, whole);
        let flat = match resolution.grid_step() {
            None => true,
            Some(step) => {
                span >= STEPS_SPANNED * step
                    && (round
                        || self.value - self.next > STEEP * step
                        || self.count >= TIMES_NEXT * self.next_count + FLAT_TOP)
            }
        };
        flat.then_some(FlatTop {
            value: sign * self.value,
            samples: self.count,
            longest_run: self.longest,
            first_sample: self.first,
            at_round_limit: round,
        })
    }
}

/// Whether converters end there.
fn is_round_limit(value: f64, whole: bool) -> bool {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() {
        return false;
    }
    if whole {
        let power = (size + 1.0).log2();
        if size >= 127.0 && (power.fract() == 0.0 || size.log2().fract() == 0.0) {
            return true;
        }
    }
    let head = size / 10f64.powf(size.log10().floor());
    HEADS
        .iter()
        .chain(&[10.0])
        .any(|round| (head - round).abs() <= ROUND * round)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn top(values: &[f64], step: Option<f64>) -> Option<FlatTop> {
        let mut extreme = Extreme::default();
        let mut least = f64::INFINITY;
        for (row, x) in values.iter().enumerate() {
            extreme.push(*x, row as u64);
            least = least.min(*x);
        }
        let resolution = Resolution {
            smallest_step: step,
            on_grid: step.is_some(),
        };
        extreme.flat(extreme.value() - least, &resolution, false, 1.0)
    }

    #[test]
    fn clipped_sine_has_a_flat_top_and_a_rounded_one_has_not() {
        let sine = |k: usize| 9.3 * (k as f64 * 1e-3).sin();
        let step = 20.0 / 65_536.0;
        let rounded: Vec<f64> = (0..20_000)
            .map(|k| (sine(k) / step).round() * step)
            .collect();
        // Slow enough to stand at its last step for many samples.
        let most = rounded.iter().copied().fold(0.0, f64::max);
        assert!(rounded.iter().filter(|x| **x == most).count() > 10);
        assert_eq!(top(&rounded, Some(step)), None);
        let clipped: Vec<f64> = rounded.iter().map(|x| x.min(8.3)).collect();
        let found = top(&clipped, Some(step)).expect("flat");
        assert_eq!(found.value, 8.3);
        assert_eq!(
            found.samples,
            rounded.iter().filter(|x| **x >= 8.3).count() as u64
        );
        assert!(!found.at_round_limit);
        assert_eq!(
            found.first_sample,
            rounded.iter().position(|x| *x >= 8.3).expect("there") as u64
        );
    }

    #[test]
    fn round_limits() {
        for (value, whole) in [
            (10.0, false),
            (-9.999_7, false),
            (2.5, false),
            (0.2, false),
            (32_767.0, true),
            (-8_388_608.0, true),
            (5000.0, false),
        ] {
            assert!(is_round_limit(value, whole), "{value}");
        }
        for (value, whole) in [
            (8.3, false),
            (9.9, false),
            (32_767.0, false),
            (30_000.0, true),
            (0.0, true),
        ] {
            assert!(!is_round_limit(value, whole), "{value}");
        }
    }
}

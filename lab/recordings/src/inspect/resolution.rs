//! Smallest step of a channel, and whether all its values stand on a grid of such steps.

/// Samples kept, evenly over the recording.
const KEPT: usize = 4096;
/// A difference of so many units in the last place is rounding.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Distance from the grid, in steps, within which a value stands on it. By chance two values in five would.
const ON_GRID: f64 = 0.2;
/// Share of the values that must stand on it.
const SHARE: f64 = 0.99;
/// A range of more bits is no converter's.
const MOST_BITS: f64 = 32.0;
/// Distinct values of which a grid is told.
const FEWEST: usize = 3;

/// What is found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Resolution {
    /// Smallest difference of two samples.
    pub smallest_step: Option<f64>,
    /// All values stand on a grid of that step.
    pub on_grid: bool,
}

impl Resolution {
    /// The grid's step, if there is one.
    pub fn grid_step(&self) -> Option<f64> {
        self.smallest_step.filter(|_| self.on_grid)
    }
}

/// Takes samples as they come.
#[derive(Debug, Clone)]
pub struct Steps {
    smallest: f64,
    previous: f64,
    kept: Vec<f64>,
    stride: u64,
}

impl Default for Steps {
    fn default() -> Self {
        Self {
            smallest: f64::INFINITY,
            previous: f64::NAN,
            kept: Vec::new(),
            stride: 1,
        }
    }
}

impl Steps {
    /// Takes a finite sample.
    #[inline]
    pub fn push(&mut self, x: f64, row: u64) {
        let step = (x - self.previous).abs();
        if step < self.smallest && step > ROUNDING * x.abs().max(self.previous.abs()) {
            self.smallest = step;
        }
        self.previous = x;
        if row & (self.stride - 1) == 0 {
            self.keep(x);
        }
    }

    fn keep(&mut self, x: f64) {
        self.kept.push(x);
        if self.kept.len() == KEPT {
            keep_every_second(&mut self.kept);
            self.stride *= 2;
        }
    }

    /// The answer.
    pub fn finish(mut self) -> Resolution {
        self.kept.sort_unstable_by(f64::total_cmp);
        self.kept
            .dedup_by(|a, b| (*a - *b).abs() <= ROUNDING * a.abs().max(b.abs()));
        let smallest = self
            .kept
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .fold(self.smallest, f64::min);
        if !smallest.is_finite() {
            return Resolution::default();
        }
        // The smallest step that was seen may be a small multiple of the grid's.
        for part in 1..=4 {
            if let Some(step) = grid(&self.kept, smallest / f64::from(part)) {
                return Resolution {
                    smallest_step: Some(step),
                    on_grid: true,
                };
            }
        }
        Resolution {
            smallest_step: Some(smallest),
            on_grid: false,
        }
    }
}

/// Keeps the first, the third and so on.
pub(super) fn keep_every_second(values: &mut Vec<f64>) {
    let mut second = false;
    values.retain(|_| {
        second = !second;
        second
    });
}

/// The step, refined, if the ascending values stand on a grid of it.
fn grid(ascending: &[f64], step: f64) -> Option<f64> {
    let (&first, &last) = (ascending.first()?, ascending.last()?);
    if ascending.len() < FEWEST || (last - first) / step > MOST_BITS.exp2() {
        return None;
    }
    // A step from two neighbours is uncertain by their rounding; each value that fits makes it more certain, and so the next,
    // farther one can be placed.
    let mut refined = step;
    let mut off = 0usize;
    for value in &ascending[1..] {
        let steps = ((value - first) / refined).round();
        if steps < 1.0 || ((value - first) - steps * refined).abs() > ON_GRID * refined {
            off += 1;
        } else {
            refined = (value - first) / steps;
        }
    }
    let most = (ascending.len() as f64 * (1.0 - SHARE)) as usize;
    (off <= most && (refined / step - 1.0).abs() < ON_GRID).then_some(refined)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(values: impl Iterator<Item = f64>) -> Resolution {
        let mut steps = Steps::default();
        for (row, x) in values.enumerate() {
            steps.push(x, row as u64);
        }
        steps.finish()
    }

    #[test]
    fn converter_is_found_and_a_smooth_signal_has_none() {
        let signal = |k: usize| 7.0 * (k as f64 * 0.0137).sin() + 0.3 * (k as f64 * 1.77).cos();
        let step = 20.0 / 65_536.0;
        let volts = found((0..50_000).map(|k| (signal(k) / step).round() * step));
        assert!(volts.on_grid);
        assert!((volts.smallest_step.expect("step") / step - 1.0).abs() < 1e-9);
        // The same numbers as f32, as many recorders store them.
        let single =
            found((0..50_000).map(|k| f64::from(((signal(k) / step).round() * step) as f32)));
        assert!(single.on_grid);
        assert!((single.smallest_step.expect("step") / step - 1.0).abs() < 1e-4);
        assert!(!found((0..50_000).map(signal)).on_grid);
        assert_eq!(found([3.0; 10].into_iter()), Resolution::default());
    }
}

//! All columns of the last minutes.

use crate::columns::COLUMNS;
use crate::pyramid::{Grid, Pyramid, bytes};

/// Time that is kept for drawing, and with every sample, s.
pub const KEPT_S: f64 = 600.0;
const WHOLE_S: f64 = 20.0;
/// Memory at most, bytes: beyond 10 kHz less time is kept.
const MOST_BYTES: usize = 250 << 20;

/// Columns side by side.
pub struct History {
    columns: Vec<Pyramid>,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Time that is kept, s.
    pub kept_s: f64,
}

impl History {
    /// Nothing yet.
    pub fn new(sample_rate_hz: f64) -> Self {
        let samples = |time_s: f64| (time_s * sample_rate_hz) as usize;
        let needed = COLUMNS * bytes(samples(WHOLE_S), samples(KEPT_S));
        let share = (MOST_BYTES as f64 / needed as f64).min(1.0);
        let column = || Pyramid::new(samples(WHOLE_S * share), samples(KEPT_S * share));
        Self {
            columns: (0..COLUMNS).map(|_| column()).collect(),
            sample_rate_hz,
            kept_s: KEPT_S * share,
        }
    }

    /// Samples so far.
    pub fn count(&self) -> u64 {
        self.columns.first().map_or(0, Pyramid::count)
    }

    /// Takes a sample of all columns.
    pub fn push(&mut self, row: &[f32; COLUMNS]) {
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.push(*value);
        }
    }

    /// Appends the bins of a column; nothing for one that is not there.
    pub fn draw(&self, column: usize, grid: &Grid, out: &mut Vec<f32>) {
        if let Some(pyramid) = self.columns.get(column) {
            pyramid.draw(grid, out);
        }
    }

    /// The last samples of a column.
    pub fn last(&self, column: usize, samples: usize) -> Vec<f64> {
        self.columns
            .get(column)
            .map_or_else(Vec::new, |pyramid| pyramid.last(samples))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inv_ten_minutes_at_ten_kilohertz_fit() {
        let samples = |time_s: f64| (time_s * 1e4) as usize;
        assert!(COLUMNS * bytes(samples(WHOLE_S), samples(KEPT_S)) <= MOST_BYTES);
        assert_eq!(History::new(2_000.0).kept_s, KEPT_S);
        assert!(History::new(50_000.0).kept_s < KEPT_S);
    }
}

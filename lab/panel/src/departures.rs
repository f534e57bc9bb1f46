//! How far the decoupled accelerations are from the truth of a simulated laboratory, in one run.

use serde::Serialize;

/// An axis that moves less than this share of the largest of its three has no error relative to its peak.
const MOVES: f64 = 0.1;
/// Accelerations, m/s^2 and rad/s^2, below which nothing moves.
const STANDS_STILL: f64 = 1e-2;

/// How far an axis has been from the truth.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct AxisError {
    /// Largest departure, m/s^2 or rad/s^2.
    pub departure: f64,
    /// The same over the axis' peak; none for an axis that the run does not move.
    pub share: Option<f64>,
}

/// Peaks of the truth and largest departures from it, of three linear and three angular accelerations.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Departures {
    peaks: [f64; 6],
    largest: [f64; 6],
}

impl Departures {
    /// Takes a sample and its truth.
    pub fn push(&mut self, value: &[f64; 6], truth: &[f64; 6]) {
        for axis in 0..6 {
            self.peaks[axis] = self.peaks[axis].max(truth[axis].abs());
            self.largest[axis] = self.largest[axis].max((value[axis] - truth[axis]).abs());
        }
    }

    /// The errors so far; none while nothing has moved.
    #[must_use]
    pub fn errors(&self) -> Option<[AxisError; 6]> {
        let largest = |first: usize| {
            let three = &self.peaks[first..first + 3];
            three.iter().copied().fold(0.0, f64::max)
        };
        let peaks = [largest(0), largest(3)];
        peaks.iter().any(|peak| *peak >= STANDS_STILL).then(|| {
            core::array::from_fn(|axis| {
                let (departure, peak) = (self.largest[axis], self.peaks[axis]);
                let moves = peak >= STANDS_STILL.max(MOVES * peaks[axis / 3]);
                AxisError {
                    departure,
                    share: moves.then(|| departure / peak),
                }
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_an_axis_at_rest_has_no_relative_error() {
        let mut departures = Departures::default();
        assert_eq!(departures.errors(), None);
        departures.push(&[0.1, 0.0, 0.0, 0.0, 0.0, 0.0], &[0.0; 6]);
        assert_eq!(departures.errors(), None);
        departures.push(
            &[9.0, 0.5, 0.0, 0.2, 0.0, 0.0],
            &[10.0, 0.0, 2.0, 0.0, 0.0, 0.0],
        );
        let errors = departures.errors().expect("it has moved");
        let shares = errors.map(|error| error.share);
        assert_eq!(shares, [Some(0.1), None, Some(1.0), None, None, None]);
        assert_eq!(errors[3].departure, 0.2);
    }
}

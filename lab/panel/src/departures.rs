//! How far decoupled motion is from what it is held against in one run: the truth of a simulated laboratory, or the reference
//! instruments.

use serde::Serialize;

/// An axis that moves less than this share of the largest of its kind has no error relative to its peak.
const MOVES: f64 = 0.1;
/// Accelerations, m/s^2 and rad/s^2, or a rate, rad/s, below which nothing moves.
const STANDS_STILL: f64 = 1e-2;

/// How far an axis has been off.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct AxisError {
    /// Largest departure, m/s^2, rad/s^2 or rad/s.
    pub departure: f64,
    /// The same over the axis' peak; none for an axis that the run does not move.
    pub share: Option<f64>,
}

/// Peaks of what is right and largest departures from it, of `N` axes: half of them linear, half angular.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departures<const N: usize> {
    peaks: [f64; N],
    largest: [f64; N],
}

impl<const N: usize> Default for Departures<N> {
    fn default() -> Self {
        Self {
            peaks: [0.0; N],
            largest: [0.0; N],
        }
    }
}

impl<const N: usize> Departures<N> {
    /// Takes a sample and what is right.
    pub fn push(&mut self, value: &[f64; N], truth: &[f64; N]) {
        for axis in 0..N {
            self.peaks[axis] = self.peaks[axis].max(truth[axis].abs());
            self.largest[axis] = self.largest[axis].max((value[axis] - truth[axis]).abs());
        }
    }

    /// The errors so far; none while nothing has moved.
    pub fn errors(&self) -> Option<[AxisError; N]> {
        let (linear, angular) = self.peaks.split_at(N / 2);
        let peaks = [linear, angular].map(|kind| kind.iter().copied().fold(0.0, f64::max));
        peaks.iter().any(|peak| *peak >= STANDS_STILL).then(|| {
            core::array::from_fn(|axis| {
                let (departure, peak) = (self.largest[axis], self.peaks[axis]);
                let moves = peak >= STANDS_STILL.max(MOVES * peaks[2 * axis / N]);
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
        let mut departures = Departures::<6>::default();
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

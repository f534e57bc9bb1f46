//! What a hypothesis leaves of the rows: noise, or more than that.
//!
//! Mean, slope and the energy of the rest of a stretch are looked at each by itself, so that a constant failure far below the noise
//! of a sample counts as much as a burst. Calibration's errors are the same in all samples of a stretch and may add several of their
//! standard deviations.

use super::calibration_errors::CalibrationErrors;
use super::noise::{RowNoise, apply, dot};
use super::window::{Parts, Window};
use crate::float::sqrt;
use crate::redundancy::parity::ROWS;

/// Standard deviations of a sum of squares up to which there is but noise, with room for the skewness of few, and of calibration's
/// errors.
const NOISE: f64 = 5.0;
const SKEWNESS: f64 = 20.0;
const ERRORS: f64 = 4.0;
/// Length of two coefficients of noise beyond which one pair in a thousand is.
const ALONG: f64 = 3.72;
/// Standard deviations of a sum of squares beyond which there is more.
pub(super) const MORE: f64 = 8.0;

/// A stretch of rows, to which hypotheses are held.
pub(super) struct Misfit<'a> {
    noise: &'a RowNoise,
    window: &'a Window,
    added: Option<Parts<[[f64; ROWS]; ROWS]>>,
}

impl<'a> Misfit<'a> {
    pub fn new(
        noise: &'a RowNoise,
        window: &'a Window,
        errors: Option<&CalibrationErrors>,
    ) -> Self {
        Self {
            noise,
            window,
            added: errors.map(|errors| window.errors(noise, errors)),
        }
    }

    fn added_along(&self, direction: &[f64; ROWS]) -> Parts<f64> {
        let along = |m: &[[f64; ROWS]; ROWS]| dot(direction, &apply(m, direction));
        self.added.as_ref().map_or(NOTHING, |added| Parts {
            mean: along(&added.mean),
            slope: along(&added.slope),
            rest: along(&added.rest),
        })
    }

    fn added(&self) -> Parts<f64> {
        let trace = |m: &[[f64; ROWS]; ROWS]| m[0][0] + m[1][1] + m[2][2];
        self.added.as_ref().map_or(NOTHING, |added| Parts {
            mean: trace(&added.mean),
            slope: trace(&added.slope),
            rest: trace(&added.rest),
        })
    }

    fn is_quiet(&self, left: Parts<f64>, added: Parts<f64>, rows: usize) -> bool {
        let rest = self.window.rows.samples().saturating_sub(2) as f64;
        let rows = rows as f64;
        left.mean < limit(rows, added.mean)
            && left.slope < limit(rows, added.slope)
            && left.rest < limit(rows * rest, added.rest)
    }

    /// Whether the rows are noise.
    pub fn is_quiet_everywhere(&self) -> bool {
        self.is_quiet(self.window.all(), self.added(), self.noise.relations())
    }

    /// Whether the rows are noise along a unit vector.
    pub fn is_quiet_along(&self, direction: &[f64; ROWS]) -> bool {
        self.is_quiet(self.window.along(direction), self.added_along(direction), 1)
    }

    /// Relations that a failure along a unit vector leaves.
    pub const fn rows_beside(&self) -> usize {
        self.noise.relations().saturating_sub(1)
    }

    /// Whether the rows less a failure along a unit vector, of whatever course, are noise.
    pub fn is_quiet_beside(&self, direction: &[f64; ROWS]) -> bool {
        let left = less(self.window.all(), self.window.along(direction));
        let added = less(self.added(), self.added_along(direction));
        let rows = self.rows_beside();
        rows == 0 || self.is_quiet(left, added, rows)
    }

    /// Whether nothing of the rows beside a failure along a unit vector goes along with its course. A disturbance of many channels, as
    /// mains hum, has a direction of its own, and leaves noise beside one nearby for as long as it is small.
    pub fn is_all_along(&self, direction: &[f64; ROWS]) -> bool {
        let along = self.window.along(direction);
        let turned = self.window.turned_from(direction);
        let added = less(self.added(), self.added_along(direction));
        let stays = |left: f64, added: f64| {
            let root = ALONG + ERRORS * sqrt(added);
            left < root * root
        };
        self.noise.relations() < 2
            || stays(turned.mean, added.mean)
                && stays(turned.slope, added.slope)
                && (along.rest <= 0.0 || stays(turned.rest / along.rest, added.rest))
    }

    /// What calibration's errors may add to a sum of squares beside a unit vector.
    pub fn allowed_beside(&self, direction: &[f64; ROWS]) -> f64 {
        let added = less(self.added(), self.added_along(direction));
        ERRORS * ERRORS * (added.mean + added.slope + added.rest)
    }

    /// Whether a sum of squares of all rows is noise.
    pub fn is_noise(&self, energy: f64) -> bool {
        let n = self.window.rows.samples() as f64 * self.noise.relations() as f64;
        let added = self.added();
        energy < limit(n, added.mean + added.slope + added.rest)
    }

    /// Whether the rows are far beyond noise along a unit vector, and whether what mean and slope leave of them is.
    pub fn is_loud_along(&self, direction: &[f64; ROWS]) -> [bool; 2] {
        let (along, added) = (self.window.along(direction), self.added_along(direction));
        let n = self.window.rows.samples() as f64;
        let beyond = |energy: f64, added: f64| {
            let root = sqrt(n + MORE * sqrt(2.0 * n)) + ERRORS * sqrt(added);
            energy > root * root
        };
        [
            beyond(
                along.mean + along.slope + along.rest,
                added.mean + added.slope + added.rest,
            ),
            beyond(along.rest, added.rest),
        ]
    }
}

fn less(all: Parts<f64>, along: Parts<f64>) -> Parts<f64> {
    Parts {
        mean: (all.mean - along.mean).max(0.0),
        slope: (all.slope - along.slope).max(0.0),
        rest: (all.rest - along.rest).max(0.0),
    }
}

const NOTHING: Parts<f64> = Parts {
    mean: 0.0,
    slope: 0.0,
    rest: 0.0,
};

/// The largest sum of squares of n coefficients that is noise and calibration's errors.
pub(super) fn limit(n: f64, added: f64) -> f64 {
    let root = sqrt(n + NOISE * sqrt(2.0 * n) + SKEWNESS) + ERRORS * sqrt(added.max(0.0));
    root * root
}

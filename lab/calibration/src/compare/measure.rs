//! The figures of a comparison.

use anyhow::Result;
use glam::DQuat;
use serde::Serialize;

use super::aligned::{Aligned, Passed};
use super::quantile::Coarse;
use super::track::{ACCELERATIONS, Motion};
use sixaxis_recordings::envelope::Envelope;

/// Format of the figures as a file.
pub const FORMAT: &str = "sixaxis-comparison-2";

/// Shares of all instants whose errors are given, beside the largest.
pub const SHARES: [f64; 3] = [0.5, 0.9, 0.99];

/// Peak over the largest of its three, below which an axis hardly moves and its relative error is left out.
const HARDLY: f64 = 1e-3;

/// A kind of quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Linear acceleration, ground axes, m/s^2.
    Linear,
    /// Angular acceleration, ground axes, rad/s^2.
    Angular,
    /// Angular rate, shell axes, rad/s.
    Rate,
}

impl Quantity {
    /// All of them, in the order of a motion's columns.
    pub const ALL: [Self; 3] = [Self::Linear, Self::Angular, Self::Rate];

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Linear => "m/s^2",
            Self::Angular => "rad/s^2",
            Self::Rate => "rad/s",
        }
    }
}

/// One axis, in SI units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// Name of the column.
    pub name: String,
    /// What it is.
    pub quantity: Quantity,
    /// Unit of the figures below.
    pub unit: &'static str,
    /// Largest magnitude of the truth.
    pub peak: f64,
    /// Largest magnitude of the difference.
    pub largest_error: f64,
    /// Where that is, s.
    pub largest_error_time_s: f64,
    /// Root mean square of the difference.
    pub rms_error: f64,
    /// Mean of the difference, result less truth.
    pub mean_error: f64,
    /// Magnitudes that 50, 90 and 99 % of the differences do not exceed.
    pub error_quantiles: [f64; 3],
    /// Largest error over the peak, %: the paper's figure. None where the axis hardly moves.
    pub largest_error_percent: Option<f64>,
}

impl Axis {
    /// A figure of this axis over its peak, %.
    pub fn percent(&self, figure: f64) -> Option<f64> {
        self.largest_error_percent
            .is_some()
            .then(|| 100.0 * figure / self.peak)
    }
}

/// A comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// [`FORMAT`].
    pub format: &'static str,
    /// File of the result.
    pub result: String,
    /// File of the truth.
    pub truth: String,
    /// Common instants.
    pub instants: u64,
    /// Further ones that are left out, since the attitude is not known there: all ground axes are NaN.
    pub unknown_instants: u64,
    /// Further ones of the result, and of the truth, after the other's last.
    pub beyond_instants: [u64; 2],
    /// The first of them, s.
    pub start_s: f64,
    /// Common instants per second.
    pub rate_hz: f64,
    /// Six accelerations, and three rates where both have them.
    pub axes: Vec<Axis>,
    /// Largest angle between the two attitudes, deg, where both have one.
    pub largest_attitude_error_deg: Option<f64>,
    /// What a picture needs, for each axis, in its unit.
    #[serde(skip)]
    pub pictures: Vec<Picture>,
}

impl Comparison {
    /// What is left out, in words that follow upon the number of instants, with its number as `written`; empty if nothing is.
    pub fn left_out(&self, written: impl Fn(u64) -> String) -> String {
        match self.unknown_instants {
            0 => String::new(),
            unknown => format!(
                ", {} more left out where the attitude is not known,",
                written(unknown)
            ),
        }
    }

    /// That one of the two goes on for more than a hundredth of what they have in common.
    pub fn of_unequal_length(&self) -> Option<String> {
        let common = self.instants + self.unknown_instants;
        let files = [&self.result, &self.truth];
        let longer = files.into_iter().zip(self.beyond_instants);
        let (name, beyond) = longer.max_by_key(|(_, beyond)| *beyond)?;
        (100 * beyond > common).then(|| {
            format!("{name} goes on for {beyond} more instants after the other's end: see that both are of one run")
        })
    }
}

/// Curves of one axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// The truth.
    pub truth: Envelope,
    /// The result.
    pub result: Envelope,
    /// Result less truth.
    pub error: Envelope,
}

#[derive(Default)]
struct Sums {
    peak: f64,
    largest: f64,
    largest_time_s: f64,
    squares: f64,
    sum: f64,
    counted: Coarse,
    picture: Picture,
}

/// First column of the attitude.
const ATTITUDE: usize = 9;

/// A rate or a time without what a mean of time stamps in text leaves of rounding.
pub fn to_a_millionth(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}

/// Compares in two passes: figures and curves, then quantiles.
///
/// # Errors
/// Those of reading; motions that have no instant in common.
pub fn compare(aligned: &mut Aligned, result: String, truth: String) -> Result<Comparison> {
    let axes = if aligned.has(ACCELERATIONS..ATTITUDE) {
        ATTITUDE
    } else {
        ACCELERATIONS
    };
    let attitude = aligned.has(ATTITUDE..ATTITUDE + 4);
    let mut all: Vec<Sums> = (0..axes).map(|_| Sums::default()).collect();
    let mut turned = 0.0_f64;
    let Passed {
        count: instants,
        unknown: unknown_instants,
        beyond: beyond_instants,
    } = aligned.each(|time_s, result, truth| {
        for (axis, sums) in all.iter_mut().enumerate() {
            let (r, t) = (result[axis], truth[axis]);
            let error = r - t;
            sums.peak = sums.peak.max(t.abs());
            if error.abs() > sums.largest {
                (sums.largest, sums.largest_time_s) = (error.abs(), time_s);
            }
            sums.squares += error * error;
            sums.sum += error;
            sums.counted.count(error);
            sums.picture.truth.push(time_s, t);
            sums.picture.result.push(time_s, r);
            sums.picture.error.push(time_s, error);
        }
        if attitude {
            turned = turned.max(angle_between(result, truth));
        }
    })?;
    let mut fine: Vec<_> = all.iter().map(|s| s.counted.refine(&SHARES)).collect();
    aligned.each(|_, result, truth| {
        for (axis, fine) in fine.iter_mut().enumerate() {
            fine.count(result[axis] - truth[axis]);
        }
    })?;
    let peaks: Vec<f64> = all.iter().map(|sums| sums.peak).collect();
    let mut measured = Vec::new();
    let mut pictures = Vec::new();
    for (axis, (sums, fine)) in all.into_iter().zip(fine).enumerate() {
        let quantity = Quantity::ALL[axis / 3];
        let largest_peak = peaks[axis / 3 * 3..axis / 3 * 3 + 3]
            .iter()
            .fold(0.0_f64, |a, b| a.max(*b));
        let moves = sums.peak > HARDLY * largest_peak;
        let quantiles = fine.quantiles();
        measured.push(Axis {
            name: sixaxis_recordings::motion::MOTION_CHANNELS[axis]
                .0
                .to_owned(),
            quantity,
            unit: quantity.unit(),
            peak: sums.peak,
            largest_error: sums.largest,
            largest_error_time_s: sums.largest_time_s,
            rms_error: (sums.squares / instants as f64).sqrt(),
            mean_error: sums.sum / instants as f64,
            // Given as upper ends of short stretches: none may exceed the largest.
            error_quantiles: core::array::from_fn(|i| quantiles[i].min(sums.largest)),
            largest_error_percent: moves.then(|| 100.0 * sums.largest / sums.peak),
        });
        pictures.push(sums.picture);
    }
    Ok(Comparison {
        format: FORMAT,
        result,
        truth,
        instants,
        unknown_instants,
        beyond_instants,
        start_s: aligned.start_s,
        rate_hz: aligned.rate_hz,
        axes: measured,
        largest_attitude_error_deg: attitude.then(|| turned.to_degrees()),
        pictures,
    })
}

/// Angle between two attitudes, rad.
fn angle_between(a: &Motion, b: &Motion) -> f64 {
    let quaternion = |m: &Motion| DQuat::from_xyzw(m[10], m[11], m[12], m[9]).normalize();
    let between = quaternion(a).inverse() * quaternion(b);
    // From the vector part: the scalar part is blind to small angles.
    2.0 * between.xyz().length().atan2(between.w.abs())
}

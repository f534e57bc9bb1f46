//! What an ordinary laboratory leaves open beside what its certificates say, and how far.
//!
//! Nobody measures how unequal nine limbs are, how much of its neighbour a channel shows, or where the sensor's centre is
//! against the axis. Each of these is an unknown with a spread; and a spread that nobody states is itself estimated, by the
//! expectation-maximisation step
//!
//! ```text
//! sigma^2 = (sum (x_j^2 + var x_j) + nu sigma_0^2)/(n + nu)
//! ```
//!
//! of the marginal likelihood, x_j and var x_j being what the fit says of the n unknowns of a kind; sigma_0 is what is usual and
//! counts as much as nu of them. A clean laboratory's intervals stay as narrow as its data make them, and a rough one's grow.

use nalgebra::DVector;

use crate::float::{exp, ln, sqrt};

/// Power of a spread's change that is taken: above 1 the steps overreach, which from 2 on they would not outlive.
const OVERREACH: f64 = 1.6;

/// Standard deviation of unknowns of one kind: the usual one and how many of them it is worth. 0 holds them at 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// sigma_0.
    pub usual: f64,
    /// nu.
    pub worth: f64,
}

impl Spread {
    /// Unknowns that are held.
    pub const NONE: Self = Self {
        usual: 0.0,
        worth: 0.0,
    };

    /// The next sigma from what the fit says of the unknowns: values and variances.
    pub(super) fn next(self, found: impl Iterator<Item = (f64, f64)>) -> f64 {
        if self.usual == 0.0 {
            return 0.0;
        }
        let (sum, count) = found.fold((0.0, 0.0), |(sum, count), (x, variance)| {
            (sum + x * x + variance, count + 1.0)
        });
        let squares = sum + self.worth * self.usual * self.usual;
        sqrt(squares / (count + self.worth))
    }
}

/// The room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Room {
    /// Stiffnesses of the limbs about their mean, relative.
    pub stiffness: Spread,
    /// Share of another limb's force that a channel shows.
    pub cross_talk: Spread,
    /// Sensitivity of a channel in one trial about its usual one, relative.
    pub sensitivity: Spread,
    /// Zero of a channel in one trial about that of the static record, V.
    pub zero_v: f64,
    /// From the axis to the sensor's centre in each of two directions, m.
    pub centre_m: f64,
    /// Gravity in the sensor about what the session says, in each of two directions, rad.
    pub plumb_rad: f64,
}

impl Room {
    /// Nothing is open.
    pub const NONE: Self = Self {
        stiffness: Spread::NONE,
        cross_talk: Spread::NONE,
        sensitivity: Spread::NONE,
        zero_v: 0.0,
        centre_m: 0.0,
        plumb_rad: 0.0,
    };

    /// An ordinary laboratory. Zero, centre and plumb line are told by each trial to far below these.
    pub const ORDINARY: Self = Self {
        stiffness: Spread {
            usual: 2e-3,
            worth: 1.0,
        },
        cross_talk: Spread {
            usual: 1e-4,
            worth: 1.0,
        },
        sensitivity: Spread {
            usual: 1e-4,
            worth: 4.0,
        },
        zero_v: 1.0,
        centre_m: 5e-3,
        plumb_rad: 0.02,
    };
}

/// Standard deviations as the fit has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spreads {
    /// See [`Room::stiffness`].
    pub stiffness: f64,
    /// See [`Room::cross_talk`].
    pub cross_talk: f64,
    /// See [`Room::sensitivity`].
    pub sensitivity: f64,
    /// Of each of a wedge's angles, rad.
    pub wedge_rad: f64,
}

impl Spreads {
    /// From these past others: each times its ratio to a power. A ratio beyond e is taken as it is: overreached, the first guess of
    /// a spread would leave it so small that other unknowns take up what is this kind's, and none would return from there.
    pub(super) fn toward(&self, next: &Self) -> Self {
        let of = |from: f64, to: f64| {
            if from == 0.0 {
                return from;
            }
            let change = ln(to / from);
            let power = if change.abs() < 1.0 { OVERREACH } else { 1.0 };
            from * exp(power * change)
        };
        Self {
            stiffness: of(self.stiffness, next.stiffness),
            cross_talk: of(self.cross_talk, next.cross_talk),
            sensitivity: of(self.sensitivity, next.sensitivity),
            wedge_rad: of(self.wedge_rad, next.wedge_rad),
        }
    }

    /// Largest relative change.
    pub(super) fn change(&self, other: &Self) -> f64 {
        let pairs = [
            (self.stiffness, other.stiffness),
            (self.cross_talk, other.cross_talk),
            (self.sensitivity, other.sensitivity),
            (self.wedge_rad, other.wedge_rad),
        ];
        pairs
            .into_iter()
            .filter(|(a, _)| *a > 0.0)
            .map(|(a, b)| (b / a - 1.0).abs())
            .fold(0.0, f64::max)
    }
}

/// Values and variances of a range of unknowns.
pub(super) fn found<'a>(
    range: core::ops::Range<usize>,
    values: &'a DVector<f64>,
    variance: &'a DVector<f64>,
) -> impl Iterator<Item = (f64, f64)> + 'a {
    range.map(|u| (values[u], variance[u]))
}

//! What an ordinary laboratory leaves open beside what its certificates say, and how far.
//!
//! Nobody measures how unequal nine limbs are, how much of its neighbour a channel shows, or where the sensor's centre is
//! against the axis. Each of these is an unknown with a spread; and a spread that nobody states is itself estimated: the marginal
//! likelihood is stationary where
//!
//! ```text
//! sigma^2 = (sum x_j^2 + nu sigma_0^2)/(sum (1 - var x_j/sigma^2) + nu)
//! ```
//!
//! x_j and var x_j being what the fit says of the unknowns of a kind; sigma_0 is what is usual and counts as much as nu of them. The
//! sum below is how many of them the data determine, and with sigma there taken from the step before, this is the fixed point iteration
//! (MacKay, 1992) that gets there. A clean laboratory's intervals stay as narrow as its data make them, and a rough one's grow.

use nalgebra::DVector;

use super::Joint;
use super::unknowns::{BESIDE, OTHERS};
use crate::error::{Result, require_positive};
use crate::float::sqrt;

/// What changes one way all day scatters about its mean by its change over the root of twelve, and at either end is half the change, the
/// root of three times that, away from it. The fit is nearer the morning than the mean is, since linear trials come first and tell the scale
/// factors: the evening, and what follows, is farther off.
const NEXT: f64 = 2.0;

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

    /// The next sigma from the present one and what the fit with that says of the unknowns: values and variances.
    pub(super) fn next(self, sigma: f64, found: impl Iterator<Item = (f64, f64)>) -> f64 {
        if self.usual == 0.0 {
            return 0.0;
        }
        let (sum, determined) = found.fold((0.0, 0.0), |(sum, determined), (x, variance)| {
            let open = f64::min(variance / (sigma * sigma), 1.0);
            (sum + x * x, determined + 1.0 - open)
        });
        let squares = sum + self.worth * self.usual * self.usual;
        sqrt(squares / (determined + self.worth))
    }
}

/// The room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Room {
    /// Stiffnesses of the limbs about their mean, relative.
    pub stiffness: Spread,
    /// Share of a limb's force that the channel beside its own shows: [`Unknowns::are_side_by_side`](super::unknowns::Unknowns::are_side_by_side).
    pub cross_talk_beside: Spread,
    /// Share that any other channel shows.
    pub cross_talk_apart: Spread,
    /// Sensitivity of a channel in one trial about its usual one, relative.
    pub sensitivity: Spread,
    /// Zero of a channel in one trial about that of the static record, V.
    pub zero_v: f64,
    /// From the axis to the mass's centre in each of two directions, m.
    pub centre_m: f64,
    /// From the cube's centre to the mass's along each axis, m; 0 holds it there.
    pub mass_centre_m: f64,
    /// Half a limb's mass over the seismic mass, about none; 0 takes limbs to have none.
    pub rod_mass: f64,
    /// Gravity in the sensor about what the session says, in each of two directions, rad.
    pub plumb_rad: f64,
}

impl Room {
    /// Nothing is open.
    pub const NONE: Self = Self {
        stiffness: Spread::NONE,
        cross_talk_beside: Spread::NONE,
        cross_talk_apart: Spread::NONE,
        sensitivity: Spread::NONE,
        zero_v: 0.0,
        centre_m: 0.0,
        mass_centre_m: 0.0,
        rod_mass: 0.0,
        plumb_rad: 0.0,
    };

    /// An ordinary laboratory, the mass's centre being the cube's and the limbs without mass. Zero, centre off the axis and plumb line are told by each trial to far below these.
    pub const ORDINARY: Self = Self {
        stiffness: Spread {
            usual: 2e-3,
            worth: 1.0,
        },
        cross_talk_beside: Spread {
            usual: 1e-4,
            worth: 1.0,
        },
        cross_talk_apart: Spread {
            usual: 1e-5,
            worth: 1.0,
        },
        sensitivity: Spread {
            usual: 1e-4,
            worth: 4.0,
        },
        zero_v: 1.0,
        centre_m: 5e-3,
        mass_centre_m: 0.0,
        rod_mass: 0.0,
        plumb_rad: 0.02,
    };
}

impl Joint {
    /// Frees the mass's centre, which then is the cube's to this standard deviation along each axis, m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a deviation that is none.
    pub fn free_mass_centre(&mut self, deviation_m: f64) -> Result<()> {
        require_positive("room.mass_centre_m", deviation_m)?;
        self.certificates.room.mass_centre_m = deviation_m;
        Ok(())
    }

    /// The same of half a limb's mass over the seismic mass, which then is none to this standard deviation.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a deviation that is none.
    pub fn free_rod_mass(&mut self, deviation: f64) -> Result<()> {
        require_positive("room.rod_mass", deviation)?;
        self.certificates.room.rod_mass = deviation;
        Ok(())
    }
}

/// Standard deviations as the fit has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spreads {
    /// See [`Room::stiffness`].
    pub stiffness: f64,
    /// See [`Room::cross_talk_beside`].
    pub cross_talk_beside: f64,
    /// See [`Room::cross_talk_apart`].
    pub cross_talk_apart: f64,
    /// See [`Room::sensitivity`].
    pub sensitivity: f64,
    /// Of each of a wedge's angles, rad.
    pub wedge_rad: f64,
}

impl Spreads {
    /// Of all shares of other limbs' forces that channels show, whether side by side or apart: a root mean square.
    #[must_use]
    pub fn cross_talk(&self) -> f64 {
        let of = |sigma: f64, channels: usize| channels as f64 / OTHERS as f64 * sigma * sigma;
        let apart = of(self.cross_talk_apart, OTHERS - BESIDE);
        sqrt(of(self.cross_talk_beside, BESIDE) + apart)
    }

    /// Standard deviation of what a sensitivity is off in a recording before or after all trials, relative: twice its scatter.
    #[must_use]
    pub fn next_sensitivity(&self) -> f64 {
        NEXT * self.sensitivity
    }

    /// Largest relative change.
    pub(super) fn change(&self, other: &Self) -> f64 {
        let pairs = [
            (self.stiffness, other.stiffness),
            (self.cross_talk_beside, other.cross_talk_beside),
            (self.cross_talk_apart, other.cross_talk_apart),
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

/// Values and variances of some unknowns.
pub(super) fn found(
    unknowns: impl Iterator<Item = usize>,
    values: &DVector<f64>,
    variance: &DVector<f64>,
) -> impl Iterator<Item = (f64, f64)> {
    unknowns.map(|u| (values[u], variance[u]))
}

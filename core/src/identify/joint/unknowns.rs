//! The common unknowns of all trials as one vector: the 25 parameters, then those of the instruments and the rig.
//!
//! Instead of s_i/m its reciprocal stands here, and instead of k/m the compliance 1/(k/m): the voltages are linear in both, so
//! that a scale factor of any sign and a stiffness that the data leave open have finite estimates.

use alloc::vec::Vec;

use glam::{DMat3, DVec3};
use nalgebra::DVector;

use crate::geometry::LIMBS;
use crate::model::InertiaPerMass;

/// d_1 to d_9, V.
pub const DRIFT: usize = 0;
/// m/s_1 to m/s_9, kg.
pub const MASS_PER_SCALE: usize = DRIFT + LIMBS;
/// I1 to I6 over m, m^2.
pub const INERTIA: usize = MASS_PER_SCALE + LIMBS;
/// 1/(k/m), s^2.
pub const COMPLIANCE: usize = INERTIA + 6;
/// Reading over truth of the standard accelerometer, less one.
pub const ACCELEROMETER_GAIN: usize = COMPLIANCE + 1;
/// Reading over truth of the standard gyroscope, less one.
pub const GYROSCOPE_GAIN: usize = ACCELEROMETER_GAIN + 1;
/// Lag of the standard gyroscope, s.
pub const GYROSCOPE_LAG: usize = GYROSCOPE_GAIN + 1;
/// Corner of the charge amplifiers' high-pass, rad/s: one over their time constant.
pub const AMPLIFIER_CORNER: usize = GYROSCOPE_LAG + 1;
/// From the cube's centre to that of its mass, sensor axes, m.
pub const MASS_CENTRE: usize = AMPLIFIER_CORNER + 1;
/// Half a limb's mass over the seismic mass.
pub const ROD_MASS: usize = MASS_CENTRE + 3;
/// k_i/k of the nine limbs, less one.
pub const STIFFNESS: usize = ROD_MASS + 1;
/// Share of each other limb's force that a channel shows, channel by channel: [`Unknowns::cross_talk`].
pub const CROSS_TALK: usize = STIFFNESS + LIMBS;
/// [`ANGLES`] angles for each wedge, rad, by which it misses its direction. Behind them, where they are free, nine delays, s:
/// [`Unknowns::delay`].
pub const WEDGES: usize = CROSS_TALK + LIMBS * OTHERS;
/// Limbs beside one.
pub const OTHERS: usize = LIMBS - 1;
/// Channels beside one: the one before and the one after, the first being beside the last.
pub const BESIDE: usize = 2;
/// Angles of a wedge.
pub const ANGLES: usize = 2;

/// What trials in one direction share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wedges {
    /// Their wedge.
    #[default]
    Shared,
    /// Nothing: each stands in a direction of its own.
    Apart,
}

/// A wedge: the direction it is meant to set, and two directions square to it along which it may be off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wedge {
    /// Unit vector of travel and axis, sensor axes at rest.
    pub nominal: DVec3,
    /// Where its two angles lead.
    pub sideways: [DVec3; 2],
}

impl Wedge {
    pub(super) fn new(nominal: DVec3) -> Self {
        let (a, b) = nominal.any_orthonormal_pair();
        Self {
            nominal,
            sideways: [a, b],
        }
    }
}

/// The vector of unknowns and which of them are free.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknowns {
    /// Values in the order of this file's constants.
    pub values: DVector<f64>,
    /// The wedges that the vector ends with.
    pub wedges: Vec<Wedge>,
}

impl Unknowns {
    /// Number of unknowns, free or not.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Never: there are always the 25.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// I/m.
    #[must_use]
    pub fn inertia(&self) -> InertiaPerMass {
        InertiaPerMass::from_paper_order(core::array::from_fn(|j| self.values[INERTIA + j]))
    }

    /// First of a wedge's angles.
    #[must_use]
    pub fn angles(&self, wedge: usize) -> usize {
        WEDGES + ANGLES * wedge
    }

    /// Place of the time by which a channel is behind the standards, s; none in a fit that takes all channels to be on their clock.
    #[must_use]
    pub fn delay(&self, limb: usize) -> Option<usize> {
        let at = self.angles(self.wedges.len()) + limb;
        (at < self.len()).then_some(at)
    }

    /// Direction that a wedge truly sets, and its derivatives by the first two of its angles.
    #[must_use]
    pub fn direction(&self, wedge: usize) -> (DVec3, [DVec3; 2]) {
        let Wedge { nominal, sideways } = self.wedges[wedge];
        let at = self.angles(wedge);
        let long = nominal + sideways[0] * self.values[at] + sideways[1] * self.values[at + 1];
        let length = long.length();
        let n = long / length;
        (n, sideways.map(|b| (b - n * n.dot(b)) / length))
    }

    /// From the cube's centre to that of its mass, sensor axes, m.
    #[must_use]
    pub fn mass_centre_m(&self) -> DVec3 {
        DVec3::from_array(core::array::from_fn(|j| self.values[MASS_CENTRE + j]))
    }

    /// k_i/k.
    #[must_use]
    pub fn stiffness_ratio(&self) -> [f64; LIMBS] {
        core::array::from_fn(|i| 1.0 + self.values[STIFFNESS + i])
    }

    /// Place of the share of limb `from`'s force that channel `into` shows, which is another limb's.
    #[must_use]
    pub const fn cross_talk(into: usize, from: usize) -> usize {
        CROSS_TALK + OTHERS * into + if from < into { from } else { from - 1 }
    }

    /// Whether two channels are next to each other in cable and converter, the first and the last as well.
    #[must_use]
    pub const fn are_side_by_side(into: usize, from: usize) -> bool {
        (into + 1) % LIMBS == from || (from + 1) % LIMBS == into
    }

    /// Places of the shares that channels show of limbs whose channels are beside them, or apart.
    pub(super) fn shares_of(beside: bool) -> impl Iterator<Item = usize> {
        let pairs = (0..LIMBS).flat_map(|into| (0..LIMBS).map(move |from| (into, from)));
        pairs
            .filter(move |&(into, from)| {
                into != from && Self::are_side_by_side(into, from) == beside
            })
            .map(|(into, from)| Self::cross_talk(into, from))
    }

    /// What the channels show of limb forces: their own and a share of every other one.
    #[must_use]
    pub fn shown(&self, forces: &[f64; LIMBS]) -> [f64; LIMBS] {
        core::array::from_fn(|into| {
            let others = (0..LIMBS).filter(|from| *from != into);
            let share = |from: usize| self.values[Self::cross_talk(into, from)] * forces[from];
            forces[into] + others.map(share).sum::<f64>()
        })
    }
}

/// Derivative of the inertia tensor by its entry `j`, paper order.
pub(super) fn inertia_entry(j: usize) -> DMat3 {
    let mut unit = [0.0; 6];
    unit[j] = 1.0;
    InertiaPerMass::from_paper_order(unit).matrix_mass_m2()
}

//! The common unknowns of all trials as one vector: the 25 parameters, then those of the instruments and the rig.
//!
//! Instead of s_i/m its reciprocal stands here, and instead of k/m the compliance 1/(k/m): the voltages are linear in both, so
//! that a scale factor of any sign and a stiffness that the data leave open have finite estimates.

use alloc::vec::Vec;

use glam::{DMat3, DQuat, DVec3};
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
/// [`ANGLES`] angles for each wedge, rad: two by which it misses its direction, and one about that direction, which only turning
/// gravity makes observable.
pub const WEDGES: usize = AMPLIFIER_CORNER + 1;
/// Angles of a wedge.
pub const ANGLES: usize = 3;

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

    /// Gravity in the sensor on a wedge that carries it along when it misses its direction, and its derivatives by the three
    /// angles. These are those of small angles.
    #[must_use]
    pub fn gravity(&self, wedge: usize, nominal_m_s2: DVec3) -> (DVec3, [DVec3; ANGLES]) {
        let (n, sideways) = self.direction(wedge);
        let carried = DQuat::from_rotation_arc(self.wedges[wedge].nominal, n);
        let about = DQuat::from_axis_angle(n, self.values[self.angles(wedge) + 2]);
        let g = about * (carried * nominal_m_s2);
        let by = |b: DVec3| n.cross(b).cross(g);
        (g, [by(sideways[0]), by(sideways[1]), n.cross(g)])
    }
}

/// Derivative of the inertia tensor by its entry `j`, paper order.
pub(super) fn inertia_entry(j: usize) -> DMat3 {
    let mut unit = [0.0; 6];
    unit[j] = 1.0;
    InertiaPerMass::from_paper_order(unit).matrix_mass_m2()
}

//! The chosen relative motion, and what the limbs make of it.

use glam::{DMat3, DQuat, DVec3};
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::{Geometry, LIMBS, Parameters};
use sixaxis_reference::smooth_step::smooth_step;

use super::curve::{Rotation, Scalar, Vector};

/// Harmonics in each axis.
pub const HARMONICS: usize = 2;

/// One harmonic of the relative motion: A cos + B sin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// A and B of the relative position, shell axes, m.
    pub position_m: [DVec3; 2],
    /// A and B of the relative angles about x, y and z, in this order of rotation, rad.
    pub angle_rad: [DVec3; 2],
}

/// A sensor whose mass moves in its shell along sums of sines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Manufactured {
    /// Drawing.
    pub geometry: Geometry,
    /// True parameters.
    pub parameters: Parameters,
    /// Gravity, ground axes, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// Relative motion.
    pub harmonics: [Harmonic; HARMONICS],
    /// Time over which the harmonics are let in smoothly, s; 0: they are there from the start.
    pub rise_s: f64,
}

/// The relative motion at one instant, and the resultant of the limb forces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// r, shell axes, m.
    pub position: Vector,
    /// R_r, mass axes to shell axes.
    pub rotation: Rotation,
    /// Limb forces per mass, positive in compression, m/s^2.
    pub force_per_mass_m_s2: [f64; LIMBS],
    /// Their resultant on the mass, mass axes, m/s^2.
    pub force_mass_m_s2: DVec3,
    /// Their moment about the mass's centre, mass axes, m^2/s^2.
    pub torque_mass_m2_s2: DVec3,
}

impl Manufactured {
    /// Highest frequency in the relative motion, Hz.
    pub fn highest_frequency_hz(&self) -> f64 {
        self.harmonics
            .iter()
            .map(|h| h.frequency_hz)
            .fold(0.0, f64::max)
    }

    /// I/m in mass axes, m^2, written out here so that the core's has something to be held against.
    pub fn inertia_mass_m2(&self) -> DMat3 {
        let [i1, i2, i3, i4, i5, i6] = self.parameters.inertia_per_mass.to_paper_order();
        DMat3::from_cols_array(&[i1, i4, i5, i4, i2, i6, i5, i6, i3])
    }

    /// Everything that is known in closed form at one instant.
    pub fn at(&self, time_s: f64) -> Moment {
        let window = self.window(time_s);
        let sum = |get: fn(&Harmonic) -> [DVec3; 2], axis: usize| {
            self.harmonics.iter().fold(Scalar([0.0; 3]), |sum, h| {
                let [a, b] = get(h).map(|v| v[axis]);
                let one = Scalar::harmonic(a, b, h.frequency_hz, time_s);
                Scalar(core::array::from_fn(|i| sum.0[i] + one.0[i]))
            }) * window
        };
        let [x, y, z] = [0, 1, 2].map(|axis| sum(|h| h.position_m, axis));
        let [a, b, c] = [0, 1, 2].map(|axis| sum(|h| h.angle_rad, axis));
        let rotation = Rotation::about(DVec3::Z, c)
            .after(&Rotation::about(DVec3::Y, b))
            .after(&Rotation::about(DVec3::X, a));
        self.loaded(Vector::from_components(x, y, z), rotation)
    }

    fn window(&self, time_s: f64) -> Scalar {
        let t = self.rise_s;
        if t == 0.0 {
            return Scalar([1.0, 0.0, 0.0]);
        }
        let [_, value, first, second] = smooth_step(time_s / t);
        Scalar([value, first / t, second / (t * t)])
    }

    /// Limb by limb: (2) for the force, then force and moment on the mass.
    fn loaded(&self, position: Vector, rotation: Rotation) -> Moment {
        let length = self.geometry.limb_length_m;
        let hinges = self.geometry.mass_hinges_m();
        let back = rotation.matrix().transpose();
        let mut moment = Moment {
            position,
            rotation,
            force_per_mass_m_s2: [0.0; LIMBS],
            force_mass_m_s2: DVec3::ZERO,
            torque_mass_m2_s2: DVec3::ZERO,
        };
        for limb in 0..LIMBS {
            let moved = position.0[0] + rotation.minus_identity * hinges[limb];
            let along = DIRECTIONS_SHELL[limb] * length + moved;
            // l^2 - L^2 without the difference of squares.
            let excess = 2.0 * length * moved.dot(DIRECTIONS_SHELL[limb]) + moved.length_squared();
            let elongation = excess / (length + along.length());
            let force = -self.parameters.stiffness_per_mass_per_s2 * elongation;
            let push = back * along.normalize() * force;
            moment.force_per_mass_m_s2[limb] = force;
            moment.force_mass_m_s2 += push;
            moment.torque_mass_m2_s2 += hinges[limb].cross(push);
        }
        moment
    }

    /// The nine voltages of this sensor at an amplifier setting, V: (10) and (11) solved for u.
    pub fn voltage_v(&self, gain_n_per_v: &[f64; LIMBS], moment: &Moment) -> [f64; LIMBS] {
        let p = &self.parameters;
        core::array::from_fn(|i| {
            p.zero_drift_v[i]
                + moment.force_per_mass_m_s2[i] / (p.scale_per_mass_per_kg[i] * gain_n_per_v[i])
        })
    }
}

impl Moment {
    /// R_r as a rotation vector, rad.
    pub fn rotation_vector_rad(&self) -> DVec3 {
        // The skew part is sin(angle) axis; its arcsine is exact for the small angles of a mass in a shell.
        let m = self.rotation.minus_identity;
        let sine = 0.5
            * DVec3::new(
                m.y_axis.z - m.z_axis.y,
                m.z_axis.x - m.x_axis.z,
                m.x_axis.y - m.y_axis.x,
            );
        let size = sine.length();
        if size == 0.0 {
            DVec3::ZERO
        } else {
            sine * (size.asin() / size)
        }
    }

    /// Attitude of the shell that belongs to an attitude of the mass.
    pub fn shell_attitude(&self, mass_attitude: DQuat) -> DMat3 {
        DMat3::from_quat(mass_attitude) * self.rotation.matrix().transpose()
    }
}

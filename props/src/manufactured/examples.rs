//! Single manufactured sensors, for tests that need one and not many.

use crate::truth;
use glam::DVec3;
use sixaxis_core::Geometry;

use super::motion::{Harmonic, Manufactured};

/// The paper's identified sensor with limbs a tenth as stiff, moved at 10 and 14 Hz so that the shell turns at up to
/// 40 rad/s about an axis that turns itself, under gravity.
pub fn turning() -> Manufactured {
    let mut parameters = truth::identified_parameters();
    parameters.stiffness_per_mass_per_s2 = 2e7;
    Manufactured {
        geometry: Geometry::PAPER,
        parameters,
        gravity_ground_m_s2: DVec3::new(1.0, -2.0, -9.0),
        harmonics: [
            Harmonic {
                frequency_hz: 10.0,
                position_m: [DVec3::new(4e-7, -2e-7, 3e-7), DVec3::new(-3e-7, 5e-7, 1e-7)],
                angle_rad: [DVec3::new(9e-6, 4e-6, -7e-6), DVec3::new(-5e-6, 8e-6, 6e-6)],
            },
            Harmonic {
                frequency_hz: 14.0,
                position_m: [DVec3::new(2e-7, 1e-7, -4e-7), DVec3::new(1e-7, -3e-7, 2e-7)],
                angle_rad: [DVec3::new(-6e-6, 7e-6, 5e-6), DVec3::new(8e-6, 3e-6, -9e-6)],
            },
        ],
        rise_s: 0.0,
    }
}

/// The same, let in smoothly from rest: multi-step schemes start there without an error of their own.
pub fn turning_from_rest() -> Manufactured {
    Manufactured {
        rise_s: 0.05,
        ..turning()
    }
}

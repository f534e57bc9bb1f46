//! What the joint fit knows of the instruments, the wedges and k/m before it sees the trials.

use sixaxis_core::identify::joint::room::Room;
use sixaxis_core::identify::joint::unknowns::Wedges;
use sixaxis_core::identify::joint::{Certificates, Known};
use sixaxis_core::significance::NORMAL_95;
use sixaxis_recordings::session::Session;

use super::{mass_centre, rod_mass};
use crate::tap::Taps;

/// Standard deviation of a wedge's angles where the session does not say, degrees: a workshop's.
pub const WEDGE_DEG: f64 = 0.1;
/// Relative standard deviation of a stated bandwidth or time constant: what a data sheet's typical value means.
pub(super) const TIME_CONSTANT: f64 = 0.1;

/// What the session says before the trials do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knowledge {
    /// Largest relative gain error of the accelerometer.
    pub accelerometer_gain_limit: f64,
    /// Relative standard deviation of gravity, which may tell that gain.
    pub gravity_deviation: f64,
    /// Delays of accelerometer and gyroscope that were undone as the recordings were read, s.
    pub undone_delay_s: [f64; 2],
    /// The mathematics' part.
    pub certificates: Certificates,
}

/// Relative deviation of gravity at any laboratory from the standard one, at most.
const GRAVITY_LIMIT: f64 = 3e-3;

impl Knowledge {
    /// What a session file says.
    pub fn of(session: &Session) -> Self {
        let share = |percent: f64| percent / 100.0;
        let accelerometer = &session.accelerometer;
        let gyroscope = &session.gyroscope;
        let first_order = |hz: f64| 1.0 / (core::f64::consts::TAU * hz);
        let known = |value: f64| Known {
            value,
            deviation: TIME_CONSTANT * value,
        };
        let wedge_deg = session
            .rig
            .as_ref()
            .and_then(|rig| rig.wedge_deg)
            .unwrap_or(WEDGE_DEG);
        Self {
            accelerometer_gain_limit: share(
                accelerometer
                    .gain_percent
                    .unwrap_or(accelerometer.class_percent),
            ),
            gravity_deviation: match session.stated_gravity_m_s2() {
                Some(_) => 0.0,
                None => GRAVITY_LIMIT / 3.0_f64.sqrt(),
            },
            undone_delay_s: [accelerometer.delay_ms, gyroscope.delay_ms]
                .map(|delay_ms| 1e-3 * delay_ms.unwrap_or(0.0)),
            certificates: Certificates {
                // The standard deviation of an even spread; the trials know this gain far better as a rule.
                gyroscope_gain_deviation: share(
                    gyroscope.gain_percent.unwrap_or(gyroscope.class_percent),
                ) / 3.0_f64.sqrt(),
                gyroscope_lag_s: gyroscope.bandwidth_hz.map(|hz| known(first_order(hz))),
                accelerometer_lag_s: accelerometer.bandwidth_hz.map_or(0.0, first_order),
                standard_delay_s: [0.0; 2],
                amplifier_corner_rad_s: session
                    .preprocessing
                    .amplifier_high_pass_hz
                    .map(|hz| known(core::f64::consts::TAU * hz)),
                channel_delay_s: 0.0,
                wedge_deviation_rad: wedge_deg.to_radians(),
                wedges: Wedges::Shared,
                compliance_s2: None,
                room: Room::ORDINARY,
            },
        }
    }

    /// The same with the mass's centre anywhere near the cube's.
    pub fn with_free_mass(&self) -> Self {
        let mut free = *self;
        free.certificates.room.mass_centre_m = mass_centre::DEVIATION_M;
        free
    }

    /// The same with limbs that may have mass, of which it is the mass's centre that the trials show first.
    #[must_use]
    pub fn with_heavy_limbs(&self) -> Self {
        let mut heavy = self.with_free_mass();
        heavy.certificates.room.rod_mass = rod_mass::DEVIATION;
        heavy
    }

    /// Takes k/m from taps, if they determine it. They were evaluated with steps 2 and 3, whose errors they share with the
    /// trials; of k/m that is a small part, and the trials say next to nothing of k/m themselves.
    pub fn take_taps(&mut self, taps: &Taps) {
        self.certificates.compliance_s2 = taps.stiffness.as_ref().map(|found| {
            let compliance = 1.0 / found.per_mass_per_s2;
            Known {
                value: compliance,
                deviation: found.half_width_95 / NORMAL_95 * compliance * compliance,
            }
        });
    }
}

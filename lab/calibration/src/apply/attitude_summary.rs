//! What became of the attitude of a recording: how well it was known, and what was used to keep it.

use glam::DVec3;
use sixaxis_core::aided::ErrorFilter;

/// Measurements of a kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Used {
    /// Used.
    pub taken: u64,
    /// Contradict what was known: a velocity is not used, a rest or an attitude counts little.
    pub refused: u64,
    /// Not used, since there was no sample at their time, or another one within a hundredth of a second.
    pub unused: u64,
}

impl Used {
    pub(super) fn count(&mut self, taken: bool) {
        if taken {
            self.taken += 1;
        } else {
            self.refused += 1;
        }
    }
}

/// What became of the attitude. Serialized, it is part of what `sixaxis decouple --json` prints.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct AttitudeSummary {
    /// Its standard deviation at the end, about all axes together, degrees.
    pub sd_attitude_deg: f64,
    /// Of the direction of gravity in the sensor, degrees.
    pub sd_tilt_deg: f64,
    /// Of the rate, all components together, rad/s.
    pub sd_rate_rad_s: f64,
    /// Time from which on the attitude was first less certain than asked, s; none if it never was.
    pub unknown_from_s: Option<f64>,
    /// Rows without ground axes.
    pub unknown_rows: u64,
    /// Rests, each of a quarter of a second.
    pub rest: Used,
    /// Of a bounded velocity.
    pub velocity: Used,
    /// Of attitudes from a file.
    pub attitude: Used,
}

impl AttitudeSummary {
    pub(super) fn of(filter: &ErrorFilter, down: DVec3) -> Self {
        let mut new = Self {
            sd_attitude_deg: 0.0,
            sd_tilt_deg: 0.0,
            sd_rate_rad_s: 0.0,
            unknown_from_s: None,
            unknown_rows: 0,
            rest: Used::default(),
            velocity: Used::default(),
            attitude: Used::default(),
        };
        new.see(filter, down);
        new
    }

    pub(super) fn see(&mut self, filter: &ErrorFilter, down: DVec3) {
        let found = filter.deviations();
        self.sd_attitude_deg = found.attitude_rad().to_degrees();
        self.sd_tilt_deg = filter.tilt_rad(down).to_degrees();
        self.sd_rate_rad_s = found.rate_shell_rad_s.length();
    }
}

//! What became of the attitude of a recording: how well it was known, and what was used to keep it.

use sixaxis_core::aided::{Bound, Deviations, Taken};

/// Measurements of a kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Used {
    /// Used.
    pub taken: u64,
    /// Contradict what was known: a velocity is not used, a rest or an attitude counts little.
    pub refused: u64,
    /// Not used, since there was no sample at their time, or another one within a hundredth of a second; of velocities, since the
    /// attitude was lost.
    pub unused: u64,
}

impl Used {
    pub(super) fn count(&mut self, taken: Taken) {
        match taken {
            Taken::Used => self.taken += 1,
            Taken::Refused => self.refused += 1,
            Taken::Turn | Taken::Cruise => {}
        }
    }
}

/// What looks like a rest, and is a motion that goes on as it is: rate or velocity are known to be other than zero.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct SteadyMotion {
    /// Quarters of a second of a steady turn about the plumb line: at most the rate across it was taken for zero.
    pub turns: u64,
    /// Of a motion at constant velocity: only the rate was taken for zero.
    pub cruises: u64,
    /// Time of the first, s.
    pub first_s: Option<f64>,
}

impl SteadyMotion {
    pub(super) fn count(&mut self, taken: Taken, time_s: f64) {
        match taken {
            Taken::Turn => self.turns += 1,
            Taken::Cruise => self.cruises += 1,
            Taken::Used | Taken::Refused => return,
        }
        self.first_s.get_or_insert(time_s);
    }

    /// What is to be said of it, if there was any.
    pub(super) fn sentence(&self) -> Option<String> {
        let first_s = self.first_s?;
        let all = self.turns + self.cruises;
        let what = match (self.turns, self.cruises) {
            (_, 0) => "a steady turn about the plumb line",
            (0, _) => "a motion at constant velocity",
            _ => "steady turns about the plumb line and motions at constant velocity",
        };
        Some(format!(
            "{all} times a quarter of a second looks like a rest and was taken for {what}, first at {first_s:.2} s: nine channels are constant in both, and what is known of rate and velocity contradicts a rest. If the sensor stood still there, that knowledge is wrong, and the heading with it (--aid rest)"
        ))
    }
}

/// What became of the attitude. Serialized, it is part of what `sixaxis decouple --json` prints.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct AttitudeSummary {
    /// Its standard deviation at the end, about all axes together, degrees. Without aids it is followed to half a turn, or as far as was
    /// asked for, beyond which nothing is known.
    pub sd_attitude_deg: f64,
    /// The largest of all times.
    pub largest_sd_attitude_deg: f64,
    /// Of the direction of gravity in the sensor, degrees.
    pub sd_tilt_deg: f64,
    /// Of the rate, all components together, rad/s.
    pub sd_rate_rad_s: f64,
    /// Of gravity's direction just before an aid: in the steady state of a sensor that stands still, its parameters exact, under the same velocities
    /// and attitudes; none where there is no steady state.
    pub bound_tilt_deg: Option<f64>,
    /// Of the rate across the plumb line there, rad/s.
    pub bound_rate_rad_s: Option<f64>,
    /// Time from which on the attitude was first less certain than asked, s; none if it never was.
    pub unknown_from_s: Option<f64>,
    /// Rows without ground axes.
    pub unknown_rows: u64,
    /// Rests, each of a quarter of a second.
    pub rest: Used,
    /// What looks like one and is none.
    pub steady: SteadyMotion,
    /// Of a bounded velocity.
    pub velocity: Used,
    /// Of attitudes from a file.
    pub attitude: Used,
}

impl AttitudeSummary {
    /// The same with what was used, but that nothing has been decoded yet.
    pub(super) const fn again(self) -> Self {
        Self {
            largest_sd_attitude_deg: 0.0,
            unknown_from_s: None,
            unknown_rows: 0,
            ..self
        }
    }

    pub(super) fn bounded_by(&mut self, bound: Option<Bound>) {
        self.bound_tilt_deg = bound.map(|b| b.tilt_rad.to_degrees());
        self.bound_rate_rad_s = bound.map(|b| b.rate_rad_s);
    }

    /// How well the attitude was known, in a sentence.
    pub fn sentence(&self) -> String {
        let Self {
            sd_attitude_deg,
            largest_sd_attitude_deg,
            sd_tilt_deg,
            ..
        } = self;
        // Beyond a quarter of a turn nothing is known.
        let is_known = |sd_deg: f64| sd_deg < 90.0;
        let degrees = |sd_deg: f64| match is_known(sd_deg) {
            true => format!("{sd_deg:.2}°"),
            false => "more than 90°".to_owned(),
        };
        if !is_known(*sd_tilt_deg) {
            return "at the end nothing is known of the attitude: one standard deviation is more than 90°"
                .to_owned();
        }
        let bound = self.bound_tilt_deg.filter(|tilt| is_known(*tilt));
        let bound = bound.map_or_else(String::new, |tilt| {
            format!(" (a sensor that stands still, under these aids: {tilt:.2}°)")
        });
        format!(
            "one standard deviation of the attitude: {} at worst, {} at the end; that of down: {} there{bound}",
            degrees(*largest_sd_attitude_deg),
            degrees(*sd_attitude_deg),
            degrees(*sd_tilt_deg)
        )
    }

    pub(super) fn see(&mut self, found: &Deviations, tilt_rad: f64) {
        self.sd_attitude_deg = found.attitude_rad().to_degrees();
        self.largest_sd_attitude_deg = self.largest_sd_attitude_deg.max(self.sd_attitude_deg);
        self.sd_tilt_deg = tilt_rad.to_degrees().min(self.sd_attitude_deg);
        self.sd_rate_rad_s = found.rate_shell_rad_s.length();
    }
}

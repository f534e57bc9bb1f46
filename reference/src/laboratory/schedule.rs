//! The trials of a session: steps 2, 3 and 4 in turn, then the three compound runs.

use glam::{DQuat, DVec3};
use rand_pcg::Pcg64;
use sixaxis_recordings::session::Role;

use super::defect::Defect;
use super::plan::RigPlan;
use crate::paper;
use crate::rig::run::{Mode, Mounting, Run, WEDGES};
use crate::sensor::TrueSensor;

/// One trial to be simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedTrial {
    /// Name of its recording, without extension.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// What the rig does, with the direction that the session file states.
    pub run: Run,
    /// Which of [`WEDGES`] the sensor stands on, if it is one of them.
    pub wedge: Option<usize>,
    /// How the sensor hangs.
    pub mounting: Mounting,
}

impl PlannedTrial {
    /// Gravity in the sensor's axes at rest if the stated direction is the true one, m/s^2.
    #[must_use]
    pub fn gravity_ground_m_s2(&self) -> DVec3 {
        self.mounting.gravity_ground_m_s2(self.run.direction_ground)
    }
}

impl RigPlan {
    /// A run of this rig.
    #[must_use]
    pub fn run(&self, mode: Mode, frequency_hz: f64, direction: DVec3) -> Run {
        Run {
            slider_amplitude_m: self.slider_amplitude_m,
            rotation_amplitude_rad: self.rotation_amplitude_rad,
            rest_s: self.rest_s,
            ramp_periods: self.ramp_periods,
            steady_periods: self.steady_periods,
            crank_over_rod: self.crank_over_rod,
            ..Run::new(mode, frequency_hz, direction)
        }
    }
}

/// The trials on a rig, so many for each of steps 2 to 4, in the order in which they are numbered.
#[must_use]
pub fn trials(rig: &RigPlan, per_step: usize, defect: Option<&Defect>) -> Vec<PlannedTrial> {
    let mut trials = Vec::new();
    for (word, role, mode, (low, high)) in [
        ("linear", Role::Linear, Mode::Linear, rig.low_band_hz),
        ("angular", Role::Angular, Mode::Angular, rig.low_band_hz),
        (
            "fast",
            Role::HighFrequencyLinear,
            Mode::Linear,
            rig.high_band_hz,
        ),
    ] {
        let plane = match defect {
            Some(Defect::UnderExcitedAxis {
                axis,
                linear,
                angular,
            }) if (*linear && mode == Mode::Linear) || (*angular && mode == Mode::Angular) => {
                Some(planar_wedges(*axis))
            }
            _ => None,
        };
        for i in 0..per_step {
            let share = i as f64 / (per_step.max(2) - 1) as f64;
            let (wedge, direction) = match &plane {
                Some(wedges) => (None, wedges[i % wedges.len()]),
                None => (Some(i % WEDGES.len()), WEDGES[i % WEDGES.len()]),
            };
            trials.push(PlannedTrial {
                name: format!("{word}-{:02}", i + 1),
                role,
                run: rig.run(mode, low + (high - low) * share, direction),
                wedge,
                mounting: rig.mounting,
            });
        }
    }
    trials.extend(compound_trials(rig));
    trials
}

/// The three runs of Tables 4 to 6.
#[must_use]
pub fn compound_trials(rig: &RigPlan) -> [PlannedTrial; 3] {
    core::array::from_fn(|i| {
        let table = &paper::COMPOUND_TABLES[i];
        PlannedTrial {
            name: format!("compound-{:02}", i + 1),
            role: Role::Validation,
            run: rig.run(Mode::Compound, table.frequency_hz, table.direction),
            wedge: WEDGES.iter().position(|w| *w == table.direction),
            mounting: rig.mounting,
        }
    })
}

/// The sensor of a trial that is another sensor's.
#[must_use]
pub(super) fn foreign_sensor(seed: u64) -> TrueSensor {
    TrueSensor::random(&mut Pcg64::new(u128::from(seed), 1))
}

/// Wedges that lie in the plane square to an axis.
fn planar_wedges(axis: usize) -> [DVec3; 4] {
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    [(1.0, 0.0), (0.0, 1.0), (1.0, 2.0), (2.0, 1.0)].map(|(x, y)| {
        let mut v = [0.0; 3];
        (v[a], v[b]) = (x, y);
        DVec3::from_array(v)
    })
}

/// A direction tilted by an angle towards an azimuth about itself.
#[must_use]
pub(super) fn tilted(direction: DVec3, angle_rad: f64, azimuth_rad: f64) -> DVec3 {
    let side = direction.any_orthonormal_vector();
    let towards = DQuat::from_axis_angle(direction, azimuth_rad) * side;
    (direction * angle_rad.cos() + towards * angle_rad.sin()).normalize()
}

//! Which trials a plan asks for: steps 2, 3 and 4 in turn, then the three compound runs.

use glam::{DQuat, DVec3};
use sixaxis_recordings::session::Role;

use super::defect::Defect;
use super::plan::{RigPlan, SessionPlan};
use crate::campaign::WEDGES;
use crate::paper;
use crate::rig::{Mode, Run};

/// One trial to be played.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Name of its recording, without extension.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// What the rig does.
    pub mode: Mode,
    /// Crank frequency, Hz.
    pub frequency_hz: f64,
    /// Which wedge, if it is one of the six.
    pub wedge: Option<usize>,
    /// Unit vector that the session file states.
    pub direction: DVec3,
}

impl Planned {
    /// The rig's run with the sensor on a wedge that truly has this direction.
    #[must_use]
    pub fn run(&self, rig: &RigPlan, direction: DVec3) -> Run {
        Run {
            slider_amplitude_m: rig.slider_amplitude_m,
            rotation_amplitude_rad: rig.rotation_amplitude_rad,
            rest_s: rig.rest_s,
            ramp_periods: rig.ramp_periods,
            steady_periods: rig.steady_periods,
            ..Run::new(self.mode, self.frequency_hz, direction)
        }
    }
}

/// The trials of a plan, in the order in which they are numbered.
#[must_use]
pub fn trials(plan: &SessionPlan, defect: Option<&Defect>) -> Vec<Planned> {
    let per_step = plan.trials_per_step;
    let mut trials = Vec::new();
    for (word, role, mode, (low, high)) in [
        ("linear", Role::Linear, Mode::Linear, plan.rig.low_band_hz),
        (
            "angular",
            Role::Angular,
            Mode::Angular,
            plan.rig.low_band_hz,
        ),
        (
            "fast",
            Role::HighFrequencyLinear,
            Mode::Linear,
            plan.rig.high_band_hz,
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
            trials.push(Planned {
                name: format!("{word}-{:02}", i + 1),
                role,
                mode,
                frequency_hz: low + (high - low) * share,
                wedge,
                direction: direction.normalize(),
            });
        }
    }
    trials.extend(
        paper::COMPOUND_TABLES
            .iter()
            .enumerate()
            .map(|(i, table)| Planned {
                name: format!("compound-{:02}", i + 1),
                role: Role::Validation,
                mode: Mode::Compound,
                frequency_hz: table.frequency_hz,
                wedge: WEDGES.iter().position(|w| *w == table.direction),
                direction: table.direction.normalize(),
            }),
    );
    trials
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
pub fn tilted(direction: DVec3, angle_rad: f64, azimuth_rad: f64) -> DVec3 {
    let side = direction.any_orthonormal_vector();
    let towards = DQuat::from_axis_angle(direction, azimuth_rad) * side;
    (direction * angle_rad.cos() + towards * angle_rad.sin()).normalize()
}

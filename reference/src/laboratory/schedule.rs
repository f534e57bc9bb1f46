//! The trials of a session: steps 2, 3 and 4 in turn, then the three compound runs.

use glam::{DQuat, DVec3};
use rand_pcg::Pcg64;
use sixaxis_recordings::session::Role;

use super::defect::{Defect, Kind};
use super::plan::RigPlan;
use crate::paper;
use crate::rig::run::{Mode, Mounting, Run, WEDGES};
use crate::sensor::{InertiaPerMass, TrueSensor};

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
    pub fn gravity_ground_m_s2(&self) -> DVec3 {
        self.mounting.gravity_ground_m_s2(self.run.direction_ground)
    }
}

impl RigPlan {
    /// A run of this rig.
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
        let flattened = match defect {
            Some(defect)
                if defect.kind == Kind::UnderExcitedAxis && role != Role::HighFrequencyLinear =>
            {
                Some((defect.channel % 3, defect.magnitude))
            }
            _ => None,
        };
        for i in 0..per_step {
            let share = i as f64 / (per_step.max(2) - 1) as f64;
            let wedge = i % WEDGES.len();
            let direction = match flattened {
                Some((axis, times)) => flat(WEDGES[wedge], axis, times),
                None => WEDGES[wedge],
            };
            trials.push(PlannedTrial {
                name: format!("{word}-{:02}", i + 1),
                role,
                run: rig.run(mode, low + (high - low) * share, direction),
                wedge: Some(wedge),
                mounting: rig.mounting,
            });
        }
    }
    trials.extend(compound_trials(rig));
    trials
}

/// Number of [`trials`].
pub const fn trial_count(per_step: usize) -> usize {
    3 * per_step + paper::COMPOUND_TABLES.len()
}

/// The three runs of Tables 4 to 6.
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
pub(super) fn foreign_sensor(seed: u32) -> TrueSensor {
    TrueSensor::random(&mut Pcg64::new(u128::from(seed), 1))
}

/// A direction whose share of an axis is one and so many times smaller; what is lost goes to the bisector of the other two axes,
/// so that a wedge along the axis ends up in the plane, too.
fn flat(direction: DVec3, axis: usize, times: f64) -> DVec3 {
    let axis = DVec3::AXES[axis];
    let along = direction.dot(axis);
    let lost = along * times / (1.0 + times);
    (direction - axis * lost + (DVec3::ONE - axis) * (0.5 * lost)).normalize()
}

/// A direction tilted by an angle towards an azimuth about itself.
pub(super) fn tilted(direction: DVec3, angle_rad: f64, azimuth_rad: f64) -> DVec3 {
    let side = direction.any_orthonormal_vector();
    let towards = DQuat::from_axis_angle(direction, azimuth_rad) * side;
    (direction * angle_rad.cos() + towards * angle_rad.sin()).normalize()
}

/// A sensor so far on the way to another one, by logarithms where numbers have a size.
pub(super) fn blended(own: &TrueSensor, other: &TrueSensor, share: f64) -> TrueSensor {
    let (a, b) = (
        own.inertia_per_mass.to_paper_order(),
        other.inertia_per_mass.to_paper_order(),
    );
    TrueSensor {
        scale_per_mass_per_kg: core::array::from_fn(|i| {
            let own = own.scale_per_mass_per_kg[i];
            own * (other.scale_per_mass_per_kg[i] / own).powf(share)
        }),
        zero_drift_v: core::array::from_fn(|i| {
            own.zero_drift_v[i] + share * (other.zero_drift_v[i] - own.zero_drift_v[i])
        }),
        inertia_per_mass: InertiaPerMass::from_paper_order(core::array::from_fn(|i| {
            a[i] + share * (b[i] - a[i])
        })),
        ..*own
    }
}

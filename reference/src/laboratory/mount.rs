//! How the sensor truly stands on the rig, wedge by wedge, which no laboratory knows: the wedge as its workshop made it, the
//! pinion's axis off the plumb line, the sensor's centre off the axis.

use core::f64::consts::PI;

use glam::DVec3;
use rand::RngExt;
use rand_distr::{Distribution, UnitSphere};
use rand_pcg::Pcg64;

use super::plan::SessionPlan;
use super::schedule::tilted;
use crate::rig::run::WEDGES;

/// Random streams of a session.
const WEDGE_STREAM: u128 = 5;
const AXIS_STREAM: u128 = 9;

/// Mounts of a session: one for each wedge, and one for directions that no wedge has.
pub(super) const MOUNTS: usize = WEDGES.len() + 1;

/// An angle, rad, and where it goes to, rad about what is tilted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Tilt {
    pub angle_rad: f64,
    pub azimuth_rad: f64,
}

impl Tilt {
    /// A unit vector tilted by this.
    pub fn of(self, direction: DVec3) -> DVec3 {
        tilted(direction, self.angle_rad, self.azimuth_rad)
    }
}

/// The sensor on one of its wedges.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Mount {
    /// Direction of travel and axis in the sensor's axes against what the wedge states.
    pub wedge: Tilt,
    /// Plumb line against the axis.
    pub plumb: Tilt,
    /// From the axis to the sensor's centre, shell axes, m.
    pub centre_offset_shell_m: DVec3,
}

/// The mounts of a plan: wedges tilt by evenly spread angles up to the plan's, the axis by just as much as it says, and the centre is off by
/// a vector of just that length, all of them towards anywhere. The centre's distance from the axis is what of the vector is across it: pi/4
/// on average. The last mount has no wedge that could be wrong.
pub(super) fn mounts(plan: &SessionPlan) -> [Mount; MOUNTS] {
    let rig = &plan.rig;
    let mut of_wedges = Pcg64::new(u128::from(plan.seed), WEDGE_STREAM);
    let mut of_axes = Pcg64::new(u128::from(plan.seed), AXIS_STREAM);
    core::array::from_fn(|mount| Mount {
        wedge: if mount < WEDGES.len() {
            Tilt {
                angle_rad: rig.wedge_error_deg.to_radians() * of_wedges.random::<f64>(),
                azimuth_rad: 2.0 * PI * of_wedges.random::<f64>(),
            }
        } else {
            Tilt::default()
        },
        plumb: Tilt {
            angle_rad: rig.axis_tilt_deg.to_radians(),
            azimuth_rad: 2.0 * PI * of_axes.random::<f64>(),
        },
        centre_offset_shell_m: DVec3::from_array(UnitSphere.sample(&mut of_axes))
            * (1e-3 * rig.centre_offset_mm),
    })
}

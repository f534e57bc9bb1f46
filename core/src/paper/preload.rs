//! The static limb forces that a piezo cannot show.
//!
//! A piezo rod has no static response: after taring, the channels read the change of force since rest. Gravity was
//! there before. At rest (3) and (4) read sum (f/m) e = -g, sum (f/m) t x e = 0; with equal stiffness and rigid mass
//! the nine forces follow from six numbers, the sag of the mass. Adding them back to a tared signal makes (2), (3)
//! and (8) exact again. Left out, the mass sags unseen by g/(k/m) shared among three limbs, 2e-8 m; limbs tilt by a
//! millionth, and what that does to the torque balance is integrated twice: 5e-5 of the peak at 5 Hz.

use glam::DVec3;
use nalgebra::{Matrix6, Vector6};

use crate::columns::{halves, stacked};
use crate::error::{Error, Result, require, require_positive};
use crate::geometry::{DIRECTIONS_SHELL, Geometry, LIMBS, LIMBS_PER_NODE};
use crate::model::{Model, StaticResponse};
use crate::paper::pose::Pose;
use crate::paper::wrench::LimbWrench;

/// Newton gains a factor of about 1e-6 (sag over limb length) per iteration.
const ITERATIONS: usize = 20;
/// Imbalance, relative to gravity, at which the equilibrium stands.
const TOLERANCE: f64 = 1e-14;

/// Static limb forces per mass of a sensor at rest under `gravity_shell_m_s2`, positive in compression, m/s^2.
///
/// `gravity_shell_m_s2` is the vector g in shell axes (pointing down). Zero gravity gives zero forces.
///
/// # Errors
/// [`Error::OutOfRange`] for a geometry, stiffness or gravity without a meaning,
/// [`Error::NotConverged`] when no equilibrium is found: the limbs are too soft for this gravity.
pub fn static_preload_m_s2(
    geometry: &Geometry,
    stiffness_per_mass_per_s2: f64,
    gravity_shell_m_s2: DVec3,
) -> Result<[f64; LIMBS]> {
    Ok(static_equilibrium(geometry, stiffness_per_mass_per_s2, gravity_shell_m_s2)?.1)
}

/// Static limb forces per mass that the channels of a model do not show, m/s^2: zero for a full response.
///
/// # Errors
/// [`Error::NotConverged`] when gravity finds no equilibrium.
pub fn hidden_preload_m_s2(model: &Model) -> Result<[f64; LIMBS]> {
    let settings = model.settings();
    match settings.static_response {
        StaticResponse::Full => Ok([0.0; LIMBS]),
        StaticResponse::Tared => {
            let equilibrium = equilibrium(
                &model.sensor().geometry,
                model.parameters().stiffness_per_mass_per_s2,
                &settings.stiffness_ratio,
                settings.gravity_shell_m_s2(),
            )?;
            Ok(equilibrium.1)
        }
    }
}

/// Pose and static limb forces per mass at rest, of limbs of one stiffness; the sag is in the pose.
///
/// # Errors
/// As [`static_preload_m_s2`].
pub fn static_equilibrium(
    geometry: &Geometry,
    stiffness_per_mass_per_s2: f64,
    gravity_shell_m_s2: DVec3,
) -> Result<(Pose, [f64; LIMBS])> {
    let equal = [1.0; LIMBS];
    equilibrium(
        geometry,
        stiffness_per_mass_per_s2,
        &equal,
        gravity_shell_m_s2,
    )
}

/// [`static_equilibrium`] of limbs of these stiffnesses over their mean.
fn equilibrium(
    geometry: &Geometry,
    stiffness_per_mass_per_s2: f64,
    stiffness_ratio: &[f64; LIMBS],
    gravity_shell_m_s2: DVec3,
) -> Result<(Pose, [f64; LIMBS])> {
    validate(geometry, stiffness_per_mass_per_s2, gravity_shell_m_s2)?;
    let arm_scale = geometry.half_edge_m;
    // Rows of J: the wrench of a unit force in each limb. Torques are divided by n to share a unit with forces.
    let rows: [Vector6<f64>; LIMBS] = core::array::from_fn(|limb| {
        let e = DIRECTIONS_SHELL[limb];
        let m = geometry.node_mass_m(limb / LIMBS_PER_NODE).cross(e) / arm_scale;
        stacked(e, m)
    });
    let normal = rows
        .iter()
        .zip(stiffness_ratio)
        .fold(Matrix6::zeros(), |sum: Matrix6<f64>, (row, ratio)| {
            sum + row * row.transpose() * *ratio
        });
    let cholesky = normal.cholesky().ok_or(Error::NotConverged {
        what: "static equilibrium (singular stiffness)",
        iterations: 0,
    })?;

    let mut pose = Pose::default();
    let mut previous = f64::INFINITY;
    for _ in 0..ITERATIONS {
        let elongation = pose.elongations_m(geometry);
        let force: [f64; LIMBS] = core::array::from_fn(|limb| {
            -stiffness_per_mass_per_s2 * stiffness_ratio[limb] * elongation[limb]
        });
        let wrench = LimbWrench::at_pose(geometry, &pose, &force);
        let imbalance_force = -(gravity_shell_m_s2 + wrench.force_shell_m_s2);
        let imbalance_torque = -wrench.torque_shell_m2_s2 / arm_scale;
        let size = imbalance_force.length() + imbalance_torque.length();
        let limit = TOLERANCE * gravity_shell_m_s2.length();
        // Rounding may stop the descent just above the limit; a step that no longer helps is as good as done.
        if size <= limit || (size >= previous && previous <= 1e3 * limit) {
            return Ok((pose, force));
        }
        if !size.is_finite() {
            break;
        }
        previous = size;
        let imbalance = stacked(imbalance_force, imbalance_torque);
        let [moved, turned] = halves(&(cholesky.solve(&imbalance) / stiffness_per_mass_per_s2));
        // Compression pushes along +e, so the mass gives way against it.
        pose.position_shell_m -= moved;
        pose.rotation_rad -= turned / arm_scale;
    }
    Err(Error::NotConverged {
        what: "static equilibrium",
        iterations: ITERATIONS,
    })
}

fn validate(
    geometry: &Geometry,
    stiffness_per_mass_per_s2: f64,
    gravity_shell_m_s2: DVec3,
) -> Result<()> {
    geometry.validate()?;
    require_positive("stiffness_per_mass_per_s2", stiffness_per_mass_per_s2)?;
    // An infinite length would pass for an infinite limit, and any imbalance for an equilibrium.
    let gravity = gravity_shell_m_s2.length();
    require(
        gravity.is_finite(),
        "gravity_shell_m_s2",
        gravity,
        "finite, and its square, too",
    )
}

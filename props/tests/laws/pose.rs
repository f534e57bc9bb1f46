//! Geometry, pose and static preload.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::Geometry;
use sixaxis_core::geometry::{DIRECTIONS_SHELL, LIMBS, LIMBS_PER_NODE, NODES};
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::preload::static_preload_m_s2;
use sixaxis_core::paper::relative_motion::RelativeMotion;
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::strategy::{config, vector};
use sixaxis_props::tolerance;
use sixaxis_reference::paper;

#[test]
fn paper_limbs_at_a_node_are_orthonormal_and_shell_hinges_outside_the_mass() {
    let geometry = Geometry::PAPER;
    for node in 0..NODES {
        let e = &DIRECTIONS_SHELL[node * LIMBS_PER_NODE..][..LIMBS_PER_NODE];
        for i in 0..LIMBS_PER_NODE {
            for j in 0..LIMBS_PER_NODE {
                let wanted = if i == j { 1.0 } else { 0.0 };
                within(
                    "orthonormal limbs",
                    (e[i].dot(e[j]) - wanted).abs(),
                    tolerance::ROUNDING,
                );
            }
        }
    }
    for hinge in geometry.shell_hinges_m() {
        let outside = hinge.abs().max_element() > geometry.half_edge_m;
        assert!(outside, "a shell hinge at {hinge} lies inside the mass");
    }
}

#[test]
fn inv_coordination_equations_are_the_left_null_space() {
    let jacobian = sixaxis_reference::geometry::Geometry::PAPER.limb_wrenches();
    for sum in [[0, 1, 3, 4], [0, 2, 6, 8], [4, 5, 7, 8]] {
        for column in 0..6 {
            let total: f64 = sum.iter().map(|&limb| jacobian[(limb, column)]).sum();
            within("coordination equation", total.abs(), tolerance::ROUNDING);
        }
    }
}

#[test]
fn inv_preload_is_the_linear_one_up_to_the_sag() {
    let gravity = DVec3::new(3.0, -4.0, -8.0);
    let k = paper::STIFFNESS_PER_MASS_PER_S2;
    let force =
        static_preload_m_s2(&Geometry::PAPER, k, gravity).expect("gravity finds an equilibrium");
    let jacobian = sixaxis_reference::geometry::Geometry::PAPER.limb_wrenches();
    let normal = (jacobian.transpose() * jacobian)
        .try_inverse()
        .expect("the paper's geometry is regular");
    let linear = jacobian
        * normal
        * nalgebra::Vector6::new(-gravity.x, -gravity.y, -gravity.z, 0.0, 0.0, 0.0);
    let size = largest(linear.iter().copied());
    let error = |sign: f64| largest((0..LIMBS).map(|i| force[i] - sign * linear[i])) / size;
    within("preload", error(1.0), tolerance::PRELOAD_LINEAR);
    fails_clearly(
        "preload of the wrong sign",
        error(-1.0),
        tolerance::PRELOAD_LINEAR,
    );
}

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn prop_pose_survives_elongations(
        r in vector(1.0), phi in vector(1.0), exponent in -8.0..-4.0_f64,
    ) {
        let size = 10.0_f64.powf(exponent);
        let geometry = Geometry::PAPER;
        let n = geometry.half_edge_m;
        let pose = Pose { position_shell_m: r * size, rotation_rad: phi * size / n };
        let back = Pose::from_elongations(&geometry, &pose.elongations_m(&geometry))
            .expect("a real pose has limbs that meet");
        let error = (back.position_shell_m - pose.position_shell_m).length()
            + n * (back.rotation_rad - pose.rotation_rad).length();
        within("pose", error / size, tolerance::POSE_ROUND_TRIP);
    }

    #[test]
    fn prop_relative_rate_is_that_of_the_rotation_matrix(phi in vector(1e-2), spin in vector(1.0)) {
        // A rotation vector that moves evenly; its matrix differenced numerically is the truth.
        let step_s = 1e-4;
        let pose = |steps: f64| Pose {
            position_shell_m: DVec3::ZERO,
            rotation_rad: phi + spin * steps * step_s,
        };
        let motion = RelativeMotion::from_poses(&pose(-1.0), &pose(0.0), &pose(1.0), step_s);
        let slope = (pose(1.0).rotation_matrix() - pose(-1.0).rotation_matrix()) * (0.5 / step_s);
        let skew = slope * pose(0.0).rotation_matrix().transpose();
        let rate = DVec3::new(
            skew.y_axis.z - skew.z_axis.y,
            skew.z_axis.x - skew.x_axis.z,
            skew.x_axis.y - skew.y_axis.x,
        ) * 0.5;
        within(
            "relative rate",
            (motion.rate_shell_rad_s - rate).length(),
            tolerance::RELATIVE_RATE,
        );
    }

    #[test]
    fn prop_elongations_are_differences_of_distances(r in vector(1e-3), phi in vector(5e-2)) {
        let geometry = Geometry::PAPER;
        let pose = Pose { position_shell_m: r, rotation_rad: phi };
        let ours = pose.elongations_m(&geometry);
        let rotation = glam::DQuat::from_scaled_axis(phi);
        let (shell, mass) = (geometry.shell_hinges_m(), geometry.mass_hinges_m());
        let error = largest((0..LIMBS).map(|i| {
            let distance = (r + rotation * mass[i] - shell[i]).length();
            ours[i] - (distance - geometry.limb_length_m)
        }));
        within("elongation", error, tolerance::DISTANCE);
    }
}

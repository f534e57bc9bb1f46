//! Rotations: exponential, relative pose, and the attitude that follows a rate.

use glam::{DMat3, DQuat, DVec3};
use proptest::prelude::*;
use sixaxis_core::paper::attitude;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::relative_motion::RelativeMotion;
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::manufactured::curve::cross_matrix;
use sixaxis_props::strategy::{config, vector};
use sixaxis_props::tolerance;

/// A direction, and an angle of any size: often near where series and closed form meet.
fn rotation() -> impl Strategy<Value = DVec3> {
    let angle = prop_oneof![
        (-9.0..0.5_f64).prop_map(|log| 10.0_f64.powf(log)),
        3e-3..12e-3_f64,
        Just(0.0),
    ];
    (vector(1.0), angle).prop_map(|(v, angle)| v.normalize_or(DVec3::X) * angle)
}

/// (exp(\[phi\]x) - 1) v by its power series, to the last digit: a second way without sines.
fn minus_identity(phi: DVec3, v: DVec3) -> DVec3 {
    let mut term = v;
    let mut sum = DVec3::ZERO;
    for n in 1..60 {
        term = phi.cross(term) / f64::from(n);
        sum += term;
    }
    sum
}

proptest! {
    #![proptest_config(config(512))]

    #[test]
    fn prop_exponential_is_cosine_and_sine_of_half_the_angle(phi in rotation()) {
        let q = attitude::exp(phi);
        let (sin, cos) = (0.5 * phi.length()).sin_cos();
        let axis = phi.normalize_or(DVec3::ZERO);
        let v = DVec3::new(q.x, q.y, q.z);
        within("scalar part", (q.w - cos).abs(), tolerance::LAST_DIGITS);
        let size = sin.abs().max(f64::MIN_POSITIVE);
        within("vector part", (v - axis * sin).length() / size, tolerance::LAST_DIGITS);
    }

    #[test]
    fn prop_exponential_of_the_opposite_is_the_inverse(phi in rotation()) {
        let both = attitude::exp(phi) * attitude::exp(-phi);
        within("q(phi) q(-phi)", (both - DQuat::IDENTITY).length(), tolerance::LAST_DIGITS);
    }

    /// What a pose does to the nodes is what its rotation matrix does, and both are the exponential's series.
    #[test]
    fn prop_pose_rotates_as_the_exponential(phi in rotation(), v in vector(1.0)) {
        let pose = Pose { position_shell_m: DVec3::ZERO, rotation_rad: phi };
        let ours = pose.rotation_matrix();
        let wanted = minus_identity(phi, v);
        let size = phi.length().max(f64::MIN_POSITIVE) * v.length();
        // Only the part beyond 1 has digits to lose: see it through the matrix's own rounding.
        let rounding = f64::EPSILON * v.length() / size;
        within(
            "(R - 1) v",
            ((ours * v - v) - wanted).length() / size / (1.0 + rounding / tolerance::LAST_DIGITS.limit),
            tolerance::LAST_DIGITS,
        );
        let geometry = sixaxis_core::Geometry::PAPER;
        for node in 0..3 {
            let arm = geometry.node_mass_m(node);
            let moved = pose.node_displacement_shell_m(&geometry, node);
            let size = phi.length().max(f64::MIN_POSITIVE) * arm.length();
            within("displacement of a node", (moved - minus_identity(phi, arm)).length() / size, tolerance::LAST_DIGITS);
        }
    }

    /// A constant rate: one step or many, the rotation is exp of rate times time.
    #[test]
    fn inv_constant_rate_turns_evenly(rate in vector(100.0), start in vector(3.0)) {
        let start = DQuat::from_scaled_axis(start);
        let (step_s, steps) = (1e-3, 50);
        let mut q = start;
        for _ in 0..steps {
            q = attitude::advance(q, [rate; 2], [DVec3::ZERO; 2], step_s);
        }
        let wanted = start * DQuat::from_scaled_axis(rate * (step_s * f64::from(steps)));
        let error = (q - wanted).length().min((q + wanted).length());
        within("attitude at a constant rate", error, tolerance::ROUNDING);
        // Rates are the shell's own: from the other side the attitude would be another.
        let wrong = DQuat::from_scaled_axis(rate * (step_s * f64::from(steps))) * start;
        let error = (q - wrong).length().min((q + wrong).length());
        prop_assume!(error > tolerance::TOLD_APART);
        fails_clearly("rate taken in ground axes", error, tolerance::ROUNDING);
    }

    /// w_r and eps against derivatives of the rotation matrix of a rotation vector with known derivatives.
    #[test]
    fn prop_relative_motion_is_the_derivative_of_the_pose(
        phi in vector(1e-3), spin in vector(1.0), bend in vector(100.0),
        r in vector(1e-5), v in vector(1e-2), a in vector(10.0),
    ) {
        let step_s = 1e-5;
        let pose = |t: f64| Pose {
            position_shell_m: r + v * t + a * (0.5 * t * t),
            rotation_rad: phi + spin * t + bend * (0.5 * t * t),
        };
        let motion = RelativeMotion::from_poses(&pose(-step_s), &pose(0.0), &pose(step_s), step_s);
        within("velocity", (motion.velocity_shell_m_s - v).length() / v.length().max(1e-3), tolerance::DIFFERENCED_ONCE);
        within("acceleration", (motion.acceleration_shell_m_s2 - a).length() / a.length().max(1.0), tolerance::DIFFERENCED_TWICE);
        // R' R^T and R'' R^T + R' R'^T with R' and R'' by the chain rule: exp's own derivatives to third order in phi.
        let [p, q, b] = [phi, spin, bend].map(cross_matrix);
        let first = q + (p * q + q * p) * 0.5 + (p * p * q + p * q * p + q * p * p) * (1.0 / 6.0);
        let second = b + (p * b + b * p) * 0.5 + q * q
            + (p * p * b + p * b * p + b * p * p) * (1.0 / 6.0)
            + (p * q * q + q * p * q + q * q * p) * (1.0 / 3.0);
        let back = pose(0.0).rotation_matrix().transpose();
        let rate = vee(first * back);
        let angular = vee(second * back + first * first.transpose());
        within("relative rate", (motion.rate_shell_rad_s - rate).length() / spin.length().max(0.1), tolerance::DIFFERENCED);
        within(
            "relative angular acceleration",
            (motion.angular_acceleration_shell_rad_s2 - angular).length() / bend.length().max(10.0),
            tolerance::DIFFERENCED,
        );
    }
}

fn vee(m: DMat3) -> DVec3 {
    0.5 * DVec3::new(
        m.y_axis.z - m.z_axis.y,
        m.z_axis.x - m.x_axis.z,
        m.x_axis.y - m.y_axis.x,
    )
}

#[test]
fn inv_attitude_stays_a_rotation() {
    let mut q = DQuat::IDENTITY;
    let step_s = 1e-4;
    for i in 0..10_000_000_u32 {
        let t = f64::from(i) * step_s;
        let rate = |t: f64| DVec3::new(50.0 * t.sin(), 30.0 * (1.3 * t).cos(), -20.0);
        let slope = |t: f64| DVec3::new(50.0 * t.cos(), -39.0 * (1.3 * t).sin(), 0.0);
        q = attitude::advance(
            q,
            [rate(t), rate(t + step_s)],
            [slope(t), slope(t + step_s)],
            step_s,
        );
    }
    let matrix = DMat3::from_quat(q);
    let unit = matrix * matrix.transpose() - DMat3::IDENTITY;
    within(
        "attitude after 1e7 steps, distance of R R^T from 1",
        largest(unit.to_cols_array()),
        tolerance::ORTHONORMAL,
    );
}

#[test]
fn order_attitude_is_of_fourth_order() {
    // A rate that turns: without the commutator term the order would be two.
    let rate = |t: f64| DVec3::new(20.0 * (9.0 * t).cos(), 20.0 * (9.0 * t).sin(), 5.0);
    let slope = |t: f64| DVec3::new(-180.0 * (9.0 * t).sin(), 180.0 * (9.0 * t).cos(), 0.0);
    let end = |steps: u32| {
        let h = 1.0 / f64::from(steps);
        (0..steps).fold(DQuat::IDENTITY, |q, i| {
            let (a, b) = (f64::from(i) * h, f64::from(i + 1) * h);
            attitude::advance(q, [rate(a), rate(b)], [slope(a), slope(b)], h)
        })
    };
    let truth = end(20_000);
    let error = |steps| {
        (end(steps) - truth)
            .length()
            .min((end(steps) + truth).length())
    };
    let order = (error(200) / error(400)).log2();
    within(
        "order of the attitude",
        (order - 4.0).abs(),
        tolerance::ORDER,
    );
}

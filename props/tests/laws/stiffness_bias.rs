//! First-order theory of what step 2 neglects and of what the limbs' compliance does to step 4's torque balance.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::identify::bias::{ComplianceEffect, LinearMotion};
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::paper::preload::static_equilibrium;
use sixaxis_core::paper::wrench::LimbWrench;
use sixaxis_core::{Geometry, LIMBS};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::problem::rig::model;
use sixaxis_props::strategy::{config, parameters, vector};
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_props::truth::InCore;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::rig::run::{Mode, Mounting, Run};

/// Stiffness so high that what is left out of first order is rounding's neighbour, s^-2.
const STIFF_PER_S2: f64 = 1e10;

proptest! {
    #![proptest_config(config(64))]

    /// Slow motion under a load: the tilt terms against the equilibrium that core finds by Newton's method.
    #[test]
    fn prop_tilt_is_that_of_the_equilibrium(
        truth in parameters(),
        a in vector(90.0),
        gravity in vector(9.8),
    ) {
        let drawing = Geometry::PAPER;
        let effect = ComplianceEffect::new(&drawing, &truth.inertia_per_mass).expect("a sound sensor");
        let motion = LinearMotion {
            acceleration_m_s2: a,
            acceleration_second_derivative_m_s4: DVec3::ZERO,
            gravity_m_s2: gravity,
        };
        // The wrench that rigid limbs' forces gain when the mass gives way to them, per unit of 1/(k/m).
        let gained = |load: DVec3| {
            let forces = effect.rigid_forces_m_s2(load);
            let (pose, _) = static_equilibrium(&drawing, STIFF_PER_S2, -load).expect("an equilibrium");
            let there = LimbWrench::at_pose(&drawing, &pose, &forces);
            let at_rest = LimbWrench::at_rest(&drawing, &forces);
            (
                (there.force_shell_m_s2 - at_rest.force_shell_m_s2) * STIFF_PER_S2,
                (there.torque_shell_m2_s2 - at_rest.torque_shell_m2_s2) * STIFF_PER_S2,
            )
        };
        let (moving, resting) = (gained(a - gravity), gained(-gravity));
        let (force, torque) = (moving.0 - resting.0, moving.1 - resting.1);
        let size = (a - gravity).length_squared() + gravity.length_squared();
        let ours = effect.neglected_force_m_s4(&motion);
        within("force of tilted limbs", (ours - force).length() * drawing.limb_length_m / size, tolerance::TILT);
        let ours = effect.torque_m2_s4(&motion);
        within("torque of tilted limbs", (ours - torque).length() / size, tolerance::TILT);
        // Without the share at rest it is another number.
        let unrested = moving.0;
        if resting.0.length() * drawing.limb_length_m > size * tolerance::TOLD_APART {
            fails_clearly("share at rest left in", (unrested - force).length() * drawing.limb_length_m / size, tolerance::TILT);
        }
    }
}

#[test]
fn ref_step_2_errs_as_first_order_theory_says() {
    const RATE_HZ: f64 = 2_000.0;
    const STEPS: usize = 20;
    const DIRECTIONS: [DVec3; 3] = [
        DVec3::new(1.0, 0.2, 0.1),
        DVec3::new(-0.1, 1.0, 0.3),
        DVec3::new(0.2, -0.2, 1.0),
    ];
    let truth = truth::identified_parameters();
    let compliance_s2 = 1.0 / truth.stiffness_per_mass_per_s2;
    let effect = ComplianceEffect::new(&Geometry::PAPER, &truth.inertia_per_mass)
        .expect("the paper's sensor");
    let laboratory = Laboratory::noise_free(truth::sensor(&truth));
    let mut step_2 = ScaleIdentification::default();
    let mut theory = [true, false].map(|gravity| (gravity, ScaleIdentification::default()));
    for direction in DIRECTIONS {
        let run = Run {
            rest_s: 0.01,
            ramp_periods: 0.5,
            steady_periods: 0.5,
            ..Run::new(Mode::Linear, 2.0, direction)
        };
        let model = model(&truth, direction, Mounting::AxisVertical);
        let run = sixaxis_reference::mujoco::simulate_run(&model, &run, RATE_HZ, STEPS)
            .expect("a run within the rig's limits simulates");
        let recording = laboratory.record(&run, 0);
        let a: Vec<DVec3> = recording
            .accelerometer_m_s2
            .iter()
            .map(|a| recording.direction_ground * *a)
            .collect();
        for i in 1..a.len() - 1 {
            let force = recording
                .gains()
                .measured_force_n(&recording.voltage_v[i], &truth.zero_drift_v);
            step_2.push(&force, a[i]).expect("rows are finite");
            for (gravity, rows) in &mut theory {
                let motion = LinearMotion {
                    acceleration_m_s2: a[i],
                    acceleration_second_derivative_m_s4: (a[i + 1] - 2.0 * a[i] + a[i - 1])
                        * (RATE_HZ * RATE_HZ),
                    gravity_m_s2: if *gravity {
                        recording.gravity_ground_m_s2
                    } else {
                        DVec3::ZERO
                    },
                };
                rows.push(
                    &effect.rigid_forces_m_s2(a[i]),
                    effect.neglected_force_m_s4(&motion),
                )
                .expect("rows are finite");
            }
        }
    }
    let found = step_2.solve().expect("three directions").estimate.values;
    let measured: [f64; LIMBS] =
        core::array::from_fn(|i| found[i] / truth.scale_per_mass_per_kg[i] - 1.0);
    let [with, without] = theory.map(|(_, rows)| {
        let eps = rows.solve().expect("three directions").estimate.values;
        let off = (0..LIMBS).map(|i| eps[i] * compliance_s2 - measured[i]);
        largest(off) / largest(measured)
    });
    within(
        "errors of step 2 by first-order theory",
        with,
        tolerance::FIRST_ORDER,
    );
    fails_clearly("the same without gravity", without, tolerance::FIRST_ORDER);
}

//! The reference itself: what MuJoCo is right about, to what digit, and what it cannot resolve.

use glam::{DMat3, DVec3};
use sixaxis_core::paper::preload::static_equilibrium;
use sixaxis_core::{Geometry, LIMBS};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::problem::rig::{RATE_HZ, model, short_run, simulate};
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_reference::motion::Motion;
use sixaxis_reference::mujoco::model::{SHELL_INERTIA_KG_M2, SHELL_MASS_KG, SensorModel};
use sixaxis_reference::mujoco::ring_down;
use sixaxis_reference::mujoco::simulation::{Simulation, Snapshot};
use sixaxis_reference::rig::run::{Mode, Mounting, Run};
use sixaxis_reference::rig::tumble::{Sine, Tumble};
use sixaxis_reference::sensor::InertiaPerMass;

#[test]
fn ref_static_elongations_agree_with_an_independent_solve() {
    let parameters = truth::identified_parameters();
    for direction in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, 2.0, -1.0)] {
        let model = model(&parameters, direction, Mounting::AxisVertical);
        let mut simulation = Simulation::new(&model, 1e-5).expect("the step is stable");
        let held = Run::new(Mode::Rest, 1.0, direction);
        let measured = simulation.snapshot(&held).limb_elongation_m;
        let (pose, _) = static_equilibrium(
            &Geometry::PAPER,
            parameters.stiffness_per_mass_per_s2,
            model.gravity_ground_m_s2,
        )
        .expect("gravity finds an equilibrium");
        let predicted = pose.elongations_m(&Geometry::PAPER);
        let size = largest(predicted);
        within(
            "static elongation",
            largest((0..LIMBS).map(|i| measured[i] - predicted[i])) / size,
            tolerance::STATIC_ELONGATION,
        );
        fails_clearly(
            "elongation of the wrong sign",
            largest((0..LIMBS).map(|i| measured[i] + predicted[i])) / size,
            tolerance::STATIC_ELONGATION,
        );
    }
}

#[test]
fn ref_commanded_acceleration_is_what_the_simulator_has() {
    let parameters = truth::identified_parameters();
    let direction = DVec3::new(2.0, 1.0, 1.0);
    let run = simulate(&parameters, Mode::Compound, direction, Mounting::AxisLevel);
    let (mut error, mut peak) = (0.0, 0.0);
    for (sample, truth) in run.truth.iter().enumerate() {
        let (linear, _) = run.motion.acceleration(sample as f64 / RATE_HZ);
        error = largest([error, (linear - truth.linear_ground_m_s2).length()]);
        peak = largest([peak, linear.length()]);
    }
    within("exact drive", error / peak, tolerance::EXACT_DRIVE);
}

#[test]
fn order_reference_converges_with_its_step() {
    let parameters = truth::identified_parameters();
    let direction = DVec3::new(1.0, 2.0, 1.0);
    let run = short_run(Mode::Compound, direction);
    let model = model(&parameters, direction, Mounting::AxisVertical);
    let forces = |steps: usize| {
        sixaxis_reference::mujoco::simulate_run(&model, &run, RATE_HZ / 2.0, steps)
            .expect("the step is stable")
            .limb_force_per_mass_m_s2
    };
    let levels: Vec<_> = [6, 12, 24].map(forces).into();
    let change = |a: &[[f64; LIMBS]], b: &[[f64; LIMBS]]| {
        largest(
            a.iter()
                .zip(b)
                .flat_map(|(a, b)| (0..LIMBS).map(move |i| a[i] - b[i])),
        )
    };
    let order = (change(&levels[0], &levels[1]) / change(&levels[1], &levels[2])).log2();
    // At least: while the stiff modes are still felt, the error falls faster than with the fourth power.
    assert!(
        order >= 4.0 - tolerance::REFERENCE_ORDER.limit,
        "halving MuJoCo's step gains only order {order:.3}"
    );
}

#[test]
fn inv_only_ratios_to_the_mass_matter() {
    let parameters = truth::identified_parameters();
    let direction = DVec3::new(1.0, 1.0, 2.0);
    let run = short_run(Mode::Compound, direction);
    let light = model(&parameters, direction, Mounting::AxisVertical);
    let heavy = SensorModel {
        mass_kg: 4.0 * light.mass_kg,
        ..light
    };
    let forces = |model: &SensorModel| {
        sixaxis_reference::mujoco::simulate_run(model, &run, RATE_HZ, 2)
            .expect("the step is stable")
            .limb_force_per_mass_m_s2
    };
    let (a, b) = (forces(&light), forces(&heavy));
    let size = largest(a.iter().flatten().copied());
    let difference = largest(
        a.iter()
            .flatten()
            .zip(b.iter().flatten())
            .map(|(x, y)| x - y),
    );
    within(
        "forces per mass of a heavier sensor",
        difference / size,
        tolerance::MASS_RATIO,
    );
}

#[test]
fn ref_six_modes_ring_as_the_eigenproblem_says() {
    for parameters in [truth::design_parameters(), truth::identified_parameters()] {
        let model = model(&parameters, DVec3::Z, Mounting::AxisVertical);
        for mode in ring_down::measure(&model).expect("the step is stable") {
            within(
                "frequency of a mode",
                (mode.measured_hz / mode.predicted_hz - 1.0).abs(),
                tolerance::MODE_FREQUENCY,
            );
        }
    }
}

/// The free two-body model: nothing but limbs and gravity acts.
fn free_model() -> SensorModel {
    SensorModel {
        damping_ratio: 0.0,
        ..model(
            &truth::identified_parameters(),
            DVec3::new(1.0, 2.0, 2.0),
            Mounting::AxisVertical,
        )
    }
}

/// A free sensor that flies, tumbles and rings.
fn thrown(step_s: f64) -> Simulation {
    let mut simulation = Simulation::new(&free_model(), step_s).expect("the step is stable");
    simulation.displace_mass(DVec3::new(3e-7, -2e-7, 1e-7), DVec3::new(-4e-6, 5e-6, 8e-6));
    simulation.set_moving(DVec3::new(0.3, -0.2, 0.5), DVec3::new(20.0, -30.0, 25.0));
    simulation
}

/// Energy (J), linear momentum (N s) and angular momentum about the ground's origin (N m s).
fn invariants(model: &SensorModel, now: &Snapshot) -> (f64, DVec3, DVec3) {
    let mass_inertia = model.inertia_per_mass.tensor_m2() * model.mass_kg;
    let shell_inertia = DMat3::from_diagonal(DVec3::splat(SHELL_INERTIA_KG_M2));
    let stiffness = model.stiffness_per_mass_per_s2 * model.mass_kg;
    let squares: f64 = now.limb_elongation_m.iter().map(|dl| dl * dl).sum();
    let mut energy = 0.5 * stiffness * squares;
    let (mut linear, mut angular) = (DVec3::ZERO, DVec3::ZERO);
    for (body, mass, inertia) in [
        (now.shell, SHELL_MASS_KG, shell_inertia),
        (now.mass, model.mass_kg, mass_inertia),
    ] {
        let spin = inertia * body.rate_body_rad_s;
        energy += 0.5 * mass * body.velocity_ground_m_s.length_squared()
            + 0.5 * body.rate_body_rad_s.dot(spin)
            - mass * model.gravity_ground_m_s2.dot(body.position_ground_m);
        linear += mass * body.velocity_ground_m_s;
        angular +=
            body.attitude * spin + mass * body.position_ground_m.cross(body.velocity_ground_m_s);
    }
    (energy, linear, angular)
}

#[test]
fn inv_free_bodies_keep_energy_and_momentum() {
    const STEP_S: f64 = 2e-6;
    const MODEL_STEPS: u32 = 10_000;
    let model = free_model();
    let weight = model.gravity_ground_m_s2 * (SHELL_MASS_KG + model.mass_kg);
    let mut simulation = thrown(STEP_S);
    let first = simulation.step_free().expect("the state stays finite");
    let (energy, linear, angular) = invariants(&model, &first);
    let vibration: f64 = first.limb_elongation_m.iter().map(|dl| dl * dl).sum();
    let (mut energy_error, mut linear_error, mut angular_error) = (0.0, 0.0, 0.0);
    let moment = first.shell.position_ground_m * SHELL_MASS_KG
        + first.mass.position_ground_m * model.mass_kg;
    let mut stirred = 0.0_f64;
    for _ in 1..MODEL_STEPS {
        let before = simulation.time_s();
        let now = simulation.step_free().expect("the state stays finite");
        let (e, p, l) = invariants(&model, &now);
        // The centre of mass falls along a parabola: what gravity's moment about the origin adds is known.
        let turned =
            (moment * before + linear * (0.5 * before * before)).cross(model.gravity_ground_m_s2);
        energy_error = largest([energy_error, e - energy]);
        linear_error = largest([linear_error, (p - linear - weight * before).length()]);
        angular_error = largest([angular_error, (l - angular - turned).length()]);
        let squares: f64 = now.limb_elongation_m.iter().map(|dl| dl * dl).sum();
        stirred = stirred.max((squares / vibration - 1.0).abs());
    }
    within(
        "energy of the free model",
        energy_error / energy,
        tolerance::ENERGY,
    );
    within(
        "linear momentum",
        linear_error / linear.length(),
        tolerance::MOMENTUM,
    );
    within(
        "angular momentum",
        angular_error / angular.length(),
        tolerance::ANGULAR_MOMENTUM,
    );
    // What is conserved must have had occasion to change.
    assert!(
        stirred > tolerance::STIRRED,
        "the free model does not vibrate: {stirred:.1e}"
    );
}

/// Attitude, as three axes, of a sensor that spins fast enough for its axis to wander, with as little ringing as may be.
fn attitude_after(time_s: f64, step_s: f64, mujocos_own: bool) -> DMat3 {
    let model = SensorModel {
        gravity_ground_m_s2: DVec3::ZERO,
        ..free_model()
    };
    let mut simulation = Simulation::new(&model, step_s).expect("the step is stable");
    simulation.set_moving(DVec3::ZERO, DVec3::new(200.0, -300.0, 250.0));
    for _ in 0..(time_s / step_s).round() as usize {
        let done = if mujocos_own {
            simulation.step_as_mujoco()
        } else {
            simulation.step_free()
        };
        done.expect("the state stays finite");
    }
    let now = simulation.step_free().expect("the state stays finite");
    DMat3::from_quat(now.shell.attitude)
}

fn order_of_steps(mujocos_own: bool) -> f64 {
    const TIME_S: f64 = 9.6e-3;
    let [coarse, half, quarter] =
        [4e-6, 2e-6, 1e-6].map(|step_s| attitude_after(TIME_S, step_s, mujocos_own));
    let apart = |a: DMat3, b: DMat3| largest((a - b).to_cols_array());
    (apart(coarse, half) / apart(half, quarter)).log2()
}

#[test]
fn order_mujocos_own_step_is_second_for_a_tumbling_body() {
    let order = order_of_steps(true);
    within(
        "order of mj_step",
        (order - 2.0).abs(),
        tolerance::MUJOCO_ORDER,
    );
}

#[test]
fn order_our_step_is_fourth_for_a_tumbling_body() {
    // At least: the ringing modes' share falls with the fourth power, too, but from higher up.
    let order = order_of_steps(false);
    within(
        "order of our step",
        (4.0 - order).max(0.0),
        tolerance::REFERENCE_ORDER,
    );
}

#[test]
fn ref_fixed_axis_step_is_mujocos_own() {
    const STEP_S: f64 = 1e-5;
    // A body that turns about a principal axis keeps to it.
    let [i1, i2, i3, ..] = free_model().inertia_per_mass.to_paper_order();
    let model = SensorModel {
        gravity_ground_m_s2: DVec3::ZERO,
        inertia_per_mass: InertiaPerMass::from_paper_order([i1, i2, i3, 0.0, 0.0, 0.0]),
        ..free_model()
    };
    let start = || {
        let mut simulation = Simulation::new(&model, STEP_S).expect("the step is stable");
        simulation.set_moving(DVec3::new(0.3, -0.2, 0.5), DVec3::Z * 30.0);
        simulation
    };
    let (mut ours, mut theirs) = (start(), start());
    let mut difference = 0.0;
    for _ in 0..100 {
        let a = ours.step_free().expect("the state stays finite");
        let b = theirs.step_as_mujoco().expect("the state stays finite");
        difference = largest([
            difference,
            (a.shell.position_ground_m - b.shell.position_ground_m).length(),
            (a.mass.position_ground_m - b.mass.position_ground_m).length(),
            (a.shell.attitude - b.shell.attitude).length(),
        ]);
    }
    within(
        "our step against mj_step, m and rad",
        difference,
        tolerance::FIXED_AXIS_STEP,
    );
}

#[test]
fn order_reference_converges_on_a_tumbling_motion() {
    let motion = Tumble {
        position_ground_m: [20.0, 33.0, 41.0].map(|frequency_hz| Sine {
            amplitude: DVec3::new(2e-3, -1e-3, 1.5e-3),
            frequency_hz,
            phase_rad: DVec3::new(0.3, 1.1, -2.0),
        }),
        rate_shell_rad_s: [17.0, 29.0, 44.0].map(|frequency_hz| Sine {
            amplitude: DVec3::new(12.0, -8.0, 15.0),
            frequency_hz,
            phase_rad: DVec3::new(-1.0, 0.4, 2.2),
        }),
        rise_s: 0.02,
    };
    let model = model(
        &truth::identified_parameters(),
        DVec3::Z,
        Mounting::AxisVertical,
    );
    let attitude = |steps: usize| {
        let run = sixaxis_reference::mujoco::simulate(&model, &motion, 0.05, RATE_HZ / 2.0, steps)
            .expect("the step is stable");
        let last = run.truth.last().expect("the run has samples");
        DMat3::from_quat(last.attitude)
    };
    let [coarse, half, quarter] = [5, 10, 20].map(attitude);
    let apart = |a: DMat3, b: DMat3| largest((a - b).to_cols_array());
    let order = (apart(coarse, half) / apart(half, quarter)).log2();
    within(
        "order of the driven attitude",
        (4.0 - order).max(0.0),
        tolerance::REFERENCE_ORDER,
    );
}

/// What MuJoCo cannot resolve: positions of 0.1 m are known to 1e-17 m, and so a limb force to 1e-9 m/s^2 and worse.
#[test]
fn ref_rounding_noise_of_a_moving_sensor() {
    let direction = DVec3::new(1.0, 1.0, 2.0);
    let model = model(
        &truth::identified_parameters(),
        direction,
        Mounting::AxisVertical,
    );
    let run = Run {
        rest_s: 0.0,
        ramp_periods: 0.5,
        steady_periods: 0.5,
        ..Run::new(Mode::Linear, 1.0, direction)
    };
    let run = sixaxis_reference::mujoco::simulate_run(&model, &run, RATE_HZ, 2)
        .expect("the step is stable");
    // Fourth differences at the sample rate see nothing of a motion of 1 Hz.
    let noise = largest(run.limb_force_per_mass_m_s2.windows(5).flat_map(|w| {
        let w = [0, 1, 2, 3, 4].map(|k| w[k]);
        (0..LIMBS).map(move |i| w[0][i] - 4.0 * w[1][i] + 6.0 * w[2][i] - 4.0 * w[3][i] + w[4][i])
    }));
    within(
        "fourth difference of a limb force, m/s^2",
        noise,
        tolerance::ROUNDING_NOISE,
    );
}

#[test]
fn inv_tare_resolution_is_a_rounding_of_the_length() {
    // One place of rest against the mean over many: what a tare taken from a single sample would be wrong by.
    let model = model(
        &truth::identified_parameters(),
        DVec3::new(1.0, 1.0, 2.0),
        Mounting::AxisVertical,
    );
    let mean = Simulation::mean_rest_force_per_mass_m_s2(&model, 1e-5).expect("the step is stable");
    let held = Run::new(Mode::Rest, 1.0, DVec3::Z);
    let single = Simulation::new(&model, 1e-5)
        .expect("the step is stable")
        .snapshot(&held)
        .limb_force_per_mass_m_s2;
    let unit_in_last_place_m = Geometry::PAPER.limb_length_m * f64::EPSILON;
    let units = largest((0..LIMBS).map(|i| single[i] - mean[i]))
        / (unit_in_last_place_m * model.stiffness_per_mass_per_s2);
    within(
        "single tare, in roundings of a limb length",
        units,
        tolerance::TARE_ROUNDINGS,
    );
    let (_, exact) = static_equilibrium(
        &Geometry::PAPER,
        model.stiffness_per_mass_per_s2,
        model.gravity_ground_m_s2,
    )
    .expect("gravity finds an equilibrium");
    let units = largest((0..LIMBS).map(|i| exact[i] - mean[i]))
        / (unit_in_last_place_m * model.stiffness_per_mass_per_s2);
    within(
        "mean tare against equilibrium, in the same",
        units,
        tolerance::MEAN_TARE_ROUNDINGS,
    );
}

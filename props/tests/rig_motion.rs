//! The reference, and the decoupler against it.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::decoupler::Decoupler;
use sixaxis_core::preload::static_equilibrium;
use sixaxis_core::{Geometry, LIMBS, LimbLaw, Parameters, Scheme, Sensor, Settings};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::strategy::{config, parameters, vector};
use sixaxis_props::tolerance;
use sixaxis_reference::campaign::{DAMPING_RATIO, Laboratory, MASS_KG};
use sixaxis_reference::mjcf::SensorModel;
use sixaxis_reference::paper;
use sixaxis_reference::recording::{Recording, SimulatedRun};
use sixaxis_reference::rig::{Mode, Mounting, Run};
use sixaxis_reference::simulation::{Motion, Simulation};
use sixaxis_reference::threshold;

const RATE_HZ: f64 = 10_000.0;
const STEPS: usize = 4;

fn model(parameters: &Parameters, direction: DVec3, mounting: Mounting) -> SensorModel {
    SensorModel {
        geometry: Geometry::PAPER,
        mass_kg: MASS_KG,
        inertia_per_mass: parameters.inertia_per_mass,
        stiffness_per_mass_per_s2: parameters.stiffness_per_mass_per_s2,
        damping_ratio: DAMPING_RATIO,
        gravity_ground_m_s2: mounting.gravity_ground_m_s2(direction),
    }
}

/// Half a turn up and half a turn down at 5 Hz: short, and as violent as the rig gets.
fn short_run(mode: Mode, direction: DVec3) -> Run {
    Run {
        rest_s: 0.005,
        ramp_periods: 0.5,
        steady_periods: 0.25,
        ..Run::new(mode, 5.0, direction)
    }
}

fn simulate(
    parameters: &Parameters,
    mode: Mode,
    direction: DVec3,
    mounting: Mounting,
) -> SimulatedRun {
    let run = short_run(mode, direction);
    SimulatedRun::simulate(
        &model(parameters, direction, mounting),
        &run,
        RATE_HZ,
        STEPS,
    )
    .expect("a run within the rig's limits simulates")
}

/// Largest error over the peak of the vector: linear and angular.
fn decoupling_errors(
    run: &SimulatedRun,
    recording: &Recording,
    parameters: &Parameters,
    change: impl Fn(&mut Settings),
) -> [f64; 2] {
    let mut settings = Settings {
        scheme: Scheme::HeunSubstepped,
        gravity_ground_m_s2: recording.gravity_ground_m_s2,
        ..Settings::new(recording.sample_rate_hz)
    };
    change(&mut settings);
    let sensor = Sensor {
        geometry: Geometry::PAPER,
        gains: recording.gains,
    };
    let mut decoupler =
        Decoupler::new(&sensor, parameters, &settings).expect("parameters are sound");
    let (mut error, mut peak) = ([0.0; 2], [0.0; 2]);
    for row in &recording.voltage_v {
        for s in decoupler
            .push(row)
            .expect("samples are finite")
            .into_iter()
            .flatten()
        {
            let t = &run.truth[s.sample as usize];
            for (i, (ours, truth)) in [
                (s.linear_ground_m_s2, t.linear_ground_m_s2),
                (s.angular_ground_rad_s2, t.angular_ground_rad_s2),
            ]
            .into_iter()
            .enumerate()
            {
                error[i] = largest([error[i], (ours - truth).length()]);
                peak[i] = largest([peak[i], truth.length()]);
            }
        }
    }
    [error[0] / peak[0], error[1] / peak[1]]
}

#[test]
fn ref_static_elongations_agree_with_an_independent_solve() {
    let parameters = paper::identified_parameters();
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
    let parameters = paper::identified_parameters();
    let direction = DVec3::new(2.0, 1.0, 1.0);
    let run = simulate(&parameters, Mode::Compound, direction, Mounting::AxisLevel);
    let (mut error, mut peak) = (0.0, 0.0);
    for (sample, truth) in run.truth.iter().enumerate() {
        let (linear, _) = run.run.acceleration(sample as f64 / RATE_HZ);
        error = largest([error, (linear - truth.linear_ground_m_s2).length()]);
        peak = largest([peak, linear.length()]);
    }
    within("exact drive", error / peak, tolerance::EXACT_DRIVE);
}

#[test]
fn order_reference_converges_with_its_step() {
    let parameters = paper::identified_parameters();
    let direction = DVec3::new(1.0, 2.0, 1.0);
    let run = short_run(Mode::Compound, direction);
    let model = model(&parameters, direction, Mounting::AxisVertical);
    let forces = |steps: usize| {
        SimulatedRun::simulate(&model, &run, RATE_HZ / 2.0, steps)
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
fn ref_decoupled_acceleration_is_the_simulated_one() {
    let parameters = paper::identified_parameters();
    for table in paper::COMPOUND_TABLES {
        for mounting in [Mounting::AxisVertical, Mounting::AxisLevel] {
            let run = simulate(&parameters, Mode::Compound, table.direction, mounting);
            let recording = Laboratory::noise_free(parameters).record(&run, 0);
            for error in decoupling_errors(&run, &recording, &parameters, |_| ()) {
                within("decoupled acceleration", error, tolerance::DECOUPLED);
            }
        }
    }
}

#[test]
fn ref_broken_decouplers_are_caught() {
    let parameters = paper::identified_parameters();
    let direction = DVec3::new(2.0, 1.0, 1.0);
    let run = simulate(&parameters, Mode::Compound, direction, Mounting::AxisLevel);
    let recording = Laboratory::noise_free(parameters).record(&run, 0);
    let worst = |recording: &Recording, parameters: &Parameters, change: &dyn Fn(&mut Settings)| {
        largest(decoupling_errors(&run, recording, parameters, change))
    };
    let gravity = recording.gravity_ground_m_s2;
    let mut swapped = recording.clone();
    for row in &mut swapped.voltage_v {
        row.swap(1, 3);
    }
    let mut off = parameters;
    off.scale_per_mass_per_kg[4] *= 1.01;
    let mut turned = parameters;
    core::mem::swap(
        &mut turned.inertia_per_mass.xx_m2,
        &mut turned.inertia_per_mass.zz_m2,
    );
    for (what, error) in [
        (
            "gravity upside down",
            worst(&recording, &parameters, &|s| {
                s.gravity_ground_m_s2 = -gravity
            }),
        ),
        (
            "gravity forgotten",
            worst(&recording, &parameters, &|s| {
                s.gravity_ground_m_s2 = DVec3::ZERO
            }),
        ),
        (
            "channels 2 and 4 swapped",
            worst(&swapped, &parameters, &|_| ()),
        ),
        (
            "scale factor 5 off by 1 %",
            worst(&recording, &off, &|_| ()),
        ),
        ("I1 and I3 swapped", worst(&recording, &turned, &|_| ())),
    ] {
        fails_clearly(what, error, tolerance::DECOUPLED);
    }
    // The sign of (2) moves the limbs by 2e-6 of their length: small, but more than the sound decoupler's whole error.
    let printed = worst(&recording, &parameters, &|s| {
        s.limb_law = LimbLaw::AsPrinted
    });
    assert!(
        printed > 10.0 * tolerance::DECOUPLED.limit,
        "eq. (2) with the printed sign goes unnoticed: {printed:.3e}"
    );
}

#[test]
fn inv_pure_translation_has_no_rate_at_the_true_stiffness_alone() {
    let parameters = paper::identified_parameters();
    let direction = DVec3::new(1.0, 1.0, 2.0);
    let run = simulate(&parameters, Mode::Linear, direction, Mounting::AxisVertical);
    let recording = Laboratory::noise_free(parameters).record(&run, 0);
    let rate = |stiffness_per_mass_per_s2: f64| {
        let mut candidate = parameters;
        candidate.stiffness_per_mass_per_s2 = stiffness_per_mass_per_s2;
        let settings = Settings {
            gravity_ground_m_s2: recording.gravity_ground_m_s2,
            ..Settings::new(RATE_HZ)
        };
        let sensor = Sensor {
            geometry: Geometry::PAPER,
            gains: recording.gains,
        };
        let mut decoupler =
            Decoupler::new(&sensor, &candidate, &settings).expect("parameters are sound");
        largest(recording.voltage_v.iter().flat_map(|row| {
            decoupler
                .push(row)
                .expect("samples are finite")
                .into_iter()
                .flatten()
                .map(|s| s.rate_shell_rad_s.length())
                .collect::<Vec<_>>()
        }))
    };
    let at_truth = rate(paper::STIFFNESS_PER_MASS_PER_S2);
    let at_design = rate(paper::DESIGN_STIFFNESS_PER_MASS_PER_S2);
    assert!(
        at_design > tolerance::NEGATIVE_CONTROL * at_truth,
        "rate {at_truth:.3e} rad/s at the true k/m, {at_design:.3e} at the design's"
    );
}

#[test]
fn inv_coordination_equations_hold_on_simulated_forces() {
    const SUMS: [[usize; 4]; 3] = [[0, 1, 3, 4], [0, 2, 6, 8], [4, 5, 7, 8]];
    let parameters = paper::identified_parameters();
    let direction = DVec3::new(2.0, 1.0, 1.0);
    let run = simulate(
        &parameters,
        Mode::Compound,
        direction,
        Mounting::AxisVertical,
    );
    let size = largest(run.limb_force_per_mass_m_s2.iter().flatten().copied());
    let worst = |sums: &[[usize; 4]; 3]| {
        largest(
            run.limb_force_per_mass_m_s2
                .iter()
                .flat_map(|f| sums.map(|sum| sum.iter().map(|&i| f[i]).sum::<f64>())),
        ) / size
    };
    within(
        "coordination equations",
        worst(&SUMS),
        tolerance::COORDINATION,
    );
    fails_clearly(
        "a wrong limb in the first equation",
        worst(&[[0, 1, 3, 5], SUMS[1], SUMS[2]]),
        tolerance::COORDINATION,
    );
}

#[test]
fn ref_relative_acceleration_follows_linear_theory() {
    let parameters = paper::design_parameters();
    for mode in [Mode::Linear, Mode::Angular] {
        let run = threshold::excitation(mode, 5.0);
        let model = model(&parameters, run.direction_ground, Mounting::AxisVertical);
        let point = threshold::measure(&model, &run, 5e-5).expect("the step is stable");
        let theory = threshold::linear_theory(
            &Geometry::PAPER,
            &parameters.inertia_per_mass,
            parameters.stiffness_per_mass_per_s2,
            &run,
        );
        within(
            "relative acceleration",
            (point.relative_acceleration / theory - 1.0).abs(),
            tolerance::LINEAR_THEORY,
        );
    }
}

proptest! {
    #![proptest_config(config(4))]

    #[test]
    fn ref_any_sensor_is_decoupled(parameters in parameters(), direction in vector(1.0)) {
        prop_assume!(direction.length() > 0.1);
        let run = simulate(&parameters, Mode::Compound, direction, Mounting::AxisLevel);
        let recording = Laboratory::noise_free(parameters).record(&run, 0);
        for error in decoupling_errors(&run, &recording, &parameters, |_| ()) {
            within("decoupled acceleration of a random sensor", error, tolerance::DECOUPLED);
        }
    }
}

#[test]
fn inv_only_ratios_to_the_mass_matter() {
    let parameters = paper::identified_parameters();
    let direction = DVec3::new(1.0, 1.0, 2.0);
    let run = short_run(Mode::Compound, direction);
    let light = model(&parameters, direction, Mounting::AxisVertical);
    let heavy = SensorModel {
        mass_kg: 4.0 * light.mass_kg,
        ..light
    };
    let forces = |model: &SensorModel| {
        SimulatedRun::simulate(model, &run, RATE_HZ, 2)
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

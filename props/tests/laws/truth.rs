//! The reference beside the core: two derivations that share no code, of one sensor.

use core::f64::consts::TAU;

use glam::DVec3;
use proptest::prelude::*;
use rand_pcg::Pcg64;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::euler_torque;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::{Decoupler, Gains, LIMBS, Parameters, Sensor, Settings};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::seed::seed;
use sixaxis_props::strategy::{config, parameters};
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_reference::compliant::{compliant_forces_m_s2, elongations_m};
use sixaxis_reference::laboratory::chain::Chain;
use sixaxis_reference::rig::journey::{Journey, Kind};
use sixaxis_reference::rigid::{Load, RigidSensor, torque_per_mass};
use sixaxis_reference::{geometry, sensor::TrueSensor};

/// Equations (5) and (6) as the paper prints them: limb by limb, n = 21 mm.
const LIMB_BY_LIMB: [([f64; 3], [f64; 3]); LIMBS] = [
    ([0.0, 0.0, 1.0], [0.0, 0.0, -0.021]),
    ([0.0, -1.0, 0.0], [0.0, 0.0, -0.021]),
    ([-1.0, 0.0, 0.0], [0.0, 0.0, -0.021]),
    ([0.0, 0.0, -1.0], [0.0, -0.021, 0.0]),
    ([0.0, 1.0, 0.0], [0.0, -0.021, 0.0]),
    ([-1.0, 0.0, 0.0], [0.0, -0.021, 0.0]),
    ([0.0, 0.0, -1.0], [-0.021, 0.0, 0.0]),
    ([0.0, -1.0, 0.0], [-0.021, 0.0, 0.0]),
    ([1.0, 0.0, 0.0], [-0.021, 0.0, 0.0]),
];

#[test]
fn inv_two_geometries_are_one() {
    let core = sixaxis_core::Geometry::PAPER;
    let reference = geometry::Geometry::PAPER;
    assert_eq!(core.limb_length_m, 25.5e-3);
    assert_eq!(reference.limb_length_m, 25.5e-3);
    let directions = geometry::Geometry::directions_shell();
    for (limb, (direction, hinge)) in LIMB_BY_LIMB.into_iter().enumerate() {
        let (direction, hinge) = (DVec3::from(direction), DVec3::from(hinge));
        assert_eq!(DIRECTIONS_SHELL[limb], direction, "core, limb {limb}");
        assert_eq!(directions[limb], direction, "reference, limb {limb}");
        assert_eq!(core.mass_hinges_m()[limb], hinge, "core, limb {limb}");
        assert_eq!(
            reference.mass_hinges_m()[limb],
            hinge,
            "reference, limb {limb}"
        );
        let shell = hinge - 25.5e-3 * direction;
        assert_eq!(core.shell_hinges_m()[limb], shell, "core, limb {limb}");
        assert_eq!(
            reference.shell_hinges_m()[limb],
            shell,
            "reference, limb {limb}"
        );
    }
    assert_eq!(core.limb_jacobian(), reference.limb_wrenches());
}

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from)
}

proptest! {
    #![proptest_config(config(64))]

    #[test]
    fn prop_torque_of_the_mass_s_elements_is_euler_s(
        parameters in parameters(),
        rate in vector(50.0),
        angular in vector(1700.0),
    ) {
        let sensor = truth::sensor(&parameters);
        let elements = torque_per_mass(&sensor.inertia_per_mass, rate, angular);
        let euler = euler_torque(&parameters.inertia_per_mass, rate, angular);
        let other_sign = torque_per_mass(&sensor.inertia_per_mass, rate, DVec3::ZERO) * 2.0;
        let size = euler.length();
        within("torque", (elements - euler).length() / size, tolerance::ROUNDING);
        let control = (elements - other_sign - euler).length() / size;
        fails_clearly("w x Iw of the wrong sign", control, tolerance::ROUNDING);
    }

    #[test]
    fn prop_elongations_of_a_pose_are_the_core_s(
        displacement in vector(1e-6),
        rotation in vector(1e-4),
    ) {
        let pose = Pose { position_shell_m: displacement, rotation_rad: rotation };
        let core = pose.elongations_m(&sixaxis_core::Geometry::PAPER);
        let off = |rotation| {
            let drawing = geometry::Geometry::PAPER;
            let reference = elongations_m(&drawing, displacement, rotation);
            largest((0..LIMBS).map(|i| reference[i] - core[i])) / largest(core)
        };
        within("elongations", off(rotation), tolerance::ROUNDING);
        fails_clearly("turned the other way", off(-rotation), tolerance::ROUNDING);
    }
}

/// Forces that turn by a sine of 1 Hz, one sample per row, from rest.
fn forces(samples: usize, rate_hz: f64) -> Vec<[f64; LIMBS]> {
    let wave = |i: usize| {
        let phase = TAU * i as f64 / rate_hz;
        // From rest in value and slope.
        phase.sin() - 0.5 * (2.0 * phase).sin()
    };
    (0..samples)
        .map(|i| core::array::from_fn(|limb| (10.0 + limb as f64) * wave(i)))
        .collect()
}

#[test]
fn inv_voltages_become_the_forces_that_made_them() {
    let sensor = TrueSensor::identified();
    let gain_n_per_v = [2.0; LIMBS];
    let (rate_hz, forces) = (1000.0, forces(1000, 1000.0));
    let mut rng = Pcg64::new(1, 1);
    let chain = Chain {
        full_scale_v: f64::INFINITY,
        ..Chain::noise_free()
    };
    let voltage_v = chain.record(&forces, &sensor, &gain_n_per_v, rate_hz, &mut rng);
    let mut parameters = truth::parameters(&sensor);
    let off = |parameters: &Parameters| {
        let signal = SignalChain::new(&Gains { gain_n_per_v }, parameters);
        largest(voltage_v.iter().zip(&forces).flat_map(|(row, force)| {
            let found = signal.force_per_mass_m_s2(row);
            (0..LIMBS).map(move |i| (found[i] - force[i]) / 10.0)
        }))
    };
    within("forces", off(&parameters), tolerance::LAST_DIGITS);
    parameters.scale_per_mass_per_kg[3] *= 1.01;
    fails_clearly(
        "a scale off by 1 %",
        off(&parameters),
        tolerance::LAST_DIGITS,
    );
}

#[test]
fn inv_a_compliant_truth_is_decoded_for_a_minute() {
    const RATE_HZ: f64 = 1000.0;
    let sensor = TrueSensor::identified();
    let journey = Journey::random(Kind::Vehicle, &mut Pcg64::new(u128::from(seed()), 1));
    let gravity_ground_m_s2 = journey.gravity_ground_m_s2();
    let motion: Vec<_> = journey.play(RATE_HZ).take(60_000).collect();
    let settings = Settings {
        gravity_ground_m_s2,
        ..Settings::new(RATE_HZ)
    };
    let model = Sensor {
        geometry: sixaxis_core::Geometry::PAPER,
        gains: Gains {
            gain_n_per_v: [20.0; LIMBS],
        },
    };
    let decoupler = Decoupler::new(&model, &truth::parameters(&sensor), &settings).expect("sound");
    let off_rad_s =
        |forces: &[[f64; LIMBS]]| {
            let mut decoupler = decoupler.clone();
            let tared = |force: &[f64; LIMBS]| core::array::from_fn(|i| force[i] - forces[0][i]);
            let decoded = forces.iter().filter_map(|force| {
                let voltage_v = sensor.voltage_v(&tared(force), &model.gains.gain_n_per_v);
                decoupler.push(&voltage_v).expect("finite")
            });
            largest(decoded.zip(&motion[1..]).map(|(decoded, truth)| {
                (decoded.rate_shell_rad_s - truth.rate_shell_rad_s).length()
            }))
        };
    let compliant = compliant_forces_m_s2(&sensor, gravity_ground_m_s2, &motion);
    let compliant = compliant.expect("limbs that hold the mass");
    within(
        "rate, rad/s",
        off_rad_s(&compliant),
        tolerance::COMPLIANT_RATE,
    );
    // The forces of limbs that do not give way turn no arm: 1e-6 of gravity's torque, for a minute.
    let rigid = RigidSensor::new(&sensor, &[1.0; LIMBS]).expect("limbs that hold the mass");
    let undeformed = motion.iter().map(|truth| {
        let angular = truth.attitude.inverse() * truth.angular_ground_rad_s2;
        rigid.forces_m_s2(&Load {
            specific_force_m_s2: truth.specific_force_shell_m_s2(gravity_ground_m_s2),
            torque_m2_s2: torque_per_mass(
                &sensor.inertia_per_mass,
                truth.rate_shell_rad_s,
                angular,
            ),
        })
    });
    let undeformed: Vec<_> = undeformed.collect();
    fails_clearly(
        "limbs that do not give way",
        off_rad_s(&undeformed),
        tolerance::COMPLIANT_RATE,
    );
}

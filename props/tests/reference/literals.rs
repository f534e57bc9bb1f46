//! A second MuJoCo model of the sensor, written from what the paper prints: equations (5) and (6), L, n and Tables 1 to 3 stand here as
//! literals. Neither core's geometry nor the reference's model, drive or integrator has a part in it; both are held against it.
//!
//! The shell is a body on a slider and a pinion along one axis, ten orders of magnitude heavier than the mass, and MuJoCo takes its own
//! steps. Its force is held for a step at the value in the middle of the step, which departs from the motion law by (w h)^2.

use core::f64::consts::TAU;
use std::fmt::Write as _;

use glam::DVec3;
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use sixaxis_core::{Gains, InertiaPerMass, Parameters, Scheme, Sensor, Settings};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::tolerance;
use sixaxis_reference::motion::Motion;
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::mujoco::simulate;
use sixaxis_reference::sensor::TrueSensor;

/// Equation (5): directions of the limbs, columns limb 1 to 9.
const E: [[i8; 9]; 3] = [
    [0, 0, -1, 0, 0, -1, 0, 0, 1],
    [0, -1, 0, 0, 1, 0, 0, -1, 0],
    [1, 0, 0, -1, 0, 0, -1, 0, 0],
];
/// Equation (6) over n: where they act on the mass.
const T: [[i8; 9]; 3] = [
    [0, 0, 0, 0, 0, 0, -1, -1, -1],
    [0, 0, 0, -1, -1, -1, 0, 0, 0],
    [-1, -1, -1, 0, 0, 0, 0, 0, 0],
];
/// L and n, m.
const L: f64 = 0.0255;
const N: f64 = 0.021;
/// Table 1, V.
const D: [f64; 9] = [
    -0.0123, 0.0168, -0.0155, -0.0101, -0.0047, -0.0166, -0.0117, -0.0083, -0.0109,
];
/// Table 2, 1/kg.
const S_OVER_M: [f64; 9] = [
    5.0892, 3.5501, 6.1199, 3.2308, 4.8763, 7.0909, 3.6896, 3.1624, 3.1838,
];
/// Table 3, identified, m^2: I1 to I6.
const I_OVER_M: [f64; 6] = [
    191.0846e-6,
    236.4900e-6,
    326.5389e-6,
    0.0804e-6,
    -0.3794e-6,
    1.5799e-6,
];
/// Fig. 10, 1/s^2.
const K_OVER_M: f64 = 2.0e8;
/// Any mass, kg: only ratios to it matter.
const M: f64 = 0.2;
/// Damping of a limb over the mass, 1/s: 2 % of 2 sqrt(k/m), which the paper neglects and the reference has.
const C_OVER_M: f64 = 565.685_424_949_238;

/// Mass of the shell, kg, and its inertia, kg m^2: so large that the limbs do not move it.
const SHELL: f64 = 1e10;
const STEP_S: f64 = 1e-5;
const STEPS_PER_SAMPLE: usize = 10;
const RATE_HZ: f64 = 1e4;
const SAMPLES: usize = 2001;

/// Travel and turning along one direction, A (1 - cos w t)^2 / 4: once to and fro in 0.2 s, from rest and without a jump. The rig's
/// amplitudes at 5 Hz.
#[derive(Clone, Copy)]
struct Swing;

impl Swing {
    const FREQUENCY_HZ: f64 = 5.0;
    const TRAVEL_M: f64 = 0.093;
    const TURN_RAD: f64 = 1.746;

    fn direction() -> DVec3 {
        DVec3::new(1.0, 1.0, 2.0).normalize()
    }

    fn second_derivative(time_s: f64) -> f64 {
        let w = TAU * Self::FREQUENCY_HZ;
        0.5 * w * w * ((w * time_s).cos() - (2.0 * w * time_s).cos())
    }
}

impl Motion for Swing {
    fn acceleration(&self, time_s: f64) -> (DVec3, DVec3) {
        let along = Self::direction() * Self::second_derivative(time_s);
        (along * Self::TRAVEL_M, along * Self::TURN_RAD)
    }
}

fn mjcf(e: &[[i8; 9]; 3]) -> String {
    let d = Swing::direction();
    let [i1, i2, i3, i4, i5, i6] = I_OVER_M.map(|i| i * M);
    let (mut shell, mut mass, mut tendons) = (String::new(), String::new(), String::new());
    for limb in 0..9 {
        let t = [0, 1, 2].map(|axis| f64::from(T[axis][limb]) * N);
        let b = [0, 1, 2].map(|axis| t[axis] - f64::from(e[axis][limb]) * L);
        let i = limb + 1;
        let _ = write!(
            shell,
            "<site name='b{i}' pos='{} {} {}'/>",
            b[0], b[1], b[2]
        );
        let _ = write!(mass, "<site name='t{i}' pos='{} {} {}'/>", t[0], t[1], t[2]);
        let _ = write!(
            tendons,
            "<spatial stiffness='{}' damping='{}' springlength='{L}'><site site='b{i}'/><site site='t{i}'/></spatial>",
            K_OVER_M * M,
            C_OVER_M * M,
        );
    }
    format!(
        "<mujoco><compiler angle='radian' balanceinertia='false'/>
        <option integrator='RK4' timestep='{STEP_S}' gravity='0 0 0'><flag contact='disable' constraint='disable'/></option>
        <worldbody>
        <body><joint type='slide' axis='{} {} {}'/><joint type='hinge' axis='{} {} {}'/>
        <inertial pos='0 0 0' mass='{SHELL}' diaginertia='{SHELL} {SHELL} {SHELL}'/>{shell}</body>
        <body><freejoint/><inertial pos='0 0 0' mass='{M}' fullinertia='{i1} {i2} {i3} {i4} {i5} {i6}'/>{mass}</body>
        </worldbody><tendon>{tendons}</tendon></mujoco>",
        d.x, d.y, d.z, d.x, d.y, d.z
    )
}

/// Forces over the mass, m/s^2, positive in compression, sample by sample.
fn forces(e: &[[i8; 9]; 3]) -> Vec<[f64; 9]> {
    let model = MjModel::from_xml_string(&mjcf(e)).expect("a model that MuJoCo takes");
    let mut data = MjData::new(Box::new(model));
    let mut forces = Vec::new();
    for step in 0..(SAMPLES - 1) * STEPS_PER_SAMPLE + 1 {
        if step % STEPS_PER_SAMPLE == 0 {
            data.fwd_position();
            data.fwd_velocity();
            let (length, velocity) = (data.ten_length(), data.ten_velocity());
            forces.push(core::array::from_fn(|i| {
                K_OVER_M * (L - length[i]) - C_OVER_M * velocity[i]
            }));
        }
        let middle = Swing::second_derivative((step as f64 + 0.5) * STEP_S) * SHELL;
        data.qfrc_applied_mut()[0] = middle * Swing::TRAVEL_M;
        data.qfrc_applied_mut()[1] = middle * Swing::TURN_RAD;
        data.step();
    }
    forces
}

fn departure(ours: &[[f64; 9]], truth: &[[f64; 9]]) -> f64 {
    assert_eq!(ours.len(), truth.len());
    let pairs = ours.iter().zip(truth);
    let apart = pairs.flat_map(|(a, b)| (0..9).map(move |i| a[i] - b[i]));
    largest(apart) / largest(truth.iter().flatten().copied())
}

/// A limb of equation (5) turned round, as a slip of the pen would.
fn one_sign_wrong() -> [[i8; 9]; 3] {
    let mut e = E;
    e[1][4] = -1;
    e
}

#[test]
fn ref_the_model_is_that_of_the_paper_s_literals() {
    let model = SensorModel {
        gravity_ground_m_s2: DVec3::ZERO,
        ..SensorModel::new(&TrueSensor::identified(), DVec3::ZERO)
    };
    let duration_s = (SAMPLES - 1) as f64 / RATE_HZ;
    let ours = simulate(&model, &Swing, duration_s, RATE_HZ, 4)
        .expect("the step is stable")
        .limb_force_per_mass_m_s2;
    let off = |e| departure(&ours, &forces(e));
    within("limb forces", off(&E), tolerance::LITERAL_FORCES);
    fails_clearly(
        "a sign of (5) wrong",
        off(&one_sign_wrong()),
        tolerance::LITERAL_FORCES,
    );
}

#[test]
fn ref_voltages_of_the_paper_s_literals_are_decoupled() {
    const GAIN_N_PER_V: f64 = 20.0;
    let parameters = Parameters {
        zero_drift_v: D,
        scale_per_mass_per_kg: S_OVER_M,
        inertia_per_mass: InertiaPerMass::from_paper_order(I_OVER_M),
        stiffness_per_mass_per_s2: K_OVER_M,
    };
    let sensor = Sensor {
        geometry: sixaxis_core::Geometry::PAPER,
        gains: Gains {
            gain_n_per_v: [GAIN_N_PER_V; 9],
        },
    };
    let settings = Settings {
        scheme: Scheme::AdamsMoulton4,
        gravity_ground_m_s2: DVec3::ZERO,
        ..Settings::new(RATE_HZ)
    };
    let off = |e| {
        // (11) solved for u.
        let rows = forces(e)
            .into_iter()
            .map(|force| core::array::from_fn(|i| D[i] + force[i] / (S_OVER_M[i] * GAIN_N_PER_V)));
        let voltage_v: Vec<[f64; 9]> = rows.collect();
        let found = sixaxis_core::decouple::decouple(&sensor, &parameters, &settings, &voltage_v)
            .expect("finite voltages");
        let (mut error, mut peak) = ([0.0; 2], [0.0; 2]);
        for sample in &found {
            let (linear, angular) = Swing.acceleration(sample.sample as f64 / RATE_HZ);
            let both = [
                (sample.linear_ground_m_s2, linear),
                (sample.angular_ground_rad_s2, angular),
            ];
            for (i, (ours, truth)) in both.into_iter().enumerate() {
                error[i] = largest([error[i], (ours - truth).length()]);
                peak[i] = largest([peak[i], truth.length()]);
            }
        }
        largest([error[0] / peak[0], error[1] / peak[1]])
    };
    within("accelerations", off(&E), tolerance::LITERAL_DECOUPLED);
    fails_clearly(
        "a sign of (5) wrong",
        off(&one_sign_wrong()),
        tolerance::LITERAL_DECOUPLED,
    );
}

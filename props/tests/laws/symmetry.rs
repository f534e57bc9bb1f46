//! What must not change, and what must change along, when the same sensor is looked at in another way.

use glam::{DMat3, DQuat, DVec3};
use proptest::prelude::*;
use sixaxis_core::decouple::decouple;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::{Geometry, InertiaPerMass, LIMBS, Scheme, SixAxis};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::manufactured::examples;
use sixaxis_props::manufactured::formulations::{Mass, ShellMotion, solve};
use sixaxis_props::manufactured::motion::Manufactured;
use sixaxis_props::problem::rig::simulate;
use sixaxis_props::problem::{Problem, UNEQUAL_GAINS};
use sixaxis_props::strategy::{config, manufactured};
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_props::truth::InCore;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::paper;
use sixaxis_reference::rig::run::{Mode, Mounting};

const SAMPLES: usize = 200;
const SAMPLES_PER_PERIOD: f64 = 150.0;

/// A manufactured motion from its true state at the first decoupled sample.
fn problem(sensor: &Manufactured, truth: &[ShellMotion], rate_hz: f64) -> Problem {
    Problem::manufactured(
        sensor,
        UNEQUAL_GAINS,
        rate_hz,
        truth.len(),
        Scheme::default(),
    )
    .starting(truth[1].attitude, truth[1].rate_shell_rad_s)
}

fn rate_hz(sensor: &Manufactured) -> f64 {
    sensor.highest_frequency_hz() * SAMPLES_PER_PERIOD
}

fn setup(sensor: &Manufactured) -> Problem {
    let truth = solve::<Mass>(sensor, rate_hz(sensor), SAMPLES, 1);
    problem(sensor, &truth, rate_hz(sensor))
}

/// Largest difference of accelerations and rates over their largest, with the first set turned or scaled before.
fn apart(
    a: &[SixAxis],
    b: &[SixAxis],
    linear: impl Fn(DVec3) -> DVec3,
    angular: impl Fn(DVec3) -> DVec3,
    rate: impl Fn(DVec3) -> DVec3,
) -> f64 {
    assert_eq!(a.len(), b.len(), "samples");
    let over = |get: fn(&SixAxis) -> DVec3, change: &dyn Fn(DVec3) -> DVec3| {
        let peak = largest(b.iter().map(|s| get(s).length()));
        largest(
            a.iter()
                .zip(b)
                .map(|(a, b)| (change(get(a)) - get(b)).length()),
        ) / peak
    };
    largest([
        over(|s| s.linear_ground_m_s2, &linear),
        over(|s| s.angular_ground_rad_s2, &angular),
        over(|s| s.rate_shell_rad_s, &rate),
    ])
}

/// The limb that limb i becomes when x is called y, y z and z x: found from the drawing, not written down.
fn relabelled(cycle: DMat3) -> [usize; LIMBS] {
    let hinges = Geometry::PAPER.mass_hinges_m();
    core::array::from_fn(|i| {
        (0..LIMBS)
            .find(|&j| {
                cycle * DIRECTIONS_SHELL[i] == DIRECTIONS_SHELL[j] && cycle * hinges[i] == hinges[j]
            })
            .expect("the drawing looks the same from all three axes")
    })
}

fn moved<T: Copy>(values: &[T; LIMBS], to: &[usize; LIMBS]) -> [T; LIMBS] {
    let mut result = *values;
    for (value, &j) in values.iter().zip(to) {
        result[j] = *value;
    }
    result
}

fn turned_inertia(inertia: &InertiaPerMass, turn: DMat3) -> InertiaPerMass {
    let m = turn * inertia.matrix_mass_m2() * turn.transpose();
    InertiaPerMass::from_paper_order([
        m.x_axis.x, m.y_axis.y, m.z_axis.z, m.y_axis.x, m.z_axis.x, m.z_axis.y,
    ])
}

proptest! {
    #![proptest_config(config(24))]

    #[test]
    fn inv_calling_x_y_and_so_on_permutes_the_outputs(sensor in manufactured(), scheme in prop::sample::select(&Scheme::ALL[..])) {
        let mut usual = setup(&sensor);
        usual.settings.scheme = scheme;
        let cycle = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
        let turn = DQuat::from_mat3(&cycle);
        let to = relabelled(cycle);
        let mut other = usual.clone();
        other.sensor.gains.gain_n_per_v = moved(&usual.sensor.gains.gain_n_per_v, &to);
        let p = &mut other.parameters;
        p.zero_drift_v = moved(&usual.parameters.zero_drift_v, &to);
        p.scale_per_mass_per_kg = moved(&usual.parameters.scale_per_mass_per_kg, &to);
        p.inertia_per_mass = turned_inertia(&usual.parameters.inertia_per_mass, cycle);
        let s = &mut other.settings;
        s.gravity_ground_m_s2 = cycle * usual.settings.gravity_ground_m_s2;
        s.initial_rate_shell_rad_s = cycle * usual.settings.initial_rate_shell_rad_s;
        s.initial_attitude = (turn * usual.settings.initial_attitude * turn.inverse()).normalize();
        other.voltage_v = usual.voltage_v.iter().map(|row| moved(row, &to)).collect();
        let (a, b) = (usual.decouple(), other.decouple());
        let cycled = |v: DVec3| cycle * v;
        within("outputs of the relabelled sensor", apart(&a, &b, cycled, cycled, cycled), tolerance::SYMMETRY);
        let back = |v: DVec3| cycle.transpose() * v;
        fails_clearly("outputs relabelled the other way", apart(&a, &b, back, back, back), tolerance::SYMMETRY);
    }

    #[test]
    fn inv_turning_the_ground_turns_what_is_told_in_it(sensor in manufactured(), turn in prop::array::uniform3(-3.0..3.0_f64)) {
        let usual = setup(&sensor);
        let turn = DQuat::from_scaled_axis(DVec3::from_array(turn));
        let mut other = usual.clone();
        other.settings.gravity_ground_m_s2 = turn * usual.settings.gravity_ground_m_s2;
        other.settings.initial_attitude = (turn * usual.settings.initial_attitude).normalize();
        let (a, b) = (usual.decouple(), other.decouple());
        let turned = |v: DVec3| turn * v;
        within("outputs on turned ground", apart(&a, &b, turned, turned, |w| w), tolerance::SYMMETRY);
    }

    #[test]
    fn inv_only_the_product_of_gain_and_scale_matters(sensor in manufactured(), factors in prop::array::uniform9(0.2..5.0_f64)) {
        let usual = setup(&sensor);
        let mut other = usual.clone();
        for (i, factor) in factors.into_iter().enumerate() {
            other.sensor.gains.gain_n_per_v[i] *= factor;
            other.parameters.scale_per_mass_per_kg[i] /= factor;
        }
        within("outputs at another gain", apart(&usual.decouple(), &other.decouple(), |v| v, |v| v, |v| v), tolerance::SYMMETRY);
    }

    /// All lengths times l, at the same k/m: forces and linear accelerations grow with l, angular ones do not.
    #[test]
    fn inv_a_larger_sensor_is_the_same_sensor_on_another_scale(sensor in manufactured(), l in 0.3..3.0_f64) {
        let mut usual = setup(&sensor);
        usual.settings.gravity_ground_m_s2 = DVec3::ZERO;
        let mut other = usual.clone();
        other.sensor.geometry.limb_length_m *= l;
        other.sensor.geometry.half_edge_m *= l;
        let i = usual.parameters.inertia_per_mass.to_paper_order();
        other.parameters.inertia_per_mass = InertiaPerMass::from_paper_order(i.map(|i| i * l * l));
        other.parameters.scale_per_mass_per_kg = usual.parameters.scale_per_mass_per_kg.map(|s| s * l);
        within("outputs of the larger sensor", apart(&usual.decouple(), &other.decouple(), |v| v * l, |v| v, |v| v), tolerance::SYMMETRY);
    }

    /// Time runs backwards: forces, poses and accelerations are the same, rates change sign. Runge-Kutta over pairs of
    /// samples has the same order either way.
    #[test]
    fn inv_time_reversed_motion_has_the_same_accelerations(sensor in manufactured()) {
        // Sampled for the turning of the shell as well as for the vibration.
        let coarse = solve::<Mass>(&sensor, rate_hz(&sensor), SAMPLES, 1);
        let turning = largest(coarse.iter().map(|t| t.rate_shell_rad_s.length()));
        let vibration = core::f64::consts::TAU * sensor.highest_frequency_hz();
        let rate_hz = rate_hz(&sensor) * (1.0 + turning / vibration);
        let truth = solve::<Mass>(&sensor, rate_hz, SAMPLES, 1);
        let mut usual = problem(&sensor, &truth, rate_hz);
        usual.settings.scheme = Scheme::RungeKutta4;
        let mut reversed = usual.clone();
        reversed.voltage_v.reverse();
        let last = &truth[SAMPLES - 2];
        reversed.settings.initial_attitude = last.attitude;
        reversed.settings.initial_rate_shell_rad_s = -last.rate_shell_rad_s;
        let a = usual.decouple();
        let mut b = reversed.decouple();
        b.reverse();
        within("outputs in reversed time", apart(&a, &b, |v| v, |v| v, |w| -w), tolerance::TIME_REVERSAL);
        fails_clearly("rates that keep their sign", apart(&a, &b, |v| v, |v| v, |w| w), tolerance::TIME_REVERSAL);
    }
}

#[test]
fn inv_a_wrong_relabelling_is_noticed() {
    let usual = setup(&examples::turning());
    let a = usual.decouple();
    for (i, j) in [(0, 1), (1, 3), (2, 6), (5, 7), (0, 4), (3, 8)] {
        let mut swapped = usual.clone();
        for row in &mut swapped.voltage_v {
            row.swap(i, j);
        }
        let b = swapped.decouple();
        let what = format!("channels {} and {} swapped", i + 1, j + 1);
        fails_clearly(
            &what,
            apart(&a, &b, |v| v, |v| v, |v| v),
            tolerance::SYMMETRY,
        );
    }
}

#[test]
fn inv_pure_translation_has_no_rate_at_the_true_stiffness_alone() {
    let parameters = truth::identified_parameters();
    let direction = DVec3::new(1.0, 1.0, 2.0);
    let run = simulate(&parameters, Mode::Linear, direction, Mounting::AxisVertical);
    let recording = Laboratory::noise_free(truth::sensor(&parameters)).record(&run, 0);
    let rate = |stiffness_per_mass_per_s2: f64| {
        let mut candidate = parameters;
        candidate.stiffness_per_mass_per_s2 = stiffness_per_mass_per_s2;
        let settings = recording.settings(Scheme::Heun);
        let sensor = recording.sensor();
        let samples = decouple(&sensor, &candidate, &settings, &recording.voltage_v)
            .expect("a sound sensor and finite samples");
        largest(samples.iter().map(|s| s.rate_shell_rad_s.length()))
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
    let parameters = truth::identified_parameters();
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

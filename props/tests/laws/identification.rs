//! The four steps on exact rows, and what they say when the data cannot answer.

use glam::DVec3;
use proptest::prelude::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::identify::inertia::{InertiaIdentification, euler_torque, regressor};
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::identify::{stiffness, zero_drift};
use sixaxis_core::paper::wrench::LimbWrench;
use sixaxis_core::significance::NORMAL_95;
use sixaxis_core::{Geometry, InertiaPerMass, LIMBS, Parameters};
use sixaxis_props::compare::{largest, within};
use sixaxis_props::rigid::forces;
use sixaxis_props::strategy::{config, parameters, vector};
use sixaxis_props::tolerance;

fn measured_n(force: &[f64; LIMBS], parameters: &Parameters) -> [f64; LIMBS] {
    core::array::from_fn(|i| force[i] / parameters.scale_per_mass_per_kg[i])
}

/// Static records of white noise, and samples of each.
const RECORDS: usize = 3000;
const AT_REST: usize = 640;

/// 95 % intervals keep what they say in the middle and in the tails, where a standard error from a few batches has too many.
#[test]
fn stat_a_zero_drifts_interval_has_normal_tails() {
    let mut rng = Pcg64::seed_from_u64(0x7a11);
    let (mut beyond_one, mut beyond_two) = (0_u32, 0_u32);
    for _ in 0..RECORDS {
        let rows: Vec<[f64; LIMBS]> = (0..AT_REST)
            .map(|_| core::array::from_fn(|_| StandardNormal.sample(&mut rng)))
            .collect();
        let found = zero_drift::identify(&rows).expect("the record is long enough");
        for limb in 0..LIMBS {
            let widths = (found.drift_v[limb] / found.standard_error_v[limb]).abs() / NORMAL_95;
            beyond_one += u32::from(widths > 1.0);
            beyond_two += u32::from(widths > 2.0);
        }
    }
    // Of the larger of two standard errors a little less than one in twenty is beyond; of a normal one's, 2.4 of 27,000 are beyond
    // twice that, of one by 32 batches alone 12.
    let of = (RECORDS * LIMBS) as f64;
    let outside = f64::from(beyond_one) / of;
    assert!((0.03..0.05).contains(&outside), "{outside}");
    assert!(beyond_two <= 6, "{beyond_two} of {of}");
}

/// The same where noise goes on growing towards low frequencies, as an amplifier's does: as much in each octave as in the next, down to the
/// record's length.
#[test]
fn stat_a_zero_drifts_interval_holds_with_noise_of_low_frequency() {
    const OCTAVES: usize = 11;
    let mut rng = Pcg64::seed_from_u64(0x7a12);
    let mut beyond = [0_u32; 2];
    for _ in 0..RECORDS / 10 {
        let mut held = [[0.0; LIMBS]; OCTAVES];
        let rows: Vec<[f64; LIMBS]> = (0..1 << OCTAVES)
            .map(|sample: usize| {
                let mut row = core::array::from_fn(|_| StandardNormal.sample(&mut rng));
                for (octave, held) in held.iter_mut().enumerate() {
                    if sample.is_multiple_of(2 << octave) {
                        *held = core::array::from_fn(|_| StandardNormal.sample(&mut rng));
                    }
                    (row.iter_mut().zip(held)).for_each(|(u, held): (&mut f64, _)| *u += *held);
                }
                row
            })
            .collect();
        let found = zero_drift::identify(&rows).expect("the record is long enough");
        for limb in 0..LIMBS {
            let widths = (found.drift_v[limb] / found.standard_error_v[limb]).abs() / NORMAL_95;
            beyond[0] += u32::from(widths > 1.0);
            beyond[1] += u32::from(widths > 2.0);
        }
    }
    let of = (RECORDS / 10 * LIMBS) as f64;
    let [one, two] = beyond.map(|count| f64::from(count) / of);
    // With the error by 32 batches it would be 0.6 and 0.3.
    assert!(one < 0.12 && two < 0.02, "{one}, {two}");
}

proptest! {
    #![proptest_config(config(64))]

    #[test]
    fn prop_step_1_finds_the_drift(parameters in parameters()) {
        let rows = vec![parameters.zero_drift_v; 1000];
        let found = zero_drift::identify(&rows).expect("the record is long enough");
        let error = largest((0..LIMBS).map(|i| found.drift_v[i] - parameters.zero_drift_v[i]));
        within("zero drift", error, tolerance::ROUNDING);
    }

    #[test]
    fn prop_step_2_finds_the_scale_factors(
        parameters in parameters(),
        motions in prop::collection::vec(vector(90.0), 8..20),
    ) {
        let mut step = ScaleIdentification::default();
        for a in &motions {
            let force = forces(*a, DVec3::ZERO);
            step.push(&measured_n(&force, &parameters), *a).expect("rows are finite");
        }
        let found = step.solve().expect("eight random accelerations span space");
        let error = largest((0..LIMBS).map(|i| {
            found.estimate.values[i] / parameters.scale_per_mass_per_kg[i] - 1.0
        }));
        within("scale per mass", error / found.estimate.condition, tolerance::EXACT_ROWS);
        prop_assert!(found.verdict.is_determined());
    }

    #[test]
    fn prop_step_3_finds_inertia_and_gyroscope_gain(
        parameters in parameters(),
        motions in prop::collection::vec((vector(20.0), vector(400.0)), 12..24),
        gain in 0.97..1.03_f64,
    ) {
        let tensor = parameters.inertia_per_mass;
        let size = largest(tensor.to_paper_order());
        let error = |found: &InertiaPerMass| {
            let (a, b) = (found.to_paper_order(), tensor.to_paper_order());
            largest((0..6).map(|i| a[i] - b[i])) / size
        };
        let mut exact = InertiaIdentification::new(Geometry::PAPER);
        let mut misread = exact.clone();
        for (w, dw) in &motions {
            let force = forces(DVec3::ZERO, euler_torque(&tensor, *w, *dw));
            exact.push(&force, *w, *dw).expect("rows are finite");
            misread.push(&force, *w / gain, *dw / gain).expect("rows are finite");
        }
        let found = exact.solve().expect("random motions excite everything");
        within("inertia per mass", error(&found.inertia_per_mass), tolerance::EXACT_ROWS);
        let found = misread.solve_with_gain().expect("random motions excite everything");
        within("gyroscope gain", (found.rate_over_reading - gain).abs(), tolerance::GAIN);
        within("inertia with gain", error(&found.inertia.inertia_per_mass), tolerance::GAIN);
    }

    #[test]
    fn prop_regressor_times_parameters_is_the_torque(
        parameters in parameters(), w in vector(50.0), dw in vector(2000.0),
    ) {
        let i = parameters.inertia_per_mass.to_paper_order();
        let torque = euler_torque(&parameters.inertia_per_mass, w, dw);
        let rows = regressor(w, dw);
        let product = DVec3::from_array(rows.map(|row| (0..6).map(|j| row[j] * i[j]).sum()));
        let scale = (dw.length() + w.length_squared()) * largest(i);
        within("W times I", (product - torque).length() / scale, tolerance::ROUNDING);
    }

    #[test]
    fn prop_torque_comes_from_three_pairs_of_limbs(force in prop::array::uniform9(-50.0..50.0_f64)) {
        // Eq. (19): n(-s2 f2 + s4 f4, s3 f3 - s7 f7, -s6 f6 + s8 f8)/m.
        let n = Geometry::PAPER.half_edge_m;
        let f = force;
        let printed = n * DVec3::new(f[3] - f[1], f[2] - f[6], f[7] - f[5]);
        let ours = LimbWrench::at_rest(&Geometry::PAPER, &force).torque_shell_m2_s2;
        within("torque", (ours - printed).length() / (n * largest(force)), tolerance::ROUNDING);
    }
}

#[test]
fn law_step_4_tells_a_minimum_from_a_slope() {
    let curve = |f: &dyn Fn(f64) -> f64| {
        stiffness::paper_grid()
            .map(|k| (k, f(1.0 / k)))
            .collect::<Vec<_>>()
    };
    let (x0, floor) = (1.0 / 2.03e8, 1e-12);
    let valley = curve(&|x| (x - x0).abs().hypot(floor));
    let judged = stiffness::judge(&valley).expect("the curve is finite");
    assert!(judged.verdict.is_determined());
    within(
        "vertex between grid points",
        (judged.interpolated_per_s2 * x0 - 1.0).abs(),
        tolerance::GAIN,
    );
    for (what, curve) in [
        ("slope", curve(&|x| 1.0 + x * 1e8)),
        ("dent", curve(&|x| 1.0 + (x - x0).abs())),
    ] {
        let judged = stiffness::judge(&curve).expect("the curve is finite");
        assert!(
            !judged.verdict.is_determined(),
            "a {what} passes for a valley"
        );
    }
}

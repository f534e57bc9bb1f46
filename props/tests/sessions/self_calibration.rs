//! Self-calibration: exact without noise, in MuJoCo too; as good as it says with it; and what it refuses, names and tests.

use core::f64::consts::TAU;

use glam::{DQuat, DVec3};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::redundancy::self_calibration::{
    Accumulator, KnownChange, Limits, PerLimbs, ScaleRatios, StiffnessTest, drifted,
};
use sixaxis_core::{Error, Gains, Geometry, LIMBS, LimbSet, Sensor, Settings};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::evidence::Row;
use sixaxis_props::problem::Problem;
use sixaxis_props::seed::seed;
use sixaxis_props::self_calibration::{Case, DRIFT, NOISE_SHARE, errors, nine, without_mean};
use sixaxis_props::statistics::chi_square_departure;
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_reference::compliant::compliant_forces_m_s2;
use sixaxis_reference::motion::{Motion, TrueMotion};
use sixaxis_reference::paper;
use sixaxis_reference::rig::field::{Field, Pace};
use sixaxis_reference::smooth_step::smooth_step;

/// Length of short field recordings, s.
const SHORT_S: f64 = 2.0;
/// Recordings over which intervals are judged.
const CASES: u64 = 200;
/// Noise over the peak at which plain least squares bends ratios by several deviations.
const HEAVY_NOISE_SHARE: f64 = 0.02;
/// Rate of false alarms where one is asked for.
const FALSE_ALARM: f64 = 0.01;

#[test]
fn law_ratios_without_noise_are_exact() {
    let first = seed();
    let each = (first..first + 4).into_par_iter().map(|seed| {
        let mut case = Case::random(seed, SHORT_S);
        // A common factor would stay, and change the second order by as much.
        let common = case.true_ln_scale().iter().sum::<f64>() / LIMBS as f64;
        for scale in &mut case.calibration.scale_per_mass_per_kg {
            *scale *= common.exp();
        }
        let voltage_v = case.voltage_v();
        // Once for the second order, which wants the scale factors, once for the ratios.
        let mut without = f64::INFINITY;
        for _ in 0..2 {
            let taken = fed(sample_by_sample(&case), &voltage_v);
            let found = taken.ratios(&Limits::default()).expect("a rich motion");
            let flat = taken.moments().to_first_order().ratios(&Limits::default());
            without = without.min(largest(errors(
                &flat.expect("a rich motion"),
                &case.true_ln_ratio(),
            )));
            case.calibration.zero_drift_v = case.truth.zero_drift_v;
            for (scale, ln) in case
                .calibration
                .scale_per_mass_per_kg
                .iter_mut()
                .zip(found.ln_ratio)
            {
                *scale *= ln.exp();
            }
        }
        (largest(case.true_ln_ratio()), without)
    });
    let (worst, without) =
        each.reduce(|| (0.0, f64::INFINITY), |a, b| (a.0.max(b.0), a.1.min(b.1)));
    within(
        "ln ratios of scale factors, poses in closed form",
        worst,
        tolerance::RATIOS_CLOSED_FORM,
    );
    fails_clearly(
        "the same without the second order",
        without,
        tolerance::RATIOS_CLOSED_FORM,
    );
}

/// The paper's sensor in MuJoCo, tumbled, with scale factors known one by one as well as `DRIFT`; and the true ln ratios.
fn in_mujoco(
    motion: &(impl Motion + Clone),
    duration_s: f64,
    steps_per_sample: usize,
) -> (Problem, [f64; LIMBS]) {
    let truth = truth::identified_parameters();
    let gravity = DVec3::new(0.0, 0.0, -paper::GRAVITY_M_S2);
    let model = truth::model(&truth, gravity);
    let rate_hz = 4_000.0;
    let run =
        sixaxis_reference::mujoco::simulate(&model, motion, duration_s, rate_hz, steps_per_sample)
            .expect("a simulation");
    let gains = Gains::uniform(0.1);
    let chain = SignalChain::new(&gains, &truth);
    let rest = run.limb_force_per_mass_m_s2[0];
    let tared = |f: &[f64; LIMBS]| core::array::from_fn(|i| f[i] - rest[i]);
    let forces = run.limb_force_per_mass_m_s2.iter();
    let unit = nine(&mut Pcg64::new(u128::from(seed()), 21));
    let mut calibration = truth;
    for (scale, unit) in calibration.scale_per_mass_per_kg.iter_mut().zip(unit) {
        *scale *= (-DRIFT * unit).exp();
    }
    let problem = Problem {
        sensor: Sensor {
            geometry: Geometry::PAPER,
            gains,
        },
        parameters: calibration,
        settings: Settings {
            gravity_ground_m_s2: gravity,
            ..Settings::new(rate_hz)
        },
        voltage_v: forces.map(|f| chain.voltage_v(&tared(f))).collect(),
    };
    (problem, without_mean(unit.map(|unit| DRIFT * unit)))
}

/// An accumulator of blocks of one sample.
fn sample_by_sample(case: &Case) -> Accumulator {
    Accumulator::new(&case.sensor(), &case.calibration, &case.settings(), 1).expect("sound")
}

fn in_usual_blocks(case: &Case) -> Accumulator {
    Accumulator::of_usual_blocks(&case.sensor(), &case.calibration, &case.settings())
        .expect("sound")
}

fn fed(mut accumulator: Accumulator, voltage_v: &[[f64; LIMBS]]) -> Accumulator {
    for u in voltage_v {
        accumulator.push(u).expect("sound");
    }
    accumulator
}

fn accumulated(p: &Problem) -> Accumulator {
    let empty = Accumulator::of_usual_blocks(&p.sensor, &p.parameters, &p.settings);
    fed(empty.expect("sound"), &p.voltage_v)
}

#[test]
fn ref_a_tumble_in_mujoco_tells_eight_ratios() {
    let field = Field::by_hand(
        &mut Pcg64::new(u128::from(seed()), 20),
        Pace::Brisk,
        0.0,
        1.0,
    );
    let found = |steps: usize| {
        let (run, true_ln_ratio) = in_mujoco(&field.motion, 2.0, steps);
        let moments = accumulated(&run).moments();
        let ratios = moments.ratios(&Limits::default()).expect("a rich motion");
        let wrong = moments.to_first_order().ratios(&Limits::default());
        (
            errors(&ratios, &true_ln_ratio),
            errors(&wrong.expect("a rich motion"), &true_ln_ratio),
        )
    };
    let [(coarse, without), (fine, _)] = [10, 20].map(found);
    let halved = largest((0..LIMBS).map(|i| coarse[i] - fine[i]));
    Row::new(
        "ln ratios of scale factors from 2 s of tumbling in MuJoCo",
        largest(fine),
        tolerance::RATIOS_MUJOCO,
    )
    .beyond(halved)
    .judge();
    let without = largest(without);
    assert!(
        without > tolerance::SECOND_ORDER_SEEN * largest(coarse),
        "the second order left out is not seen: {without:.1e}"
    );
}

/// Along all axes by turns, without turning.
#[derive(Clone)]
struct Translation;

impl Motion for Translation {
    fn acceleration(&self, time_s: f64) -> (DVec3, DVec3) {
        let [_, window, ..] = smooth_step(time_s / 0.3);
        let sine = |hz: f64| (TAU * hz * time_s).sin();
        let a = DVec3::new(9.0 * sine(2.0), 7.0 * sine(3.0), 8.0 * sine(1.3));
        (window * a, DVec3::ZERO)
    }
}

#[test]
fn ref_pure_translation_leaves_the_twins_open() {
    const AMBIGUOUS_PAIRS: &str =
        "limb 2 against limb 4, limb 3 against limb 7, limb 6 against limb 8";
    let (mut run, _) = in_mujoco(&Translation, 1.5, 10);
    for noise_v in [0.0, 1e-4, 1e-2] {
        let mut rng = Pcg64::new(u128::from(seed()), 22);
        for u in &mut run.voltage_v {
            for (u, unit) in u.iter_mut().zip(nine(&mut rng)) {
                *u += noise_v * unit;
            }
        }
        match accumulated(&run).ratios(&Limits::default()) {
            Err(Error::UnobservableScaleRatios { directions: open }) => {
                assert_eq!(open.to_string(), AMBIGUOUS_PAIRS)
            }
            other => panic!("{noise_v} V of noise: {other:?}"),
        }
    }
}

#[test]
fn law_a_single_axis_leaves_several_ratios_unobservable() {
    let mut case = Case::random(seed(), SHORT_S);
    let about = DVec3::new(0.3, -0.5, 0.8).normalize();
    for sine in &mut case.field.motion.rate_shell_rad_s {
        sine.amplitude = about * sine.amplitude.x;
        sine.phase_rad = DVec3::splat(sine.phase_rad.x);
    }
    for sine in &mut case.field.motion.position_ground_m {
        sine.amplitude = DVec3::ZERO;
    }
    case.field.gravity_ground_m_s2 = DVec3::ZERO;
    case.loads = case.field.simulate(&truth::sensor(&case.truth)).0;
    let case = case.with_stiffness(&[1.0; LIMBS]);
    let Err(Error::UnobservableScaleRatios { directions: open }) =
        case.ratios(&case.noisy_v(NOISE_SHARE))
    else {
        panic!("one axis cannot tell eight ratios");
    };
    // Angular acceleration and the centrifugal torque are two loads: six equations for nine unknowns, one of them common.
    assert!(open.len() >= 2, "{open}");
}

#[test]
fn stat_intervals_hold_and_neighbouring_blocks_are_independent() {
    let first = seed();
    let squares: Vec<[f64; 4]> = (first..first + CASES)
        .into_par_iter()
        .map(|seed| {
            let case = Case::random(seed, SHORT_S);
            let found = case.ratios(&case.noisy_v(NOISE_SHARE)).expect("rich");
            let error = errors(&found, &case.true_ln_ratio());
            let none = drifted(
                &ScaleRatios {
                    ln_ratio: error,
                    ..found
                },
                &PerLimbs::zeros(),
                FALSE_ALARM,
            )
            .expect("a rate");
            let of_limbs: f64 = (0..LIMBS)
                .map(|i| (error[i] / found.deviations()[i]).powi(2))
                .sum();
            [
                none.chi_square_of_none,
                found.misfit.z().powi(2),
                found.lag_one_z().powi(2),
                of_limbs,
            ]
        })
        .collect();
    for (what, column, degrees) in [
        ("errors of the ratios over their covariance", 0, 8),
        ("misfit of the loop over its deviation", 1, 1),
        (
            "correlation of neighbouring blocks over its deviation",
            2,
            1,
        ),
    ] {
        let sum: f64 = squares.iter().map(|s| s[column]).sum();
        within(
            what,
            chi_square_departure(sum, degrees * squares.len()),
            tolerance::CHI_SQUARE,
        );
    }
    // Errors half as large again would be seen, and so would errors of half the size.
    let sum: f64 = squares.iter().map(|s| s[0]).sum();
    for factor in [0.5, 2.25] {
        assert!(chi_square_departure(factor * sum, 8 * squares.len()) > 1.0);
    }
}

#[test]
fn law_noise_slower_than_a_block_is_seen() {
    let case = Case::random(seed(), 8.0);
    let mut rng = Pcg64::new(u128::from(seed()), 23);
    let mut voltage_v = case.voltage_v();
    let (noise, mut slow) = (case.noise_v(NOISE_SHARE), [0.0; LIMBS]);
    // A first-order filter of 30 ms.
    let keep = (-1.0 / (0.03 * case.field.sample_rate_hz)).exp();
    for u in &mut voltage_v {
        for (i, unit) in nine(&mut rng).into_iter().enumerate() {
            slow[i] = keep * slow[i] + (1.0 - keep * keep).sqrt() * noise[i] * unit;
            u[i] += slow[i];
        }
    }
    let found = case.ratios(&voltage_v).expect("rich");
    assert!(
        found.lag_one_z() > tolerance::COLOURED_Z,
        "correlation {} of {} blocks",
        found.lag_one_correlation,
        found.blocks
    );
}

#[test]
fn law_crosstalk_is_seen() {
    let case = Case::random(seed(), 20.0);
    let clean = case.noisy_v(NOISE_SHARE);
    // In deviations: misfit of the loop, correlation of neighbouring blocks. None where residuals are so far from noise that the
    // weights do not settle.
    let with = |from: Option<usize>| {
        let mut voltage_v = clean.clone();
        for u in &mut voltage_v {
            u[1] += from.map_or(0.0, |from| tolerance::CROSSTALK * u[from]);
        }
        match case.ratios(&voltage_v) {
            Ok(found) => Some((found.misfit.z().abs(), found.lag_one_z())),
            Err(Error::NotConverged { .. }) => None,
            Err(error) => panic!("{error}"),
        }
    };
    let sound = with(None).expect("a sound sensor");
    for (what, z) in [
        ("misfit of the loop", sound.0),
        ("correlation of blocks", sound.1.abs()),
    ] {
        within(what, z, tolerance::TAP_CHANCE);
    }
    // Limb 1 shares a row with limb 2, limb 9 does not.
    for from in [0, 8] {
        let said = with(Some(from));
        assert!(
            said.is_none_or(|(misfit, lag)| misfit.max(lag) > tolerance::CROSSTALK_Z),
            "from limb {}: {said:?}, sound {sound:?}",
            from + 1
        );
    }
}

#[test]
fn stat_noise_in_the_regressors_does_not_bias_the_ratios() {
    let first = seed();
    let limits = Limits {
        largest_deviation: 1.0,
        ..Limits::default()
    };
    let squares: Vec<f64> = (first..first + CASES / 2)
        .into_par_iter()
        .map(|seed| {
            let case = Case::random(seed, SHORT_S);
            let taken = fed(sample_by_sample(&case), &case.noisy_v(HEAVY_NOISE_SHARE));
            let found = taken.ratios(&limits).expect("rich");
            let error = errors(&found, &case.true_ln_ratio());
            let z = ScaleRatios {
                ln_ratio: error,
                ..found
            };
            drifted(&z, &PerLimbs::zeros(), FALSE_ALARM)
                .expect("a rate")
                .chi_square_of_none
        })
        .collect();
    within(
        "errors under heavy noise, sample by sample, over their covariance",
        chi_square_departure(squares.iter().sum(), 8 * squares.len()),
        tolerance::CHI_SQUARE,
    );
}

#[test]
fn inv_stream_and_batch_are_the_same_bits() {
    let case = Case::random(seed(), SHORT_S);
    let voltage_v = case.noisy_v(NOISE_SHARE);
    let half = voltage_v.len() / 2;
    let mut stream = fed(in_usual_blocks(&case), &voltage_v[..half]);
    // Asking in between changes nothing, and a recording may end in mid-block.
    stream.ratios(&Limits::default()).expect("rich");
    for u in &voltage_v[half..] {
        stream.push(u).expect("sound");
    }
    let batch = case.moments(&voltage_v).expect("sound");
    assert_eq!(stream.moments(), batch);
    assert_eq!(
        stream.ratios(&Limits::default()),
        batch.ratios(&Limits::default())
    );
}

#[test]
fn stat_recordings_tared_anew_join() {
    let case = Case::random(seed(), 2.0 * SHORT_S);
    let mut voltage_v = case.noisy_v(NOISE_SHARE);
    let half = voltage_v.len() / 2;
    let anew = voltage_v[half];
    for u in &mut voltage_v[half..] {
        *u = core::array::from_fn(|i| u[i] - anew[i]);
    }
    let parts =
        [&voltage_v[..half], &voltage_v[half..]].map(|part| case.moments(part).expect("sound"));
    let joined = parts[0].and(&parts[1]);
    let z = |found: &ScaleRatios| {
        let error = errors(found, &case.true_ln_ratio());
        largest((0..LIMBS).map(|i| error[i] / found.deviations()[i]))
    };
    let found = joined.ratios(&Limits::default()).expect("rich");
    within(
        "ratios of two recordings, in deviations",
        z(&found),
        tolerance::TAP_CHANCE,
    );
    // As one recording the step of the zero drifts would be taken for a signal.
    let as_one = case.ratios(&voltage_v).expect("rich");
    assert!(
        z(&as_one) > tolerance::COLOURED_Z || as_one.lag_one_z() > tolerance::COLOURED_Z,
        "one zero drift for both is not seen"
    );
}

#[test]
fn stat_a_known_turn_gives_the_common_factor() {
    let first = seed();
    let squares: Vec<f64> = (first..first + 40)
        .into_par_iter()
        .map(|seed| {
            let case = Case::random(seed, SHORT_S);
            let found = case.ratios(&case.noisy_v(NOISE_SHARE)).expect("rich");
            // Turned over at rest: 2 g along z.
            let turned_over = DQuat::from_rotation_x(core::f64::consts::PI);
            let motion = [DQuat::IDENTITY, turned_over].map(TrueMotion::at_rest);
            let gravity = case.field.gravity_ground_m_s2;
            let forces = compliant_forces_m_s2(&truth::sensor(&case.truth), gravity, &motion)
                .expect("the limbs hold the mass");
            let true_chain = SignalChain::new(&case.gains, &case.truth);
            let [a, b] = [0, 1].map(|i| true_chain.voltage_v(&forces[i]));
            // Means over a tenth of a second each.
            let noise = case
                .noise_v(NOISE_SHARE)
                .map(|v| v * (2.0 / 1000.0_f64).sqrt());
            let unit = nine(&mut Pcg64::new(u128::from(seed), 24));
            let length = 2.0 * paper::GRAVITY_M_S2;
            let known = KnownChange {
                voltage_change_v: core::array::from_fn(|i| a[i] - b[i] + noise[i] * unit[i]),
                voltage_deviation_v: noise,
                length_m_s2: length,
                length_deviation_m_s2: 0.0,
            };
            let chain = SignalChain::new(&case.gains, &case.calibration);
            let scales = known.scales(&chain, &found).expect("a turn");
            let truth = case.true_ln_scale();
            let common = truth.iter().sum::<f64>() / LIMBS as f64;
            let z = (scales.ln_common - common) / scales.common_deviation;
            let refused = KnownChange {
                length_m_s2: -1.0,
                ..known
            };
            assert!(refused.scales(&chain, &found).is_err());
            // The largest of nine deviations that are not independent; judged by the common one below.
            let each =
                largest((0..LIMBS).map(|i| (scales.ln_scale[i] - truth[i]) / scales.deviation[i]));
            assert!(each < tolerance::TAP_CHANCE.limit, "{each} deviations");
            z * z
        })
        .collect();
    within(
        "common factor by a turn of 2 g, over its deviation",
        chi_square_departure(squares.iter().sum(), squares.len()),
        tolerance::CHI_SQUARE,
    );
}

#[test]
fn stat_drifted_limbs_are_named() {
    let first = seed();
    for (numbers, sizes) in [
        (vec![], vec![]),
        (vec![4], vec![3e-3]),
        (vec![2, 9], vec![6e-3, -4e-3]),
        (vec![1, 5, 8], vec![5e-3, 5e-3, -7e-3]),
    ] {
        let mut case = Case::of(first, Pace::Brisk, 30.0, 0.0);
        for (number, size) in numbers.iter().zip(&sizes) {
            case.calibration.scale_per_mass_per_kg[number - 1] *= f64::exp(-size);
        }
        let found = case.ratios(&case.noisy_v(NOISE_SHARE)).expect("rich");
        // One false alarm in a million, not one in a hundred: the seed may be any.
        let said = drifted(&found, &PerLimbs::zeros(), 1e-6).expect("a rate");
        let limbs = LimbSet::from_numbers(numbers.iter().copied()).expect("limbs");
        assert_eq!(
            (said.limbs, said.explained, said.rival),
            (limbs, true, None)
        );
        for (number, size) in numbers.iter().zip(&sizes) {
            let z = (said.ln_change[number - 1] - size) / said.deviation[number - 1];
            within(
                "change of a drifted limb, in deviations",
                z.abs(),
                tolerance::TAP_CHANCE,
            );
        }
    }
    // More than a minority: nobody is named.
    let mut case = Case::of(first, Pace::Brisk, 30.0, 0.0);
    for (i, scale) in case
        .calibration
        .scale_per_mass_per_kg
        .iter_mut()
        .enumerate()
    {
        *scale *= 1.0 + 0.01 * i as f64;
    }
    let found = case.ratios(&case.noisy_v(NOISE_SHARE)).expect("rich");
    let said = drifted(&found, &PerLimbs::zeros(), FALSE_ALARM).expect("a rate");
    assert!(
        !said.explained && said.limbs.is_empty() && said.chi_square_of_none > said.limit_of_none
    );
}

#[test]
fn stat_unequal_stiffness_is_found_and_equal_stands() {
    let rng = &mut Pcg64::new(u128::from(seed()), 25);
    let deviation = 5e-4;
    let covariance = PerLimbs::identity() * (deviation * deviation);
    for spread in [0.0, 0.02] {
        let ratio = nine(rng).map(|unit| 1.0 + spread * unit);
        let case = Case::random(seed(), 20.0).with_stiffness(&ratio);
        let found = case.ratios(&case.noisy_v(NOISE_SHARE)).expect("rich");
        let unit = nine(rng);
        let truth = case.true_ln_scale();
        // Step 2's word, with a common error that must not matter.
        let by_forces = core::array::from_fn(|i| truth[i] + deviation * unit[i] + 0.01);
        let test = StiffnessTest::new(&by_forces, &covariance, &found, 1e-6).expect("a rate");
        assert_eq!(test.equal(), spread == 0.0, "{test:?}");
        let true_ln = without_mean(ratio.map(f64::ln));
        let z =
            largest((0..LIMBS).map(|i| (test.ln_stiffness[i] - true_ln[i]) / test.deviations()[i]));
        within(
            "ln k_i over their mean, in deviations",
            z,
            tolerance::TAP_CHANCE,
        );
    }
}

#[test]
fn law_bad_input_is_named() {
    let case = Case::random(seed(), SHORT_S);
    let mut taken = in_usual_blocks(&case);
    let before = taken.clone();
    assert!(matches!(
        taken.ratios(&Limits::default()),
        Err(Error::TooFewSamples { .. })
    ));
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let mut u = [0.0; LIMBS];
        u[6] = bad;
        match taken.push(&u) {
            Err(
                Error::NotFinite {
                    channel: 7,
                    sample: 0,
                    ..
                }
                | Error::Overstrained {
                    channel: 7,
                    sample: 0,
                    ..
                },
            ) => {}
            other => panic!("{bad}: {other:?}"),
        }
    }
    assert_eq!(taken, before, "a refused sample leaves no trace");
    // A sensor at rest, with and without noise.
    for noise_v in [0.0, 1e-3] {
        let mut rng = Pcg64::new(u128::from(seed()), 26);
        let still: Vec<[f64; LIMBS]> = (0..20_000)
            .map(|_| nine(&mut rng).map(|u| noise_v * u))
            .collect();
        let refused = case.ratios(&still);
        assert!(
            matches!(
                refused,
                Err(Error::UnobservableScaleRatios { .. } | Error::NotConverged { .. })
            ),
            "{refused:?}"
        );
    }
}

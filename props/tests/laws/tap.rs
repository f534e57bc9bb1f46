//! k/m from a tap: derivatives, modes, MuJoCo's decays, intervals, and what is refused.

use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::identify::tap::{MODES, RingDown, SHARED, identify};
use sixaxis_core::{Error, Geometry, InertiaPerMass, LIMBS, Parameters};
use sixaxis_props::compare::within;
use sixaxis_props::evidence::Row;
use sixaxis_props::seed::seed;
use sixaxis_props::statistics::chi_square_departure;
use sixaxis_props::taps::{Case, FULL_SCALE_V, KNOWN_TO, NOISE_SHARE, Recorded, States, bound_ln};
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_reference::linear_theory::mode_frequencies_hz;
use sixaxis_reference::rig::tap::SAMPLE_RATE_HZ;

/// Taps played in MuJoCo, and closed-form ones.
const PLAYED: u64 = 3;
const CLOSED_FORM: u64 = 40;
/// Samples of the stretch that derivatives are compared over: 3 ms.
const STRETCH: usize = 150;
/// Closed-form recordings: rest before the decay, and all of it.
const REST_SAMPLES: usize = 60;
const SAMPLES: usize = 900;
/// Moments of inertia that make the modes meet in pairs.
const ROUND_M2: f64 = 240e-6;

fn ring(p: &[f64; SHARED]) -> RingDown {
    let inertia = InertiaPerMass::from_paper_order(core::array::from_fn(|k| p[2 + k]));
    RingDown::new(&Geometry::PAPER, &inertia, p[0].exp(), p[1]).expect("a sound sensor")
}

fn shared(case: &Case) -> [f64; SHARED] {
    let inertia = case.truth.inertia_per_mass.to_paper_order();
    core::array::from_fn(|k| match k {
        0 => case.truth.stiffness_per_mass_per_s2.ln(),
        1 => case.damping_ratio,
        _ => inertia[k - 2],
    })
}

fn column(force: impl Iterator<Item = [f64; LIMBS]>) -> DVector<f64> {
    DVector::from_vec(force.flatten().collect())
}

fn times() -> impl Iterator<Item = f64> {
    (0..STRETCH).map(|sample| sample as f64 / SAMPLE_RATE_HZ)
}

/// The parts of the analytic derivatives and of differences of states that the modes themselves do not explain.
fn departure_of_derivatives(p: &[f64; SHARED], rng: &mut Pcg64) -> f64 {
    let model = ring(p);
    let mut unit = || -> f64 { StandardNormal.sample(rng) };
    let rates = model.frequencies_hz().map(|f| core::f64::consts::TAU * f);
    let initial: [f64; 2 * MODES] =
        core::array::from_fn(|j| unit() * if j < MODES { 1.0 } else { rates[j - MODES] });
    let mut basis = DMatrix::zeros(LIMBS * STRETCH, 2 * MODES);
    for j in 0..2 * MODES {
        let mut only = [0.0; 2 * MODES];
        only[j] = if j < MODES { 1.0 } else { rates[j - MODES] };
        basis.set_column(
            j,
            &column(times().map(|t| model.force_per_mass_m_s2(t, &only))),
        );
    }
    let orthonormal = basis.qr().q();
    let beyond = |v: DVector<f64>| &v - &orthonormal * (orthonormal.transpose() * &v);
    let force: Vec<[f64; LIMBS]> = times()
        .map(|t| model.force_per_mass_m_s2(t, &initial))
        .collect();
    let states = |p: &[f64; SHARED]| {
        let inertia: [f64; 6] = core::array::from_fn(|k| p[2 + k]);
        States::new(&inertia, p[0].exp(), p[1], 1.0 / SAMPLE_RATE_HZ)
    };
    let start = states(p).start(&force);
    (0..SHARED)
        .map(|k| {
            let by = tolerance::TAP_DIFFERENCE * if k < 2 { 1.0 } else { ROUND_M2 };
            let moved = |by: f64| {
                let mut p = *p;
                p[k] += by;
                let states = states(&p);
                let force = states.forces(start).take(STRETCH);
                column(force.map(|f| core::array::from_fn(|i| f[i])))
            };
            let differences = beyond((moved(by) - moved(-by)) / (2.0 * by));
            let analytic = beyond(column(times().map(|t| model.sensitivities(t, &initial)[k])));
            (&analytic - &differences).norm() / differences.norm()
        })
        .fold(0.0, f64::max)
}

#[test]
fn law_derivatives_of_the_decay_are_those_of_the_states() {
    let mut rng = Pcg64::new(u128::from(seed()), 1);
    let mut worst = 0.0_f64;
    for seed in 0..10 {
        let p = shared(&Case::random(seed));
        worst = worst.max(departure_of_derivatives(&p, &mut rng));
    }
    // Modes that meet: a round inertia has them in pairs, one that is nearly round nearly so.
    for split in [0.0, 1e-9, 1e-6, 1e-4] {
        let mut p = shared(&Case::random(0));
        p[2..].copy_from_slice(&[ROUND_M2, ROUND_M2 * (1.0 + split), ROUND_M2, 0.0, 0.0, 0.0]);
        worst = worst.max(departure_of_derivatives(&p, &mut rng));
    }
    within(
        "derivatives of a decay against differences of states",
        worst,
        tolerance::TAP_DERIVATIVES,
    );
}

#[test]
fn ref_modes_are_the_reference_s() {
    let mut worst = 0.0_f64;
    for seed in 0..20 {
        let p = shared(&Case::random(seed));
        let truth = Case::random(seed).truth;
        let theirs = mode_frequencies_hz(&truth::sensor(&truth));
        for (ours, theirs) in ring(&p).frequencies_hz().iter().zip(theirs) {
            worst = worst.max((ours / theirs - 1.0).abs());
        }
    }
    within(
        "modes of the fit against the reference's",
        worst,
        tolerance::ROUNDING,
    );
}

#[test]
fn ref_taps_in_mujoco_give_stiffness_within_chance() {
    let first = seed();
    for seed in first..first + PLAYED {
        let case = Case::random(seed);
        let recorded = case.record(NOISE_SHARE).expect("it simulates");
        let tap = case.identify(&recorded).expect("it rings");
        assert!(
            tap.verdict.is_determined(),
            "seed {seed}: {:?}",
            tap.verdict
        );
        let bound = bound_ln(&case, &recorded, &tap.fitted);
        Row::new(
            "k/m from a tap in MuJoCo, in standard deviations of the bound",
            case.error_ln(&tap).abs() / bound,
            tolerance::TAP_CHANCE,
        )
        .case(format!("seed {seed}"))
        .sides(
            case.truth.stiffness_per_mass_per_s2,
            tap.stiffness_per_mass_per_s2,
            "1/s^2",
        )
        .judge();
        Row::new(
            "standard error of k/m from a tap over the bound",
            (tap.standard_error_ln / bound - 1.0).abs(),
            tolerance::TAP_STANDARD_ERROR,
        )
        .case(format!("seed {seed}"))
        .judge();
    }
}

/// A tap in closed form: the decay of a random state, with the rest before it.
fn closed_form(case: &Case, damping: impl Fn(f64) -> f64) -> Recorded {
    let inertia = case.truth.inertia_per_mass.to_paper_order();
    let k = case.truth.stiffness_per_mass_per_s2;
    let states = States::new(
        &inertia,
        k,
        damping(case.damping_ratio),
        1.0 / SAMPLE_RATE_HZ,
    );
    let mut rng = Pcg64::new(u128::from(case.seed), 2);
    let mut unit = || -> f64 { StandardNormal.sample(&mut rng) };
    // A micrometre and, over 15 mm, as much rotation, with the rates that go with it.
    let start = nalgebra::SVector::from_fn(|i, _| {
        let size = if i % 6 < 3 { 1e-6 } else { 1e-6 / 15e-3 };
        unit() * size * if i < 6 { 1.0 } else { k.sqrt() }
    });
    let mut force = vec![[0.0; LIMBS]; REST_SAMPLES];
    force.extend(
        states
            .forces(start)
            .take(SAMPLES - REST_SAMPLES)
            .map(|f| core::array::from_fn::<f64, LIMBS, _>(|i| f[i])),
    );
    case.measured(force, NOISE_SHARE)
}

#[test]
fn stat_intervals_hold_the_truth_as_often_as_stated() {
    let first = seed();
    let mut squares = 0.0;
    let mut inertia_squares = 0.0;
    for seed in first..first + CLOSED_FORM {
        let case = Case::random(seed);
        let tap = case.identify(&closed_form(&case, |z| z)).expect("it rings");
        squares += (case.error_ln(&tap) / tap.standard_error_ln).powi(2);
        let error = tap.inertia_per_mass.xx_m2 - case.truth.inertia_per_mass.xx_m2;
        inertia_squares += error * error / tap.covariance[(2, 2)];
    }
    for (what, squares) in [("k/m", squares), ("I1/m", inertia_squares)] {
        let departure = chi_square_departure(squares, CLOSED_FORM as usize);
        within(
            format!("chi-square of {what} from taps"),
            departure,
            tolerance::CHI_SQUARE,
        );
    }
}

#[test]
fn law_a_wrong_inertia_stated_as_exact_moves_stiffness_beyond_its_interval() {
    let case = Case::random(seed());
    let recorded = closed_form(&case, |z| z);
    let wrong = Parameters {
        inertia_per_mass: InertiaPerMass::from_paper_order(
            case.truth
                .inertia_per_mass
                .to_paper_order()
                .map(|i| i * tolerance::TAP_WRONG_INERTIA),
        ),
        ..case.known
    };
    let mut setup = case.setup(&recorded.sensor);
    setup.parameters = &wrong;
    let free =
        setup.inertia_covariance_m4 * ((tolerance::TAP_WRONG_INERTIA - 1.0) / KNOWN_TO).powi(2);
    // Believed to a hundredth of what it is off by.
    setup.inertia_covariance_m4 = free * tolerance::TAP_BELIEVED * tolerance::TAP_BELIEVED;
    let off = match identify(&setup, &recorded.voltage_v) {
        Ok(tap) => case.error_ln(&tap).abs() / tap.standard_error_ln,
        Err(error) => panic!("{error}"),
    };
    assert!(
        off > tolerance::TAP_BEYOND,
        "a wrong inertia is off by {off:.1} standard errors only"
    );
    setup.inertia_covariance_m4 = free;
    let tap = identify(&setup, &recorded.voltage_v).expect("it rings");
    within(
        "k/m from a tap with I/m off by its standard deviation",
        case.error_ln(&tap).abs() / tap.standard_error_ln,
        tolerance::TAP_CHANCE,
    );
}

#[test]
fn law_recordings_without_a_tap_are_refused() {
    let case = Case::random(seed());
    let recorded = closed_form(&case, |z| z);
    let with = |voltage_v: &[[f64; LIMBS]]| identify(&case.setup(&recorded.sensor), voltage_v);
    let mut rng = Pcg64::new(u128::from(seed()), 3);
    let quiet: Vec<[f64; LIMBS]> = (0..SAMPLES)
        .map(|_| core::array::from_fn(|_| StandardNormal.sample(&mut rng)))
        .collect();
    assert!(
        matches!(with(&quiet), Err(Error::NoRingDown { .. })),
        "{:?}",
        with(&quiet)
    );
    let mut clipped = recorded.voltage_v.clone();
    clipped[REST_SAMPLES][4] = FULL_SCALE_V;
    assert!(
        matches!(
            with(&clipped),
            Err(Error::Clipped {
                channel: 5,
                sample: REST_SAMPLES,
                ..
            })
        ),
        "{:?}",
        with(&clipped)
    );
    let short = &recorded.voltage_v[..REST_SAMPLES + STRETCH / 3];
    assert!(
        matches!(with(short), Err(Error::TooFewSamples { .. })),
        "{:?}",
        with(short)
    );
    let mut slow = case.setup(&recorded.sensor);
    slow.sample_rate_hz = SAMPLE_RATE_HZ / 5.0;
    let every_fifth: Vec<[f64; LIMBS]> = recorded.voltage_v.iter().copied().step_by(5).collect();
    let refused = identify(&slow, &every_fifth);
    assert!(
        matches!(refused, Err(Error::SampledTooSlowly { .. })),
        "{refused:?}"
    );
    let mut holed = recorded.voltage_v.clone();
    holed[SAMPLES - 1][8] = f64::NAN;
    assert!(
        matches!(with(&holed), Err(Error::NotFinite { channel: 9, .. })),
        "{:?}",
        with(&holed)
    );
    // Huge but finite: an answer or a refusal, no panic.
    let mut huge = recorded.voltage_v.clone();
    huge[SAMPLES / 2] = [f64::MAX; LIMBS];
    let mut unlimited = case.setup(&recorded.sensor);
    unlimited.full_scale_v = f64::INFINITY;
    assert!(identify(&unlimited, &huge).is_err());
}

#[test]
fn law_a_ringing_shell_leaves_stiffness_undetermined() {
    let case = Case::random(seed());
    let mut recorded = closed_form(&case, |z| z);
    let quiet = case.identify(&recorded).expect("it rings");
    assert!(quiet.verdict.is_determined(), "{:?}", quiet.verdict);
    // The rig's own resonance, which hardly decays, in one channel more than in another.
    for (sample, row) in recorded.voltage_v.iter_mut().enumerate().skip(REST_SAMPLES) {
        let time_s = sample as f64 / SAMPLE_RATE_HZ;
        let swing = (core::f64::consts::TAU * tolerance::TAP_RIG_HZ * time_s).sin();
        for (limb, u) in row.iter_mut().enumerate() {
            *u += tolerance::TAP_RIG_V * swing * (1.0 + limb as f64);
        }
    }
    let verdict = case.identify(&recorded).map(|tap| tap.verdict);
    assert!(
        !verdict.as_ref().is_ok_and(|v| v.is_determined()),
        "{verdict:?}"
    );
}

//! What the benches rest on: good answers pass, wrong ones are refused, and by how much.

use std::sync::LazyLock;

use glam::DVec3;
use sixaxis_benches::pseudo_inverse;
use sixaxis_benches::validate::{self, Refusal, Report};
use sixaxis_core::decouple::decouple;
use sixaxis_core::identify::stiffness::rate_norm_sum;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::{Geometry, LimbLaw, Parameters, Scheme, Settings, SixAxis};
use sixaxis_props::problem::recorded::{
    self as problem, DECOUPLE_RATE_HZ, InertiaRows, Poses, Recorded, STEP_S, ScaleRows, candidate,
    stiffness_run, true_parameters,
};
use sixaxis_props::tolerance::{DecoupledRun, PAPER_COMPOUND, PAPER_TUMBLE, REFERENCE_LINEAR};

/// The least by which each wrong ingredient must miss its limit: error over limit. Measured, and rounded down.
mod control {
    /// Eq. (2) with its printed sign, Heun.
    pub const PRINTED_SIGN: f64 = 16.0;
    /// Channels 1 and 2 swapped, Heun.
    pub const SWAPPED_CHANNELS: f64 = 3.6e4;
    /// One scale factor off by 1 %, Heun.
    pub const SCALE_OFF: f64 = 31.0;
    /// Gravity left out, Adams-Moulton.
    pub const NO_GRAVITY: f64 = 2.1e3;
    /// Euler's answer held to Heun's limit.
    pub const EULER_FOR_HEUN: f64 = 1.0e2;
    /// Heun's answer held to Adams-Moulton's limit.
    pub const HEUN_FOR_AM4: f64 = 2.1e3;
    /// Poses of limbs 1 and 2 swapped.
    pub const POSE_SWAPPED: f64 = 1.0e8;
    /// One s_i/m off by 1e-5.
    pub const SCALE_ESTIMATE: f64 = 5.0;
    /// I1 off by 1e-5.
    pub const INERTIA_ESTIMATE: f64 = 3.7;
    /// Every k/m of the search raised by one grid step.
    pub const STIFFNESS_SHIFTED: f64 = 2.5e3;
}

/// Relative error planted in an estimate.
const PLANTED: f64 = 1e-5;
/// Relative error planted in a scale factor.
const PLANTED_SCALE: f64 = 1e-2;

static COMPOUND: LazyLock<Recorded> =
    LazyLock::new(|| Recorded::play(&problem::compound_5_hz(), DECOUPLE_RATE_HZ));
static TUMBLE: LazyLock<Recorded> = LazyLock::new(Recorded::tumble);
static SCALE: LazyLock<ScaleRows> = LazyLock::new(ScaleRows::play);
static INERTIA: LazyLock<InertiaRows> = LazyLock::new(InertiaRows::play);
static STIFFNESS: LazyLock<Recorded> = LazyLock::new(stiffness_run);

fn decoupled_with(
    problem: &Recorded,
    parameters: &Parameters,
    settings: &Settings,
) -> Vec<SixAxis> {
    let voltage_v = &problem.recording.voltage_v;
    decouple(&problem.sensor(), parameters, settings, voltage_v).expect("a recorded run")
}

fn decoupled(problem: &Recorded, scheme: Scheme) -> Vec<SixAxis> {
    decoupled_with(problem, &true_parameters(), &problem.settings(scheme))
}

fn held_to(answers: &[SixAxis], scheme: Scheme) -> Result<Report, Refusal> {
    validate::decoupled(&COMPOUND.truth, answers, &DecoupledRun::compound(scheme))
}

fn accepted(outcome: Result<Report, Refusal>) {
    if let Err(refusal) = outcome {
        panic!("a good answer was refused: {refusal}");
    }
}

/// Refused, by at least so many times the limit.
fn refused(outcome: Result<Report, Refusal>, at_least: f64) {
    match outcome {
        Err(Refusal::Error { what, limit, error }) => {
            let excess = error / limit.limit;
            assert!(
                excess.is_nan() || excess >= at_least,
                "{what} was missed by {excess:.3e} only"
            );
        }
        other => panic!("not refused for its error: {other:?}"),
    }
}

fn refused_for_samples(outcome: Result<Report, Refusal>) {
    assert!(
        matches!(outcome, Err(Refusal::Samples { .. })),
        "not refused for its samples: {outcome:?}"
    );
}

#[test]
fn ref_every_scheme_meets_its_limit() {
    for scheme in Scheme::ALL {
        accepted(held_to(&decoupled(&COMPOUND, scheme), scheme));
        accepted(validate::decoupled(
            &TUMBLE.truth,
            &decoupled(&TUMBLE, scheme),
            &DecoupledRun::tumble(scheme),
        ));
    }
}

#[test]
fn ref_the_papers_decoder_meets_its_limit() {
    for (problem, limits) in [(&*COMPOUND, PAPER_COMPOUND), (&*TUMBLE, PAPER_TUMBLE)] {
        let mut answers = Vec::new();
        problem
            .paper_decoder(&true_parameters())
            .push_all(&problem.recording.voltage_v, |s| answers.push(*s))
            .expect("a recorded run");
        accepted(validate::decoupled(&problem.truth, &answers, &limits));
    }
}

#[test]
fn ref_identification_meets_its_limits() {
    accepted(validate::scale_per_mass(&SCALE.solve().estimate.values));
    accepted(validate::scale_per_mass(&pseudo_inverse::scale_per_mass(
        &SCALE,
    )));
    accepted(validate::inertia_per_mass(&INERTIA.solve().estimate.values));
    accepted(validate::inertia_per_mass(
        &pseudo_inverse::inertia_per_mass(&INERTIA),
    ));
}

/// Halving MuJoCo's step moves the difference between decoupled and true by no more than the table says.
#[test]
fn ref_step_of_the_reference() {
    let halved =
        Recorded::play_with_step(&problem::compound_5_hz(), DECOUPLE_RATE_HZ, STEP_S / 2.0);
    let difference = |problem: &Recorded| -> Vec<DVec3> {
        decoupled(problem, Scheme::AdamsMoulton4)
            .iter()
            .zip(&problem.truth[1..])
            .map(|(a, t)| a.linear_ground_m_s2 - t.linear_ground_m_s2)
            .collect()
    };
    let peak = COMPOUND
        .truth
        .iter()
        .map(|t| t.linear_ground_m_s2.length())
        .fold(0.0, f64::max);
    let moved = difference(&COMPOUND)
        .iter()
        .zip(difference(&halved))
        .map(|(a, b)| (*a - b).length() / peak)
        .fold(0.0, f64::max);
    assert!(REFERENCE_LINEAR.allows(moved), "moved by {moved:.3e}");
}

#[test]
fn control_wrong_decoupling_is_refused() {
    let heun = COMPOUND.settings(Scheme::Heun);
    let printed = Settings {
        limb_law: LimbLaw::AsPrinted,
        ..heun
    };
    refused(
        held_to(
            &decoupled_with(&COMPOUND, &true_parameters(), &printed),
            Scheme::Heun,
        ),
        control::PRINTED_SIGN,
    );

    let mut swapped = true_parameters();
    swapped.scale_per_mass_per_kg.swap(0, 1);
    swapped.zero_drift_v.swap(0, 1);
    refused(
        held_to(&decoupled_with(&COMPOUND, &swapped, &heun), Scheme::Heun),
        control::SWAPPED_CHANNELS,
    );

    let mut off = true_parameters();
    off.scale_per_mass_per_kg[0] *= 1.0 + PLANTED_SCALE;
    refused(
        held_to(&decoupled_with(&COMPOUND, &off, &heun), Scheme::Heun),
        control::SCALE_OFF,
    );

    let weightless = Settings {
        gravity_ground_m_s2: DVec3::ZERO,
        ..COMPOUND.settings(Scheme::AdamsMoulton4)
    };
    refused(
        held_to(
            &decoupled_with(&COMPOUND, &true_parameters(), &weightless),
            Scheme::AdamsMoulton4,
        ),
        control::NO_GRAVITY,
    );
}

#[test]
fn control_one_scheme_does_not_pass_for_a_better_one() {
    refused(
        held_to(&decoupled(&COMPOUND, Scheme::Euler), Scheme::Heun),
        control::EULER_FOR_HEUN,
    );
    refused(
        held_to(&decoupled(&COMPOUND, Scheme::Heun), Scheme::AdamsMoulton4),
        control::HEUN_FOR_AM4,
    );
}

#[test]
fn control_missing_samples_and_nan_are_refused() {
    let good = decoupled(&COMPOUND, Scheme::Heun);

    refused_for_samples(held_to(&[], Scheme::Heun));
    refused_for_samples(held_to(&good[..good.len() - 1], Scheme::Heun));
    let mut disordered = good.clone();
    disordered.swap(good.len() / 2, good.len() / 2 + 1);
    refused_for_samples(held_to(&disordered, Scheme::Heun));

    for at in [0, good.len() / 2, good.len() - 1] {
        let mut poisoned = good.clone();
        poisoned[at].linear_ground_m_s2.y = f64::NAN;
        refused(held_to(&poisoned, Scheme::Heun), f64::INFINITY);
    }
}

#[test]
fn ref_and_control_poses() {
    let problem = Poses::play(&problem::compound_5_hz());
    let poses = |swap: bool| -> Vec<(DVec3, DVec3)> {
        let pose = |nine: &[f64; 9]| {
            let mut nine = *nine;
            if swap {
                nine.swap(0, 1);
            }
            let pose = Pose::from_elongations(&Geometry::PAPER, &nine).expect("limbs that meet");
            (pose.position_shell_m, pose.rotation_rad)
        };
        problem.elongation_m.iter().map(pose).collect()
    };
    accepted(validate::poses(&problem.truth, &poses(false)));
    refused(
        validate::poses(&problem.truth, &poses(true)),
        control::POSE_SWAPPED,
    );
    refused_for_samples(validate::poses(&problem.truth, &[]));
}

#[test]
fn control_wrong_estimates_are_refused() {
    let mut scale = SCALE.solve().estimate.values;
    scale[4] *= 1.0 + PLANTED;
    refused(validate::scale_per_mass(&scale), control::SCALE_ESTIMATE);
    scale[4] = f64::NAN;
    refused(validate::scale_per_mass(&scale), f64::INFINITY);

    let mut inertia = INERTIA.solve().estimate.values;
    inertia[0] *= 1.0 + PLANTED;
    refused(
        validate::inertia_per_mass(&inertia),
        control::INERTIA_ESTIMATE,
    );
}

#[test]
fn ref_and_control_stiffness() {
    let settings = STIFFNESS.settings(Scheme::Heun);
    let voltage_v = &STIFFNESS.recording.voltage_v;
    let samples = voltage_v.len() - 2;
    let core = |parameters: &Parameters| {
        rate_norm_sum(&STIFFNESS.sensor(), parameters, &settings, voltage_v)
            .expect("a recorded run")
    };
    accepted(validate::stiffness(samples, core));
    accepted(validate::stiffness(samples, |p| {
        STIFFNESS.paper_rate_norm_sum(p)
    }));

    let (_, _, grid_step) = sixaxis_core::identify::stiffness::PAPER_GRID_PER_S2;
    let shifted = |p: &Parameters| core(&candidate(p.stiffness_per_mass_per_s2 + grid_step));
    refused(
        validate::stiffness(samples, shifted),
        control::STIFFNESS_SHIFTED,
    );
    // A search that looks at nothing.
    refused(
        validate::stiffness(samples, |_| (0.0, samples)),
        f64::INFINITY,
    );
    refused_for_samples(validate::stiffness(samples, |_| (0.0, 0)));
}

#[test]
fn control_nan_passes_no_limit() {
    let limit = REFERENCE_LINEAR;
    assert!(!limit.allows(f64::NAN));
    assert!(limit.allows(limit.limit));
}

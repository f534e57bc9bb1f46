//! Sessions with taps, from their files: k/m within its interval, bad taps as reservations, everything else as without.

use sixaxis_calibration::calibrate::CalibratedSession;
use sixaxis_calibration::report::Grade;
use sixaxis_core::LIMBS;
use sixaxis_core::Parameter;
use sixaxis_props::compare::within;
use sixaxis_props::evidence::Row;
use sixaxis_props::seed::seed;
use sixaxis_props::tolerance;
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::plan::{Engine, RigPlan, SensorChoice, SessionPlan};
use sixaxis_reference::laboratory::session::simulate_session;

use crate::judged;

fn plan(taps: usize) -> SessionPlan {
    SessionPlan {
        seed: seed(),
        sensor: SensorChoice::Random,
        engine: Engine::Rigid,
        trials_per_step: 6,
        sample_rate_hz: 1000.0,
        static_duration_s: 60.0,
        rig: RigPlan {
            taps,
            ..RigPlan::default()
        },
        ..SessionPlan::default()
    }
}

/// Part of its interval that a parameter may move by where it is not concerned: what limbs that give way add to the forces is 10⁻⁶ of
/// them.
const UNMOVED: f64 = 0.01;

#[test]
fn ref_a_session_with_taps_determines_stiffness_and_changes_nothing_else() {
    let played = simulate_session(&plan(2)).expect("it plays");
    let without = simulate_session(&plan(0)).expect("it plays");
    assert!(
        played.recordings.len() == without.recordings.len() + 2
            && played.recordings.starts_with(&without.recordings),
        "taps change the other recordings"
    );
    let (with, without) = (judged(&played, "two"), judged(&without, "none"));
    let of = |judgement: &CalibratedSession| {
        judgement
            .parameters
            .iter()
            .find(|p| p.parameter == Parameter::Stiffness)
            .expect("k/m is reported")
            .clone()
    };
    assert_eq!(
        with.grade, without.grade,
        "{:?} {:?}",
        with.next, without.next
    );
    assert_eq!(with.grade, Grade::Good, "{:?}", with.next);
    assert!(!of(&without).determined && of(&without).remark.contains("tap the shell"));
    let (found, truth) = (of(&with), played.truth.parameters.stiffness_per_mass_per_s2);
    assert!(found.determined, "{}", found.remark);
    // MuJoCo's shell does not follow the mass: what the interval allows for that is not tried here.
    let taps = with.taps.stiffness.as_ref().expect("k/m by the taps");
    let half_width = taps.from_noise.hypot(taps.from_known);
    let allowed = 0.01 * taps.per_mass_per_s2;
    assert!(taps.half_width_95 >= allowed.hypot(half_width) * (1.0 - 1e-12));
    Row::new(
        "k/m of a session with two taps, over its 95 % interval",
        (taps.per_mass_per_s2 - truth).abs() / half_width,
        tolerance::TAP_INTERVAL,
    )
    .sides(truth, taps.per_mass_per_s2, "1/s^2")
    .judge();
    within(
        "half width of k/m's interval by two taps",
        half_width / taps.per_mass_per_s2,
        tolerance::TAP_HALF_WIDTH,
    );
    let calibration = with.calibration.expect("there is one");
    assert_eq!(
        calibration.parameters.stiffness_per_mass_per_s2.to_bits(),
        found.estimate.to_bits()
    );
    assert_eq!(with.four_steps[..24], without.four_steps[..24]);
    // The joint fit takes k/m in, which the other parameters do not notice.
    for (with, without) in with.parameters[..24].iter().zip(&without.parameters) {
        let half_width = without.half_width_95.expect("an interval");
        let moved = (with.estimate - without.estimate).abs() / half_width;
        assert!(moved < UNMOVED, "{}: {moved}", with.parameter);
    }
}

#[test]
fn law_a_bad_tap_is_a_reservation() {
    let mut played = simulate_session(&plan(2)).expect("it plays");
    let full_scale_v = played.session.sensor.full_scale_v;
    let mut bad = played.recordings.iter_mut().filter(|r| r.role == Role::Tap);
    let clipped = bad.next().expect("a tap");
    let middle = clipped.voltage_v.len() / 2;
    clipped.voltage_v[middle] = [full_scale_v; LIMBS];
    let quiet = bad.next().expect("another");
    // The rest before the blow, over and over.
    let rest: Vec<[f64; LIMBS]> = quiet.voltage_v[..40].to_vec();
    for (sample, row) in quiet.voltage_v.iter_mut().enumerate() {
        *row = rest[sample % rest.len()];
    }
    let judgement = judged(&played, "bad");
    assert_eq!(judgement.grade, Grade::Reserved, "{}", judgement.sentence);
    assert!(judgement.findings.is_empty(), "{:?}", judgement.findings);
    for (name, cause) in [("tap-01", "clipped"), ("tap-02", "no tap")] {
        assert!(
            judgement
                .reservations
                .iter()
                .any(|r| r.contains(name) && r.contains(cause)),
            "{name}: {:?}",
            judgement.reservations
        );
    }
    let stiffness = judgement.parameters.last().expect("25 parameters");
    assert!(!stiffness.determined, "{}", stiffness.remark);
}

/// A rig that follows the mass raises the modes in which it travels, and only larger inertias bring the others back: here the trials' are
/// smaller by as much.
#[test]
fn law_a_tap_that_asks_for_other_inertias_is_refused() {
    let mut played = simulate_session(&plan(1)).expect("it plays");
    for linear in played
        .recordings
        .iter_mut()
        .filter(|r| r.role == Role::Linear)
    {
        for reading in &mut linear.accelerometer_m_s2 {
            *reading /= 1.08;
        }
    }
    let judgement = judged(&played, "follows");
    let remark = judgement.taps.remarks.first().expect("a remark");
    assert!(
        remark.contains("tap-01")
            && remark.contains("its modes ask for other inertias than the angular trials, +"),
        "{remark}"
    );
    assert!(judgement.taps.stiffness.is_none());
}

//! Days of amplifiers whose high-pass the session states: undone, noise grows with the length of a run, and is neither a zero that drifts nor
//! a run of another cause.

use sixaxis_calibration::calibrate::CalibratedSession;
use sixaxis_calibration::finding::Cause;
use sixaxis_calibration::report::Grade;
use sixaxis_reference::laboratory::plan::{Engine, SensorChoice, SessionPlan};
use sixaxis_reference::laboratory::session::simulate_session;

use super::judged;

/// Seeds of days in which some compound runs came out wrong where the level was the mean of sixteen samples.
const SEEDS: [u64; 2] = [501, 502];

/// Runs of 15 to 30 s, each between rests of a second.
fn day(corner_hz: f64, seed: u64) -> CalibratedSession {
    let mut plan = SessionPlan {
        seed,
        sensor: SensorChoice::Random,
        engine: Engine::Rigid,
        trials_per_step: 4,
        sample_rate_hz: 1000.0,
        ..SessionPlan::default()
    };
    plan.rig.rest_s = 1.0;
    plan.rig.steady_periods = 20.0;
    plan.rig.low_band_hz = (0.7, 1.5);
    plan.chain.amplifier_high_pass_hz = corner_hz;
    let played = simulate_session(&plan).expect("it plays");
    judged(&played, &format!("high-pass-{corner_hz}-{seed}"))
}

#[test]
fn inv_a_healthy_day_behind_a_high_pass_is_not_refused() {
    for seed in SEEDS {
        let judged = day(0.02, seed);
        assert!(judged.findings.is_empty(), "{:?}", judged.findings);
        assert_ne!(judged.grade, Grade::Bad);
    }
}

/// At 0.5 Hz noise takes such runs away, one so far that it cannot be decoupled.
#[test]
fn neg_what_undoing_a_high_pass_makes_of_noise_is_called_noise() {
    for seed in [501, 506] {
        let judged = day(0.5, seed);
        assert_eq!(judged.grade, Grade::Bad);
        assert!(!judged.findings.is_empty());
        for finding in &judged.findings {
            assert_eq!(finding.cause, Cause::Noisy, "{finding:?}");
        }
    }
}

//! Steps 2 to 4 repeated until k/m stands still, on short runs in MuJoCo: it does without errors, and says so when it does not.

use std::sync::OnceLock;

use sixaxis_calibration::conditioning::Conditioning;
use sixaxis_calibration::iteration::{Criterion, End};
use sixaxis_calibration::steps::{Campaign, FourSteps, GyroscopeGain};
use sixaxis_core::Geometry;
use sixaxis_core::identify::Reason;
use sixaxis_props::compare::within;
use sixaxis_props::problem::rig::{DIRECTIONS, simulate_trial};
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_props::truth::InCore;
use sixaxis_recordings::session::{Preprocessing, Role, Stage};
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::paper;
use sixaxis_reference::rig::run::Mode;

/// Zero drift that step 1 missed, over full scale: a hundred times what moves k/m by a few per cent.
const DRIFT_OVER_FULL_SCALE: f64 = 1e-4;

/// Noise-free runs and the four steps on them, simulated once for all tests.
fn played() -> &'static (Campaign, FourSteps) {
    static PLAYED: OnceLock<(Campaign, FourSteps)> = OnceLock::new();
    PLAYED.get_or_init(|| {
        let truth = truth::identified_parameters();
        let laboratory = Laboratory::noise_free(truth::sensor(&truth));
        let conditioning = Conditioning {
            level_samples: None,
            stages: Preprocessing {
                low_pass: Stage::Switch(false),
                ..Preprocessing::default()
            },
            accelerometer_bandwidth_hz: None,
            gyroscope_bandwidth_hz: None,
        };
        let mut trials = Vec::new();
        for (role, mode, frequency_hz) in [
            (Role::Linear, Mode::Linear, 2.0),
            (Role::Angular, Mode::Angular, 2.0),
            (Role::HighFrequencyLinear, Mode::Linear, 5.0),
        ] {
            for direction in DIRECTIONS {
                let run = simulate_trial(&truth, mode, frequency_hz, direction);
                let trial = laboratory.record(&run, 0).trial(role);
                let conditioned = conditioning.condition(&trial).expect("a sound recording");
                trials.push((trial, conditioned));
            }
        }
        let campaign = Campaign {
            geometry: Geometry::PAPER,
            design: truth::design_parameters(),
            static_voltage_v: laboratory.record_static().voltage_v,
            trials,
        };
        let found = campaign
            .identify(GyroscopeGain::Trusted)
            .expect("three directions are enough");
        (campaign, found)
    })
}

#[test]
fn ref_without_errors_k_over_m_stands_still_wherever_it_starts() {
    let (campaign, first) = played();
    let truth = paper::STIFFNESS_PER_MASS_PER_S2;
    for start in [
        None,
        Some(paper::DESIGN_STIFFNESS_PER_MASS_PER_S2),
        Some(0.5 * truth),
        Some(2.0 * truth),
    ] {
        let iteration = campaign
            .repeat_until(first, start, &Criterion::default())
            .expect("every pass is done");
        assert_eq!(
            iteration.end,
            End::Converged,
            "from {start:?}: {:?}",
            iteration.passes
        );
        let found = iteration
            .stiffness_per_mass_per_s2()
            .expect("it stands still");
        within(
            "k/m that stands still",
            (found / truth - 1.0).abs(),
            tolerance::REPEATED_STEPS[3],
        );
        // The passes hand on what they found.
        for pair in iteration.passes.windows(2).skip(1) {
            assert_eq!(pair[1].kept_per_s2, Some(pair[0].found_per_s2));
        }
    }
}

#[test]
fn ref_too_few_passes_are_not_called_converged() {
    let (campaign, first) = played();
    let start = Some(paper::DESIGN_STIFFNESS_PER_MASS_PER_S2);
    let criterion = Criterion {
        passes: 1,
        ..Criterion::default()
    };
    let iteration = campaign
        .repeat_until(first, start, &criterion)
        .expect("every pass is done");
    assert!(
        matches!(iteration.end, End::StillMoving { .. }),
        "{:?}",
        iteration.end
    );
    assert_eq!(iteration.stiffness_per_mass_per_s2(), None);
}

#[test]
fn ref_a_drift_error_ends_it_with_a_verdict() {
    let (campaign, first) = played();
    let mut drifted = campaign.clone();
    for (trial, conditioned) in &mut drifted.trials {
        for row in &mut conditioned.voltage_v {
            row[1] += DRIFT_OVER_FULL_SCALE * trial.full_scale_v;
        }
    }
    let start = Some(paper::DESIGN_STIFFNESS_PER_MASS_PER_S2);
    let iteration = drifted
        .repeat_until(first, start, &Criterion::default())
        .expect("every pass is done");
    assert!(
        matches!(
            iteration.end,
            End::Undetermined {
                reason: Reason::EdgeOfGrid | Reason::Flat { .. }
            }
        ),
        "{:?}",
        iteration.end
    );
    assert!(iteration.sentence().contains("tap the shell"));
    assert_eq!(iteration.stiffness_per_mass_per_s2(), None);
}

#[test]
fn ref_without_trials_for_step_4_there_is_nothing_to_repeat() {
    let (campaign, _) = played();
    let mut short = campaign.clone();
    short
        .trials
        .retain(|(trial, _)| trial.role != Role::HighFrequencyLinear);
    let first = short
        .identify(GyroscopeGain::Trusted)
        .expect("steps 1 to 3");
    let iteration = short
        .repeat_until(&first, None, &Criterion::default())
        .expect("nothing to do");
    assert_eq!(iteration.end, End::NoStepFour);
    assert!(iteration.passes.is_empty());
}

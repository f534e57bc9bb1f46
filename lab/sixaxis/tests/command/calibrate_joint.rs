//! `sixaxis calibrate --estimator joint` on sessions whose truth the test knows and the command does not.

use std::path::Path;
use std::process::Output;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::Value;
use sixaxis_reference::laboratory::defect::{Defect, Kind, Where};
use sixaxis_reference::laboratory::plan::{DefectChoice, Engine, SensorChoice, SessionPlan};
use sixaxis_reference::laboratory::session::{SimulatedSession, simulate_session};
use sixaxis_reference::rig::run::Mounting;
use sixaxis_reference::sensor::TrueSensor;

use crate::program::{Session, code, run, stderr, stdout, text};

/// Half widths of 95 % that an estimate may be off by: two are 3.9 standard deviations, which of the 24 parameters of one
/// session one misses in four hundred sessions.
const HALF_WIDTHS: f64 = 2.0;
/// Wedges as a good workshop makes them, degrees.
const WEDGE_DEG: f64 = 0.05;
/// Spread of the limbs' stiffnesses that a healthy sensor may have.
const STIFFNESS_SPREAD: f64 = 0.002;
/// Share of the force that lags as friction does: soft ceramics.
const FRICTION: f64 = 3e-3;
/// Share by which sensitivities rise within a trial.
const WARMING: f64 = 3e-3;
/// Share of samples that are wild.
const WILD: f64 = 0.01;
/// Class of standards whose certificate is too narrow to cover what wild samples do, %.
const FINE_CLASS_PERCENT: f64 = 0.1;
/// Sample rate that leaves nothing above the harmonics to tell the noise from, Hz.
const TOO_SLOW_HZ: f64 = 100.0;

fn plan(seed: u64) -> SessionPlan {
    println!("seed {seed}");
    let mut plan = SessionPlan {
        seed,
        sensor: SensorChoice::Random,
        engine: Engine::Rigid,
        static_duration_s: 60.0,
        ..SessionPlan::default()
    };
    plan.rig.wedge_error_deg = WEDGE_DEG;
    plan
}

fn written(name: &str, played: &SimulatedSession) -> Session {
    Session::write(&format!("calibrate-joint-{name}"), played)
}

fn calibrate(session: &Path, arguments: &[&str]) -> Output {
    run(&[&["calibrate", text(session)], arguments].concat())
}

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).expect("JSON")
}

fn calibration(session: &Path) -> Value {
    let path = session.with_file_name("calibration.json");
    json(&std::fs::read(path).expect("a calibration"))
}

fn page(session: &Path) -> String {
    std::fs::read_to_string(session.with_file_name("calibration.html")).expect("a page")
}

/// The parameters but k/m, in the paper's order.
fn true_values(truth: &TrueSensor) -> Vec<f64> {
    let mut values = truth.zero_drift_v.to_vec();
    values.extend(truth.scale_per_mass_per_kg);
    values.extend(truth.inertia_per_mass.to_paper_order());
    values
}

/// The largest error over its half width, and whose it is.
fn worst(intervals: &Value, truth: &TrueSensor) -> (f64, String) {
    let intervals = intervals.as_array().expect("a list");
    true_values(truth)
        .into_iter()
        .zip(intervals)
        .map(|(truth, found)| {
            let number = |key: &str| found[key].as_f64().expect("a number");
            let off = (number("estimate") - truth).abs() / number("half_width_95");
            (off, found["name"].to_string())
        })
        .inspect(|(off, _)| assert!(!off.is_nan()))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .expect("24 parameters")
}

#[test]
fn ref_parameters_are_within_two_half_widths() {
    for (name, mounting) in [
        ("vertical", Mounting::AxisVertical),
        ("level", Mounting::AxisLevel),
    ] {
        let mut plan = plan(14);
        plan.rig.mounting = mounting;
        let played = simulate_session(&plan).expect("a session is played");
        let session = written(name, &played);
        let output = calibrate(&session, &["--estimator", "joint", "--json", "--quiet"]);
        let summary = json(&output.stdout);
        let calibration = calibration(&session);
        assert_eq!(calibration["estimator"], "joint");
        let (off, whose) = worst(&calibration["intervals"], &played.truth.parameters);
        assert!(
            off < HALF_WIDTHS,
            "{name}: {whose} is off by {off} half widths"
        );
        // What is written to decouple with is what is reported.
        let reported = &calibration["intervals"][9]["estimate"];
        assert_eq!(
            &calibration["parameters"]["scale_per_mass_per_kg"][0],
            reported
        );
        let covariance = &calibration["covariance"]["propagated"];
        assert_eq!(covariance["noise"].as_array().map(Vec::len), Some(25));
        let fitted = &summary["joint"]["fitted"];
        let wedges = fitted["nuisances"]["wedges"].as_array().expect("wedges");
        assert!(wedges.iter().all(|w| w["angles_deg"].is_array()));
        let room = &fitted["nuisances"]["room"];
        assert!(
            room["off_plumb_deg"].as_f64().is_some_and(|deg| deg < 0.1),
            "{room}"
        );
        let html = page(&session);
        assert!(html.contains("The joint fit beside the four steps"));
        assert!(html.contains("What instruments, room and wedges turned out to be"));
    }
}

#[test]
fn inv_the_joint_fit_is_the_default_where_it_accounts_for_the_trials() {
    let played = simulate_session(&plan(15)).expect("a session is played");
    let session = written("default", &played);
    let by_default = calibrate(&session, &["--json", "--quiet"]);
    let default_file = calibration(&session);
    assert_eq!(default_file["estimator"], "joint");
    calibrate(&session, &["--estimator", "joint", "--quiet"]);
    assert_eq!(default_file, calibration(&session));
    // Shown beside the four steps, whoever was asked.
    let shown = json(&by_default.stdout)["joint"]["fitted"]["parameters"].clone();
    assert_eq!(shown, default_file["intervals"]);
    calibrate(&session, &["--estimator", "four-steps", "--quiet"]);
    assert_eq!(calibration(&session)["estimator"], "four_steps");
    assert_ne!(
        default_file["parameters"],
        calibration(&session)["parameters"]
    );
}

#[test]
fn ref_channels_that_contradict_the_model_are_a_reservation() {
    let mut plan = plan(14);
    // Limbs that are unequal belong to a room; friction in them does not.
    plan.chain.stiffness_spread = STIFFNESS_SPREAD;
    plan.defect = DefectChoice::Exactly(Defect {
        kind: Kind::Hysteresis,
        magnitude: FRICTION,
        place: Where::Everywhere,
        channel: 0,
        seed: 1,
    });
    let played = simulate_session(&plan).expect("a session is played");
    let session = written("friction", &played);
    calibrate(&session, &["--quiet"]);
    assert_eq!(calibration(&session)["estimator"], "four_steps");
    let output = calibrate(&session, &["--estimator", "joint"]);
    assert_eq!(code(&output), 3, "{}", stdout(&output));
    let said = stdout(&output);
    let unwrapped = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        unwrapped.contains("the channels contradict straight and unhurried sensors"),
        "{said}"
    );
    let (off, whose) = worst(
        &calibration(&session)["intervals"],
        &played.truth.parameters,
    );
    assert!(off < HALF_WIDTHS, "{whose} is off by {off} half widths");
}

/// Sensitivities that rise within each trial contradict the model of both estimators; the four steps' parameters are used, and what is said of
/// them holds.
#[test]
fn ref_trials_that_contradict_each_other_widen_what_is_said_of_the_four_steps() {
    let mut played = simulate_session(&plan(14)).expect("a session is played");
    for recording in played.recordings.iter_mut().skip(1) {
        let rest = recording.voltage_v[0];
        let samples = recording.voltage_v.len() as f64;
        for (index, row) in recording.voltage_v.iter_mut().enumerate() {
            let risen = 1.0 + WARMING * index as f64 / samples;
            for (reading, rest) in row.iter_mut().zip(rest) {
                *reading = rest + risen * (*reading - rest);
            }
        }
    }
    let session = written("warming", &played);
    let output = calibrate(&session, &[]);
    let said = stdout(&output);
    let unwrapped = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(code(&output), 3, "{said}");
    assert!(unwrapped.contains("noise counts "), "{said}");
    let found = calibration(&session);
    assert_eq!(found["estimator"], "four_steps");
    let truth = &played.truth.parameters;
    let (off, whose) = worst(&found["intervals"], truth);
    assert!(off < HALF_WIDTHS, "{whose} is off by {off} half widths");
    // The accelerometer's gain, and what all channels rise by alike, part no two of them: that is left out.
    let noise = &found["covariance"]["propagated"]["noise"];
    let relative: Vec<(f64, f64)> = (9..18)
        .map(|p| {
            let estimate = found["intervals"][p]["estimate"].as_f64();
            let truth = true_values(truth)[p];
            let variance = noise[p][p].as_f64().expect("a variance");
            let off = estimate.expect("a number") / truth - 1.0;
            (off, variance.sqrt() / truth)
        })
        .collect();
    let alike = relative.iter().map(|(off, _)| off).sum::<f64>() / relative.len() as f64;
    let over = relative
        .iter()
        .map(|(off, deviation)| (off - alike) / deviation);
    let over: Vec<f64> = over.collect();
    println!("scale factors, against each other, off by {over:.2?} deviations");
    assert!(over.iter().all(|off| off.abs() < 3.0), "{over:?}");
    // Nor so wide that nothing is said.
    assert!(relative.iter().all(|(_, deviation)| *deviation < 0.1));
}

#[test]
fn ref_wild_samples_bend_least_squares_and_not_the_robust_fit() {
    let mut plan = plan(14);
    plan.instruments.class_percent = FINE_CLASS_PERCENT;
    let mut played = simulate_session(&plan).expect("a session is played");
    let mut rng = Pcg64::seed_from_u64(plan.seed);
    let full_scale = plan.chain.full_scale_v;
    // The static record stays: its mean is step 1's.
    for recording in played.recordings.iter_mut().skip(1) {
        for voltage in recording.voltage_v.iter_mut().flatten() {
            if rng.random::<f64>() < WILD {
                *voltage = rng.random_range(-full_scale..full_scale);
            }
        }
    }
    let session = written("wild", &played);
    let off = |arguments: &[&str]| {
        calibrate(&session, arguments);
        worst(
            &calibration(&session)["intervals"],
            &played.truth.parameters,
        )
    };
    let (bent, _) = off(&["--estimator", "joint", "--quiet"]);
    assert!(bent > HALF_WIDTHS, "least squares: {bent} half widths");
    let (straight, whose) = off(&["--estimator", "joint", "--robust", "--quiet"]);
    assert!(
        straight < HALF_WIDTHS,
        "{whose} is off by {straight} half widths"
    );
    assert_eq!(calibration(&session)["estimator"], "joint_robust");
}

#[test]
fn refusals_are_sentences() {
    let mut plan = plan(14);
    plan.sample_rate_hz = TOO_SLOW_HZ;
    let played = simulate_session(&plan).expect("a session is played");
    let session = written("slow", &played);
    let output = calibrate(&session, &["--estimator", "joint"]);
    assert_eq!(code(&output), 1, "{}", stdout(&output));
    assert!(
        stdout(&output).contains("joint fit refused"),
        "{}",
        stdout(&output)
    );
    assert!(!session.with_file_name("calibration.json").exists());
    assert!(page(&session).contains("It cannot be had"));
    let output = calibrate(&session, &["--robust"]);
    assert_eq!(code(&output), 2);
    let said = stderr(&output);
    assert!(said.contains("add --estimator joint"), "{said}");
}

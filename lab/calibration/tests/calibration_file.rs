//! The calibration file: what decoupling needs stands in it as a value, and what does not say it is refused.

use std::path::PathBuf;

use serde_json::{Value, json};
use sixaxis_calibration::Error;
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::calibration::Calibration;

/// Corner of a charge amplifier, Hz.
const CORNER_HZ: f64 = 0.02;

/// A calibration of the paper's sensor whose session file is of a version that this program cannot parse.
fn file(corner_hz: Value) -> Value {
    let (zeros, ones) = ([0.0; 9], [1.0; 9]);
    let limbs: Vec<String> = (1..=9).map(|limb| format!("u{limb}")).collect();
    json!({
        "format": "sixaxis-calibration-2",
        "verdict": "good",
        "findings": [],
        "sensor": {
            "serial": "7",
            "limb_length_m": 0.025,
            "half_edge_m": 0.026,
            "full_scale_v": 10.0,
            "gain_n_per_v": [5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 5.0],
            "amplifier_high_pass_hz": corner_hz,
        },
        "parameters": {
            "zero_drift_v": zeros,
            "scale_per_mass_per_kg": ones,
            "inertia_per_mass_m2": [4e-4, 4e-4, 4e-4, 0.0, 0.0, 0.0],
            "stiffness_per_mass_per_s2": 1e9,
        },
        "intervals": [],
        "covariance": { "zero_drift_v2": zeros, "scale_per_mass_per_kg2": [], "inertia_per_mass_m4": [] },
        "channels": { "limbs": limbs, "accelerometer": "a", "gyroscope": "w" },
        "provenance": { "sixaxis_version": "0.1.0", "session": "a_later_key = true", "recordings": [] },
    })
}

fn read(name: &str, file: &Value) -> Result<Calibration, Error> {
    let path: PathBuf = std::env::temp_dir().join(format!(
        "sixaxis-calibration-file-{}-{name}.json",
        std::process::id()
    ));
    std::fs::write(&path, file.to_string()).expect("the file is written");
    let read = Calibration::read(&path);
    std::fs::remove_file(&path).expect("the file is removed");
    read
}

/// The key that a file is refused for, and why.
fn refusal(name: &str, file: &Value) -> (String, String) {
    match read(name, file) {
        Err(Error::Recording(sixaxis_recordings::Error::Session { key, cause, .. })) => {
            (key, cause)
        }
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn regress_the_high_pass_needs_no_session_text() {
    for corner_hz in [Some(CORNER_HZ), None] {
        let calibration = read("value", &file(json!(corner_hz))).expect("it can be read");
        let setup =
            Setup::new(&calibration, None, None, &Overrides::default()).expect("it is set up");
        assert_eq!(setup.conditioning.amplifier_high_pass_hz, corner_hz);
    }
}

#[test]
fn regress_a_file_that_does_not_say_the_high_pass_is_refused() {
    let mut old = file(json!(CORNER_HZ));
    old["format"] = json!("sixaxis-calibration-1");
    old["sensor"]
        .as_object_mut()
        .expect("an object")
        .remove("amplifier_high_pass_hz");
    let (key, cause) = refusal("old", &old);
    assert_eq!(key, "format");
    assert!(cause.contains("calibrate again"), "{cause}");
    // The same without the key, in a file that claims to be of this version.
    old["format"] = json!("sixaxis-calibration-2");
    let (_, cause) = refusal("without", &old);
    assert!(cause.contains("amplifier_high_pass_hz"), "{cause}");
    let (key, _) = refusal("negative", &file(json!(-1.0)));
    assert_eq!(key, "sensor.amplifier_high_pass_hz");
}

//! The calibration file: what decoupling needs stands in it as a value, and what does not say it is refused. As a Rust source it
//! compiles to the same bits.

use std::path::PathBuf;
use std::process::Command;

use serde_json::{Value, json};
use sixaxis_calibration::Error;
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::calibration::{Calibration, FORMAT};

/// Corner of a charge amplifier, Hz.
const CORNER_HZ: f64 = 0.02;

/// A calibration of the paper's sensor whose session file is of a version that this program cannot parse.
fn file(corner_hz: Value) -> Value {
    let (zeros, ones) = ([0.0; 9], [1.0; 9]);
    let limbs: Vec<String> = (1..=9).map(|limb| format!("u{limb}")).collect();
    json!({
        "format": FORMAT,
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
        let gains = Overrides {
            gain_n_per_v: vec![0.1],
            ..Overrides::default()
        };
        let setup = Setup::new(&calibration, None, None, &gains).expect("it is set up");
        assert_eq!(setup.conditioning.amplifier_high_pass_hz, corner_hz);
    }
}

#[test]
fn regress_a_file_of_an_earlier_version_is_refused_for_what_it_lacks() {
    let mut old = file(json!(CORNER_HZ));
    old["format"] = json!("sixaxis-calibration-1");
    old["sensor"]
        .as_object_mut()
        .expect("an object")
        .remove("amplifier_high_pass_hz");
    let (key, cause) = refusal("old", &old);
    assert_eq!(key, "format");
    assert!(
        cause.contains("high-pass") && cause.contains("calibrate again"),
        "{cause}"
    );
    // The same without the key, in a file that claims to be of this version.
    old["format"] = json!(FORMAT);
    let (_, cause) = refusal("without", &old);
    assert!(cause.contains("amplifier_high_pass_hz"), "{cause}");
    // What was known of zeros and sensitivities is not all that a run is decoupled with.
    let mut narrower = file(json!(CORNER_HZ));
    narrower["format"] = json!("sixaxis-calibration-2");
    let (key, cause) = refusal("narrower", &narrower);
    assert_eq!(key, "format");
    assert!(
        cause.contains("zeros and sensitivities") && cause.contains("calibrate again"),
        "{cause}"
    );
    let (key, _) = refusal("negative", &file(json!(-1.0)));
    assert_eq!(key, "sensor.amplifier_high_pass_hz");
}

/// A program that prints the constants of `calibration.rs`, numbers by their bits; its `sixaxis_core` has the fields alone.
const PRINTS_CONSTANTS: &str = r#"
mod sixaxis_core {
    pub struct Geometry { pub limb_length_m: f64, pub half_edge_m: f64 }
    pub struct Gains { pub gain_n_per_v: [f64; 9] }
    pub struct Sensor { pub geometry: Geometry, pub gains: Gains }
    pub struct InertiaPerMass(pub [f64; 6]);
    impl InertiaPerMass { pub const fn from_paper_order(i: [f64; 6]) -> Self { Self(i) } }
    pub struct Parameters {
        pub zero_drift_v: [f64; 9],
        pub scale_per_mass_per_kg: [f64; 9],
        pub inertia_per_mass: InertiaPerMass,
        pub stiffness_per_mass_per_s2: f64,
    }
}
mod calibration {
    use super::sixaxis_core;
    include!("calibration.rs");
}
use calibration::*;
fn main() {
    let geometry = &SENSOR.geometry;
    let numbers = [geometry.limb_length_m, geometry.half_edge_m, FULL_SCALE_V, PARAMETERS.stiffness_per_mass_per_s2];
    let all = numbers
        .iter()
        .chain(&SENSOR.gains.gain_n_per_v)
        .chain(&PARAMETERS.zero_drift_v)
        .chain(&PARAMETERS.scale_per_mass_per_kg)
        .chain(&PARAMETERS.inertia_per_mass.0)
        .chain(&STIFFNESS_RATIO)
        .chain(AMPLIFIER_HIGH_PASS_HZ.as_slice())
        .chain(LIMBS_LAG_US.as_slice().as_flattened());
    for number in all {
        println!("{:016x}", number.to_bits());
    }
    println!("{VERDICT}");
    print!("{SERIAL}");
}
"#;

/// Compiles the source and returns what [`PRINTS_CONSTANTS`] prints; none where it does not compile.
fn compiled(name: &str, source: &str) -> Option<String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("calibration.rs"), source).expect("the source");
    std::fs::write(folder.join("main.rs"), PRINTS_CONSTANTS).expect("the program");
    let rustc = Command::new("rustc")
        .args(["--edition", "2024", "main.rs"])
        .current_dir(&folder)
        .output()
        .expect("rustc starts");
    let printed = rustc.status.success().then(|| {
        let output = Command::new(folder.join("main")).output().expect("it runs");
        String::from_utf8(output.stdout).expect("UTF-8")
    });
    std::fs::remove_dir_all(&folder).expect("the folder is removed");
    printed
}

#[test]
fn inv_as_a_rust_source_it_compiles_to_the_same_bits() {
    // Text from a session must end no literal and no comment, and turn no line around.
    let serial = "7\"; pub const SERIAL: &str = \"8\\\n*/ }\u{202e}ü";
    let session = "# \u{202e}\r\ntitle = '''\n'''; fn main() {}\u{2028}\r fn main() {}\n*/ }";
    let mut file = file(json!(CORNER_HZ));
    file["sensor"]["serial"] = json!(serial);
    file["sensor"]["gain_n_per_v"][4] = json!(-0.1);
    file["provenance"]["session"] = json!(session);
    file["provenance"]["recordings"] = json!([["a\nfn main() {}", 7]]);
    file["channels"]["limbs_lag_us"] = json!([1.5, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, -3.0]);
    file["parameters"]["zero_drift_v"] = json!([
        0.1 + 0.2,
        5e-324,
        -f64::MAX,
        1e16,
        1.0 / 3.0,
        -0.0,
        1e-7,
        7.0,
        0.0
    ]);
    let calibration = read("rust", &file).expect("it can be read");
    let sensor = &calibration.sensor;
    let p = &calibration.parameters;
    let numbers = [
        sensor.limb_length_m,
        sensor.half_edge_m,
        sensor.full_scale_v,
        p.stiffness_per_mass_per_s2,
    ];
    let ratios = calibration
        .limbs
        .as_ref()
        .map(|limbs| limbs.stiffness_ratio);
    let ratios = ratios.unwrap_or([1.0; 9]);
    let lags_us = calibration.channels.limbs_lag_us.map(|lags| lags.each());
    let all = numbers
        .iter()
        .chain(&sensor.gain_n_per_v)
        .chain(&p.zero_drift_v)
        .chain(&p.scale_per_mass_per_kg)
        .chain(&p.inertia_per_mass_m2)
        .chain(&ratios)
        .chain(sensor.amplifier_high_pass_hz.as_slice())
        .chain(lags_us.as_slice().as_flattened());
    let bits: String = all
        .map(|number| format!("{:016x}\n", number.to_bits()))
        .collect();
    let expected = format!("{bits}good\n{serial}");
    let printed = compiled("rust-source", &calibration.rust_source());
    assert_eq!(printed.as_deref(), Some(&*expected));
    // What is not a number must not get into a firmware.
    let mut broken = calibration.clone();
    broken.parameters.zero_drift_v[3] = f64::NAN;
    assert_eq!(compiled("rust-source-nan", &broken.rust_source()), None);
}

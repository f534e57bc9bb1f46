//! Noise figures of `sixaxis inspect`: of records of known density, and of the six accelerations against a decoupled record.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde_json::Value;

use crate::program::{Folder, done, run, stdout};

fn inspected(arguments: &[&str]) -> Value {
    let output = done(&[&["inspect", "--json"], arguments].concat());
    let document: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    document["files"][0].clone()
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

/// White noise of 3 mV/rtHz on a walk of 1 mV/rts, for 1000 s at 100 Hz, and the white noise alone.
#[test]
fn stat_known_densities_are_found() {
    let folder = Folder::new("noise");
    let (mut rng, rate_hz, mut mean) = (Pcg64::seed_from_u64(3), 100.0_f64, 5.0);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut text = format!("# sample_rate_hz = {rate_hz}\nu [V],w [V]\n");
    for _ in 0..100_000 {
        let white = 3e-3 * (0.5 * rate_hz).sqrt() * normal();
        mean += 1e-3 / rate_hz.sqrt() * normal();
        text += &format!("{},{}\n", mean + white, white);
    }
    let file = folder.write("rest.csv", &text);
    let page = folder.file("rest.html");
    // One sample that is no noise counts in the noise, and is told.
    let wild = text.clone() + "0,1\n";
    let wild = stdout(&run(&[
        "inspect",
        &folder.write("wild.csv", wild),
        "--at-rest",
    ]));
    let told = |words: &str| words.contains("has a wild sample or more: one is 1");
    assert!(told(&wild), "{wild}");
    let found = inspected(&[&file, "--at-rest", "--picture", &page]);
    let [walking, white] = [0, 1].map(|k| &found["groups"][0]["channels"][k]);
    for channel in [walking, white] {
        // Third differences take the walk for a little more noise.
        assert!((number(&channel["noise_density"]) / 3e-3 - 1.0).abs() < 0.02);
        let density = &channel["stability"]["noise_density"];
        let off = (number(&density["value"]) - 3e-3) / number(&density["standard_error"]);
        assert!(off.abs() < 4.0, "{density}");
    }
    let walk = &walking["stability"]["random_walk"];
    let off = (number(&walk["value"]) / 1e-3).ln()
        / (number(&walk["standard_error"]) / number(&walk["value"]));
    assert!(off.abs() < 4.0, "{walk}");
    assert!(walking["stability"]["bias_instability"].is_array());
    for absent in ["random_walk", "bias_instability"] {
        assert!(white["stability"][absent].is_null());
        let why = white["stability"]["absent"][absent]
            .as_str()
            .expect("a reason");
        assert!(why.starts_with("record too short"), "{why}");
    }
    // In words and in pictures; and nothing of a record that nobody says to be at rest.
    let words = stdout(&run(&["inspect", &file, "--at-rest"]));
    assert!(!told(&words), "{words}");
    assert!(
        words.contains("at rest (Allan deviation)")
            && words.contains("no random walk of w: record too short"),
        "{words}"
    );
    let drawn = std::fs::read_to_string(&page).expect("a page");
    for part in [
        "Allan deviation",
        "averaging time",
        "bias instability",
        "per √s",
    ] {
        assert!(drawn.contains(part), "{part}");
    }
    let moving = inspected(&[&file]);
    assert!(
        moving["groups"][0]["channels"][0]
            .get("stability")
            .is_none()
    );
}

/// The accelerations' noise by the channels' and the calibration is that of the static record, decoupled.
#[test]
fn ref_the_noise_of_the_accelerations_is_that_of_the_decoupled_record() {
    let folder = Folder::new("axis_noise");
    let [day, decoupled] = ["day", "decoupled.npz"].map(|name| folder.file(name));
    done(&[
        "simulate", "--engine", "rigid", "--format", "npz", "--out", &day, "--sensor", "random",
        "--seed", "11",
    ]);
    let [session, calibration, rest] = ["session.toml", "calibration.json", "static.npz"]
        .map(|name| folder.file(&format!("day/{name}")));
    run(&["calibrate", &session]);
    done(&[
        "decouple",
        &calibration,
        &rest,
        "--session",
        &session,
        "--out",
        &decoupled,
        "--accelerations",
        "--frame",
        "sensor",
        "--force",
    ]);
    let axes = inspected(&[&rest, "--session", &session, "--calibration", &calibration]);
    let axes = axes["axis_noise"].as_array().expect("six axes").clone();
    let found = inspected(&[&decoupled]);
    let columns = found["groups"][0]["channels"]
        .as_array()
        .expect("columns")
        .clone();
    assert_eq!(axes.len(), 6);
    // Of one record two estimates: by third differences, relative variance 2.31 / 2n (their autocorrelation is -3/4, 3/10, -1/20), and
    // by the Allan deviation, 1 / 2n; four standard deviations of both.
    let samples = number(&found["groups"][0]["samples"]);
    let scatter = 4.0 * (3.31 / (2.0 * samples)).sqrt();
    assert!(scatter < 0.2, "{samples} samples tell nothing");
    let (mut stated, mut decoupled) = ([0.0; 2], [0.0; 2]);
    for (k, axis) in axes.iter().enumerate() {
        let column = columns
            .iter()
            .find(|c| c["name"] == in_sensor_axes(&axis["axis"]))
            .expect("a column");
        let unit = axis["unit"].as_str().expect("a unit");
        assert!(
            unit.starts_with(column["unit"]["name"].as_str().expect("a unit")),
            "{unit}"
        );
        // In ground axes the open loop would turn about itself in ten minutes; at rest and in sensor axes nothing turns.
        stated[k / 3] += number(&axis["noise_density"]).powi(2);
        decoupled[k / 3] += number(&column["noise_density"]).powi(2);
    }
    for (stated, decoupled) in stated.iter().zip(decoupled) {
        let ratio = (stated / decoupled).sqrt();
        assert!((ratio - 1.0).abs() < scatter, "{ratio}");
    }
}

/// The column of the sensor's axes that is a ground axis' at rest.
fn in_sensor_axes(axis: &Value) -> String {
    let axis = axis.as_str().expect("a name");
    axis.strip_prefix("alpha_").map_or_else(
        || axis.replace('a', "f"),
        |direction| format!("alpha_sensor_{direction}"),
    )
}

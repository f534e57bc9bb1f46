//! A session file is refused where it is wrong: file, line, key and cause.

use std::path::Path;

use sixaxis_recordings::Error;
use sixaxis_recordings::session::{Role, SessionFile};

/// A session that is accepted, with what every test below changes.
const GOOD: &str = r#"title = "Sensor 7"

[sensor]
serial = "7"
limb_length_mm = 25.5
half_edge_mm = 21.0
full_scale_v = 10.0
gain_n_per_v = 10.0

[sensor.design]
scale_per_mass_per_kg = 5.3476
inertia_per_mass_mm2 = [238.76, 250.71, 252.588, 0.0512, -0.0295, 0.5544]
stiffness_per_mass_per_s2 = 3.1e8

[accelerometer]
sensitivity_mv_per_g = 200.0
class_percent = 1.0

[gyroscope]
class_percent = 1.0
bandwidth_hz = 10.0

[rig]
stroke_mm = 186.0

[channels]
limbs_unit = "V"

[preprocessing]
outliers = { half_width = 7, sigmas = 8.0 }

[[recording]]
file = "static.csv"
role = "static"

[[recording]]
file = "linear-01.csv"
role = "linear"
direction = [1, 0, 0]
frequency_hz = 1.0
"#;

fn parse(text: &str) -> Result<SessionFile, Error> {
    SessionFile::parse(Path::new("day/session.toml"), text.to_owned())
}

/// Replaces one piece of the good session, parses it, and returns the line and the key that the refusal names.
fn refusal(from: &str, to: &str) -> (usize, String, String) {
    assert_eq!(GOOD.matches(from).count(), 1, "{from:?} is not unique");
    let text = GOOD.replace(from, to);
    match parse(&text) {
        Err(Error::Session {
            path,
            line,
            key,
            cause,
        }) => {
            assert_eq!(path, Path::new("day/session.toml"));
            (line.expect("a line"), key, cause)
        }
        other => panic!("{other:?}"),
    }
}

/// Line of a piece of the good session, from 1.
fn line_of(piece: &str) -> usize {
    1 + GOOD[..GOOD.find(piece).expect("it is there")]
        .matches('\n')
        .count()
}

#[test]
fn a_good_session_is_read() {
    let file = parse(GOOD).expect("it is good");
    assert_eq!(file.session.recording[1].role, Role::Linear);
    assert_eq!(
        file.resolve(&file.session.recording[1].file),
        Path::new("day/linear-01.csv")
    );
    assert_eq!(
        file.session.sensor.design().scale_per_mass_per_kg,
        [5.3476; 9]
    );
    assert_eq!(file.session.channels.limbs[8], "u9");
}

#[test]
fn refusals_name_line_and_key() {
    for (from, to, key, at) in [
        (
            "half_edge_mm = 21.0",
            "half_edge_mm = -21.0",
            "sensor.half_edge_mm",
            "half_edge_mm",
        ),
        // Metres, of which a calibration would still be good and what it decouples wrong.
        (
            "limb_length_mm = 25.5",
            "limb_length_mm = 0.0255",
            "sensor.limb_length_mm",
            "limb_length_mm",
        ),
        (
            "half_edge_mm = 21.0",
            "half_edge_mm = 0.021",
            "sensor.half_edge_mm",
            "half_edge_mm",
        ),
        (
            "gain_n_per_v = 10.0",
            "gain_n_per_v = 0.0",
            "sensor.gain_n_per_v",
            "gain_n_per_v",
        ),
        (
            "class_percent = 1.0\nbandwidth_hz",
            "class_percent = 0.0\nbandwidth_hz",
            "gyroscope.class_percent",
            "class_percent = 1.0\nbandwidth_hz",
        ),
        (
            "class_percent = 1.0\nbandwidth_hz",
            "delay_ms = -3.0\nclass_percent = 1.0\nbandwidth_hz",
            "gyroscope.delay_ms",
            "class_percent = 1.0\nbandwidth_hz",
        ),
        (
            "sensitivity_mv_per_g = 200.0",
            "gain_percent = 1.1",
            "accelerometer.gain_percent",
            "sensitivity_mv_per_g",
        ),
        (
            "class_percent = 1.0\nbandwidth_hz",
            "gain_percent = 0.0\nclass_percent = 1.0\nbandwidth_hz",
            "gyroscope.gain_percent",
            "class_percent = 1.0\nbandwidth_hz",
        ),
        (
            "stroke_mm = 186.0",
            "wedge_deg = -0.1",
            "rig.wedge_deg",
            "stroke_mm",
        ),
        (
            "stroke_mm = 186.0",
            "gravity_m_s2 = 980.6",
            "rig.gravity_m_s2",
            "stroke_mm",
        ),
        (
            "stroke_mm = 186.0",
            "wedge_deg = 45.0",
            "rig.wedge_deg",
            "stroke_mm",
        ),
        (
            "stroke_mm = 186.0",
            "wedge_deg = nan",
            "rig.wedge_deg",
            "stroke_mm",
        ),
        (
            "direction = [1, 0, 0]",
            "direction = [0, 0, 0]",
            "recording[1].direction",
            "direction",
        ),
        (
            "frequency_hz = 1.0",
            "frequency_hz = nan",
            "recording[1].frequency_hz",
            "frequency_hz",
        ),
        (
            "limbs_unit = \"V\"",
            "limbs_unit = \"MV\"",
            "channels.limbs_unit",
            "limbs_unit",
        ),
        (
            "stiffness_per_mass_per_s2 = 3.1e8",
            "stiffness_per_mass_per_s2 = 3.1",
            "sensor.design",
            "[sensor.design]",
        ),
        (
            "outliers = { half_width = 7, sigmas = 8.0 }",
            "outliers = true",
            "preprocessing.outliers",
            "outliers",
        ),
        (
            "full_scale_v = 10.0",
            "full_scale_v = \"ten\"",
            "sensor.full_scale_v",
            "full_scale_v",
        ),
        (
            "serial = \"7\"",
            "serial = \"7\"\ncolour = \"red\"",
            "sensor.colour",
            "limb_length_mm",
        ),
    ] {
        let (line, named, cause) = refusal(from, to);
        assert_eq!(named, key, "{cause}");
        assert_eq!(line, line_of(at), "{key}: {cause}");
        assert!(!cause.is_empty());
    }
}

/// The other side of each limit: what a certificate or a workshop may well say.
#[test]
fn parts_of_a_certificate_may_be_all_of_it() {
    let text = GOOD
        .replace(
            "class_percent = 1.0",
            "class_percent = 1.0\ngain_percent = 1.0",
        )
        .replace("stroke_mm = 186.0", "wedge_deg = 0.0");
    let file = parse(&text).expect("both limits are allowed");
    let certified = &file.session.accelerometer;
    assert_eq!(certified.gain_percent, Some(certified.class_percent));
}

#[test]
fn what_is_missing_is_named() {
    let (line, key, cause) = refusal("frequency_hz = 1.0\n", "");
    assert_eq!(key, "recording[1].frequency_hz");
    // The recording that should have it.
    assert_eq!(line, line_of("[[recording]]\nfile = \"linear"), "{cause}");
    let (_, _, cause) = refusal("half_edge_mm = 21.0\n", "");
    assert!(cause.contains("half_edge_mm"), "{cause}");
}

#[test]
fn nonsense_is_refused() {
    for text in [
        "",
        "x",
        "[sensor",
        "recording = 3",
        "\u{0}",
        "[[recording]]",
    ] {
        assert!(
            matches!(parse(text), Err(Error::Session { .. })),
            "{text:?}"
        );
    }
    let twice = GOOD.replace(
        "limbs_unit = \"V\"",
        "limbs = [\"a\", \"a\", \"c\", \"d\", \"e\", \"f\", \"g\", \"h\", \"i\"]",
    );
    let error = parse(&twice).expect_err("a channel stands there twice");
    assert!(error.to_string().contains("channels.limbs"), "{error}");
}

#[test]
fn the_schema_knows_every_key_of_the_example() {
    let schema = sixaxis_recordings::session::schema().to_string();
    for key in [
        "limb_length_mm",
        "sensitivity_mv_per_g",
        "amplifier_high_pass_hz",
        "reference_file",
        "high_frequency_linear",
    ] {
        assert!(schema.contains(key), "{key}");
    }
}

//! Recordings that are not what they seem: cut off, copied, on another clock, of another file.

use std::fs;

use crate::mistakes::{calibrated, rewritten, with_entry};
use crate::program::{code, done, run, stderr, stdout, text};
use crate::self_calibrate::day;

/// Columns of the day's trials.
const ACCELEROMETER: usize = 9;
const GYROSCOPE: usize = 10;

#[test]
fn neg_a_standard_that_is_cut_off_is_told() {
    for (recording, column, limit, name) in [
        ("angular-05", GYROSCOPE, 4.0, "gyroscope"),
        ("linear-07", ACCELEROMETER, 3.0, "accelerometer"),
        ("compound-03", GYROSCOPE, 10.0, "gyroscope"),
    ] {
        let file = format!("cut-{recording}.csv");
        rewritten(&format!("{recording}.csv"), &file, |row| {
            row[column] = row[column].clamp(-limit, limit);
        });
        let (code, said) = calibrated(&format!("cut-{recording}"), |s| {
            s.replace(&format!("{recording}.csv"), &file)
        });
        assert_eq!(code, 4, "{said}");
        let wanted = format!("converter clips: {file} the standard {name} is cut off");
        assert!(said.contains(&wanted), "{said}");
    }
}

#[test]
fn neg_a_column_that_stands_there_twice_is_told() {
    rewritten("linear-05.csv", "twice.csv", |row| row[3] = row[2]);
    let (code, said) = calibrated("twice", |s| s.replace("linear-05.csv", "twice.csv"));
    assert_eq!(code, 4, "{said}");
    let wanted =
        "twice.csv; channels 3 and 4 channels 3 and 4 are the same, sample by sample Parameters";
    assert!(said.contains(wanted), "{said}");
    // In all recordings, by the names.
    let (code, said) = calibrated("named-twice", |s| s.replace("\"u4\"", "\"u3\""));
    assert!(matches!(code, 1 | 4), "{said}");
    assert!(said.contains("u3"), "{said}");
}

#[test]
fn neg_a_second_static_record_is_held_against_the_first() {
    let with_second = |name: &str| {
        let entry = format!("\n[[recording]]\nfile = \"{name}.csv\"\nrole = \"static\"\n");
        calibrated(name, |s| format!("{s}{entry}"))
    };
    rewritten("static.csv", "evening.csv", |row| row[4] += 2e-4);
    let (code, said) = with_second("evening");
    assert!(
        matches!(code, 0 | 3) && !said.contains("evening.csv"),
        "{said}"
    );
    rewritten("static.csv", "reseated.csv", |row| row[4] += 0.05);
    let (code, said) = with_second("reseated");
    assert_eq!(code, 4, "{said}");
    let wanted = "zero drifts: reseated.csv; channel 5 channel 5's zero is +50.000 mV from that of static.csv";
    assert!(said.contains(wanted), "{said}");
    rewritten("static.csv", "foreign.csv", |row| row.rotate_left(4));
    let (code, said) = with_second("foreign");
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("foreign.csv") && said.contains("mV from that of static.csv"),
        "{said}"
    );
}

#[test]
fn neg_an_entry_that_was_copied_and_not_edited_is_told() {
    let (code, said) = calibrated("unedited", |s| s.replace("linear-08.csv", "linear-07.csv"));
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("linear-07.csv it stands in the session twice"),
        "{said}"
    );
}

/// A recording with time stamps of this step, and no rate.
fn stamped(recording: &str, name: &str, step: f64) {
    let folder = &day().0;
    let record = fs::read_to_string(folder.join(recording)).expect("reads");
    let mut rows = record.lines().filter(|line| !line.starts_with('#'));
    let heading = format!("time [s],{}", rows.next().expect("a heading"));
    let rows = rows
        .enumerate()
        .map(|(i, row)| format!("{},{row}", i as f64 * step));
    let lines: Vec<String> = core::iter::once(heading).chain(rows).collect();
    folder.write(name, lines.join("\n") + "\n");
}

#[test]
fn neg_time_stamps_in_another_unit_are_told() {
    stamped("angular-03.csv", "ms.csv", 0.5);
    let (code, said) = calibrated("ms", |s| s.replace("angular-03.csv", "ms.csv"));
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("ms.csv: the time stamps are milliseconds"),
        "{said}"
    );
    let (code, said) = calibrated("turns", |s| {
        let lines = s.lines().map(|line| match line.split_once(" = ") {
            Some(("frequency_hz", hz)) => {
                format!("frequency_hz = {}\n", 60.0 * hz.parse::<f64>().expect("Hz"))
            }
            _ => format!("{line}\n"),
        });
        lines.collect()
    });
    assert!(matches!(code, 1 | 4), "{said}");
    assert!(said.contains("frequency_hz is in turns a minute"), "{said}");
}

/// Standards of half the rate are as good as their own samples: the fit takes their noise for what it is.
#[test]
fn inv_standards_of_half_the_rate_calibrate_as_well() {
    let folder = &day().0;
    let session = fs::read_to_string(folder.join("session.toml")).expect("reads");
    for file in trials(&session) {
        let record = fs::read_to_string(folder.join(file)).expect("reads");
        let rows = record.lines().skip(1).enumerate();
        let standards = rows.filter(|(i, _)| *i == 0 || i % 2 == 1).map(|(_, row)| {
            let cells: Vec<&str> = row.split(',').collect();
            format!("{},{}\n", cells[ACCELEROMETER], cells[GYROSCOPE])
        });
        let text = format!("# sample_rate_hz = 1000\n{}", standards.collect::<String>());
        folder.write(&format!("standards-{file}"), text);
    }
    let (code, said) = calibrated("half-rate", |s| {
        trials(&session).into_iter().fold(s.to_owned(), |s, file| {
            let quoted = format!("\"{file}\"");
            with_entry(&s, &quoted, |entry| {
                entry.replace(
                    &format!("file = {quoted}\n"),
                    &format!("file = {quoted}\nreference_file = \"standards-{file}\"\n"),
                )
            })
        })
    });
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("by the joint fit: misfit"), "{said}");
}

#[test]
fn neg_a_session_in_another_character_set_names_its_line() {
    let folder = &day().0;
    let mut session = fs::read(folder.join("session.toml")).expect("reads");
    session.splice(0..0, *b"# Pr\xfcfling\n");
    let path = folder.join("latin.toml");
    fs::write(&path, session).expect("writes");
    let output = run(&["calibrate", text(&path)]);
    assert_eq!(code(&output), 1);
    let said = stderr(&output);
    assert!(
        said.contains("line 1 is not text in UTF-8: save it as UTF-8"),
        "{said}"
    );
}

#[test]
fn inv_a_comparison_leaves_out_where_the_attitude_is_not_known() {
    let (folder, gains) = day();
    let [calibration, tumble, truth, out, page, figures] = [
        "calibration.json",
        "tumble.csv",
        "truth/tumble.csv",
        "lost.parquet",
        "lost.html",
        "lost.json",
    ]
    .map(|name| folder.file(name));
    done(&[
        "decouple",
        &calibration,
        &tumble,
        "--gain",
        gains.trim(),
        "--down",
        "0,0,-1",
        "--out",
        &out,
    ]);
    let output = run(&["compare", &out, &truth, "--out", &page, "--json", &figures]);
    let said = stdout(&output) + &stderr(&output);
    assert_eq!(code(&output), 0, "{said}");
    assert!(
        said.contains("more left out where the attitude is not known"),
        "{said}"
    );
    let figures: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(&figures).expect("reads")).expect("JSON");
    let count = |name: &str| figures[name].as_u64().expect("a number");
    // Both ends of the tumble are not decoupled.
    let samples = fs::read_to_string(folder.join("tumble.csv"))
        .expect("reads")
        .lines()
        .count();
    assert!(count("instants") > 1000 && count("unknown_instants") > 1000);
    assert_eq!(
        count("instants") + count("unknown_instants") + 4,
        samples as u64
    );
    assert!(figures["axes"][0]["peak"].as_f64() > Some(1.0));
    // Nothing known is nothing to compare.
    let unknown = folder.file("unknown.csv");
    let names = "time [s],ax,ay,az,alpha_x,alpha_y,alpha_z";
    let rows: String = (0..40)
        .map(|i| format!("{},nan,nan,nan,nan,nan,nan\n", 1e-4 * f64::from(i)))
        .collect();
    fs::write(&unknown, format!("{names}\n{rows}")).expect("writes");
    let output = run(&["compare", &unknown, &unknown, "--out", &page]);
    assert_eq!(code(&output), 1);
}

#[test]
fn inv_a_stated_rate_stands_in_for_stamps_that_are_not_there() {
    let (folder, gains) = day();
    let calibration = fs::read_to_string(folder.join("calibration.json")).expect("reads");
    let named = calibration.replacen("\"limbs\": [", "\"time\": \"Zeit\",\n    \"limbs\": [", 1);
    assert_ne!(named, calibration);
    let path = folder.write("named.json", named);
    let [tumble, out] = ["tumble.csv", "named.csv"].map(|name| folder.file(name));
    let rest = ["--gain", gains.trim(), "--down", "0,0,-1", "--out", &out];
    let without = run(&[&["decouple", &path, &tumble][..], &rest].concat());
    assert_eq!(code(&without), 1, "{}", stderr(&without));
    done(&[&["decouple", &path, &tumble, "--rate", "10000"][..], &rest].concat());
}

/// Files of the day's trials.
fn trials(session: &str) -> Vec<&str> {
    let entries = session.split("[[recording]]").skip(1);
    let moving = entries.filter(|entry| !entry.contains("\"static\""));
    moving.filter_map(|entry| entry.split('"').nth(1)).collect()
}

/// The session of trials of which each has another name.
fn renamed(session: &str, prefix: &str) -> String {
    trials(session)
        .into_iter()
        .fold(session.to_owned(), |s, file| {
            s.replace(&format!("\"{file}\""), &format!("\"{prefix}-{file}\""))
        })
}

#[test]
fn neg_standards_that_are_exchanged_are_told() {
    let folder = &day().0;
    let session = fs::read_to_string(folder.join("session.toml")).expect("reads");
    for file in trials(&session) {
        let record = fs::read_to_string(folder.join(file)).expect("reads");
        let record = record.replace("r [m/s^2]", "r").replace("e [rad/s]", "e");
        folder.write(&format!("unitless-{file}"), record);
    }
    let (code, said) = calibrated("exchanged-standards", |s| {
        let names = [
            ("accelerometer = \"accelerometer\"", "accelerometer = \"x\""),
            ("gyroscope = \"gyroscope\"", "gyroscope = \"accelerometer\""),
            ("accelerometer = \"x\"", "accelerometer = \"gyroscope\""),
            (
                "[channels]\n",
                "[channels]\naccelerometer_unit = \"g\"\ngyroscope_unit = \"deg/s\"\n",
            ),
        ];
        let renamed = renamed(s, "unitless");
        names.iter().fold(renamed, |s, (a, b)| s.replace(a, b))
    });
    assert!(matches!(code, 1 | 4), "{said}");
    let wanted = "accelerometer and gyroscope are exchanged in the session's [channels]";
    assert!(said.contains(wanted), "{said}");
}

/// A standard that shows gravity along the rig's axis, or has a zero of its own, measures changes as well as any.
#[test]
fn inv_an_offset_of_the_accelerometer_is_no_error_of_the_sensor() {
    let folder = &day().0;
    let session = fs::read_to_string(folder.join("session.toml")).expect("reads");
    for file in trials(&session) {
        rewritten(file, &format!("offset-{file}"), |row| {
            row[ACCELEROMETER] += 9.8;
        });
    }
    let (code, said) = calibrated("offset", |s| renamed(s, "offset"));
    assert_eq!(code, 0, "{said}");
}

//! Slips of a first day: each is answered by what to change.

use std::fs;

use crate::program::{Folder, code, run, stderr, stdout, text};
use crate::self_calibrate::day;

/// The day's session with something else in it, calibrated: exit code and what is printed.
fn calibrated(name: &str, change: impl Fn(&str) -> String) -> (i32, String) {
    let folder = &day().0;
    let session = fs::read_to_string(folder.join("session.toml")).expect("reads");
    let changed = change(&session);
    assert_ne!(changed, session, "{name}");
    let path = folder.write(&format!("{name}.toml"), changed);
    let [out, page] = ["json", "html"].map(|kind| folder.file(&format!("{name}.{kind}")));
    let output = run(&["calibrate", &path, "--out", &out, "--report", &page]);
    let said = stdout(&output) + &stderr(&output);
    (
        code(&output),
        said.split_whitespace().collect::<Vec<_>>().join(" "),
    )
}

/// The session with another frequency in the entries of these recordings.
fn with_frequency(session: &str, recordings: &str, frequency_hz: f64) -> String {
    let entries = session.split("[[recording]]").map(|entry| {
        let lines = entry.lines().map(|line| match line.split_once(" = ") {
            Some(("frequency_hz", _)) if entry.contains(recordings) => {
                format!("frequency_hz = {frequency_hz}\n")
            }
            _ => format!("{line}\n"),
        });
        lines.collect::<String>()
    });
    entries.collect::<Vec<_>>().join("[[recording]]")
}

#[test]
fn neg_files_in_the_wrong_order_are_told_by_their_kind() {
    let folder = &day().0;
    let [session, calibration, recording, page] = [
        "session.toml",
        "calibration.json",
        "tumble.csv",
        "calibration.html",
    ]
    .map(|name| folder.file(name));
    for (arguments, words) in [
        (
            &["decouple", &recording, &calibration][..],
            "it looks like a recording; the calibration comes first",
        ),
        (
            &["decouple", &session, &recording],
            "it looks like a session file",
        ),
        (
            &["decouple", &page, &recording],
            "it looks like a page of a report",
        ),
        (
            &["decouple", &calibration, &session, "--gain", "1"],
            "no recording; it looks like a session file",
        ),
        (
            &["decouple", &calibration, &calibration, "--gain", "1"],
            "no recording; it looks like a calibration",
        ),
        (
            &["self-calibrate", &recording, &calibration],
            "it looks like a recording; the calibration comes first",
        ),
        (
            &["calibrate", &calibration],
            "no session file (TOML); it looks like a calibration",
        ),
        (
            &["calibrate", &recording],
            "no session file (TOML); it looks like a recording",
        ),
    ] {
        let output = run(arguments);
        assert_eq!(code(&output), 1, "{arguments:?}");
        assert!(
            stderr(&output).contains(words),
            "{arguments:?}: {}",
            stderr(&output)
        );
    }
    // What is wrong within a file of the right kind is still told by its place.
    let cut = folder.write("cut.json", "{\n  \"format\": \"sixaxis-calibration-2\",\n");
    let said = stderr(&run(&["decouple", &cut, &recording]));
    assert!(said.contains("cut.json, line"), "{said}");
}

#[test]
fn neg_recordings_that_are_not_there_are_looked_for_in_the_session() {
    let (code, said) = calibrated("missing", |s| s.replace("\"linear-0", "\"lin-0"));
    assert_eq!(code, 4, "{said}");
    assert!(said.contains("correct `file` in the session"), "{said}");
    let (_, said) = calibrated("windows", |s| {
        s.replace("\"linear-01.csv\"", "'raw\\linear-01.csv'")
    });
    assert!(said.contains("write / between the folders"), "{said}");
    for escaped in ["\"raw\\linear-01.csv\"", "\"raw\\new.csv\""] {
        let (code, said) = calibrated("escaped", |s| s.replace("\"linear-01.csv\"", escaped));
        assert_eq!(code, 1, "{said}");
        assert!(
            said.contains("recording") && said.contains("a backslash begins an escape"),
            "{said}"
        );
    }
}

#[test]
fn neg_a_frequency_that_the_drive_does_not_have_is_told() {
    let (code, said) = calibrated("one-drive", |s| with_frequency(s, "linear-05", 1.9));
    assert_eq!(code, 3, "{said}");
    assert!(
        said.contains("linear-05.csv: the drive turns at 1.44"),
        "{said}"
    );
    let (code, said) = calibrated("compound-drives", |s| with_frequency(s, "compound-", 0.1));
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("at 0.100 Hz by the session") && said.contains("correct frequency_hz"),
        "{said}"
    );
    assert!(!said.contains("cause unknown"), "{said}");
}

#[test]
fn neg_a_linear_trial_that_turns_is_another_s_file() {
    let exchanged = |s: &str| {
        let s = s
            .replace("\"linear-03", "\"third")
            .replace("\"angular-03", "\"linear-03");
        s.replace("\"third", "\"angular-03")
    };
    let (code, said) = calibrated("exchanged", exchanged);
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("angular-03.csv, linear-03.csv by the standards 1 linear and 1 angular"),
        "{said}"
    );
    assert!(!said.contains("cable"), "{said}");
}

#[test]
fn neg_gravity_taken_off_the_wrong_way_is_no_motion() {
    let (folder, gains) = day();
    let own = Folder::new("down");
    let [drifted, tumble] = ["calibration.json", "tumble.csv"].map(|name| folder.file(name));
    // A drifted limb is no motion's, either.
    let calibration = own.file("corrected.json");
    let arguments = [
        "--gain",
        gains,
        "--down",
        "0,0,-1",
        "--write-calibration",
        &calibration,
    ];
    run(&[&["self-calibrate", &drifted, &tumble], &arguments[..]].concat());
    for (down, told) in [("0,0,-1", false), ("0,0,1", true)] {
        let out = own.join("out.npz");
        let output = run(&[
            "decouple",
            &calibration,
            &tumble,
            "--gain",
            gains,
            "--down",
            down,
            "--out",
            text(&out),
        ]);
        assert!(output.status.success(), "{}", stderr(&output));
        let said = stderr(&output);
        assert_eq!(
            said.contains("is the direction of gravity inverted"),
            told,
            "{said}"
        );
    }
    let sensor_axes = own.file("sensor.npz");
    let arguments = ["--gain", gains, "--frame", "sensor", "--out", &sensor_axes];
    run(&[&["decouple", &calibration, &tumble], &arguments[..]].concat());
    let compared = run(&["compare", &sensor_axes, text(&own.join("out.npz"))]);
    assert!(
        stderr(&compared).contains("decouple with --frame both"),
        "{}",
        stderr(&compared)
    );
}

#[test]
fn neg_a_copy_is_no_trial_of_its_own() {
    let folder = &day().0;
    fs::copy(folder.join("linear-02.csv"), folder.join("again.csv")).expect("a copy");
    let (code, said) = calibrated("copy", |s| {
        let second = s
            .split("[[recording]]")
            .find(|entry| entry.contains("linear-02"));
        format!(
            "{s}\n[[recording]]{}",
            second.expect("an entry").replace("linear-02", "again")
        )
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("again.csv the same samples as linear-02.csv"),
        "{said}"
    );
}

#[test]
fn neg_a_direction_of_the_wrong_sign_is_told() {
    let (code, said) = calibrated("opposite", |s| {
        let entries = s
            .split("[[recording]]")
            .map(|entry| match entry.contains("linear-04") {
                true => {
                    let (before, after) = entry.split_once("direction = [").expect("a direction");
                    let (vector, after) = after.split_once(']').expect("its end");
                    let vector = vector
                        .split(", ")
                        .map(|x| format!("-{x}"))
                        .collect::<Vec<_>>();
                    format!("{before}direction = [{}]{after}", vector.join(", "))
                }
                false => entry.to_owned(),
            });
        entries.collect::<Vec<_>>().join("[[recording]]")
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("turn the sign of this recording's direction"),
        "{said}"
    );
}

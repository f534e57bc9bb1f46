//! Slips of a first day: each is answered by what to change.

use std::fs;

use crate::program::{Folder, code, run, stderr, stdout, text};
use crate::self_calibrate::day;

/// The day's session with something else in it, calibrated: exit code and what is printed.
pub fn calibrated(name: &str, change: impl Fn(&str) -> String) -> (i32, String) {
    calibrated_in(&day().0, name, change)
}

/// The same of any day.
pub fn calibrated_in(
    folder: &Folder,
    name: &str,
    change: impl Fn(&str) -> String,
) -> (i32, String) {
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
    let cut = folder.write("cut.json", "{\n  \"format\": \"sixaxis-calibration-3\",\n");
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
        said.contains("linear-05.csv: the standards move at 1.44"),
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
        said.contains("angular-03.csv, linear-03.csv by the standards these trials move as the other kind should: 1 entered as linear turn, 1"),
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
    // Trimmed, it is none either.
    let record = fs::read_to_string(folder.join("linear-03.csv")).expect("reads");
    let rows: Vec<&str> = record.lines().collect();
    let is_sample = |row: &&str| row.split(',').all(|cell| cell.parse::<f64>().is_ok());
    let first = rows.iter().position(is_sample).expect("a sample");
    let trimmed = [&rows[..first], &rows[200..rows.len() - 100]].concat();
    folder.write("trimmed.csv", trimmed.join("\n") + "\n");
    let (code, said) = calibrated("trimmed", |s| {
        let mut entries = s.split("[[recording]]");
        let third = entries.find(|entry| entry.contains("linear-03"));
        let third = third.expect("an entry").replace("linear-03", "trimmed");
        format!("{s}\n[[recording]]{third}")
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("trimmed.csv the same samples as a part of linear-03.csv"),
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

/// Writes a recording with other readings, its columns from the first on, under another name.
pub fn rewritten(recording: &str, name: &str, change: impl Fn(&mut [f64])) {
    rewritten_in(&day().0, recording, name, change);
}

/// The same of any day.
pub fn rewritten_in(folder: &Folder, recording: &str, name: &str, change: impl Fn(&mut [f64])) {
    let record = fs::read_to_string(folder.join(recording)).expect("reads");
    let lines = record.lines().map(|line| {
        let readings = line.split(',').map(str::parse);
        match readings.collect::<Result<Vec<f64>, _>>() {
            Ok(mut readings) => {
                change(&mut readings);
                let cells: Vec<String> = readings.iter().map(f64::to_string).collect();
                cells.join(",")
            }
            Err(_) => line.to_owned(),
        }
    });
    let lines: Vec<String> = lines.collect();
    folder.write(name, lines.join("\n") + "\n");
}

/// A static record with other readings, of these by channel; the trials are as they were.
fn with_static(name: &str, change: impl Fn([f64; 9]) -> [f64; 9]) -> (i32, String) {
    rewritten("static.csv", &format!("{name}.csv"), |readings| {
        let changed = change(core::array::from_fn(|i| readings[i]));
        readings.copy_from_slice(&changed);
    });
    calibrated(name, |s| s.replace("static.csv", &format!("{name}.csv")))
}

#[test]
fn neg_a_static_record_whose_zeros_are_not_the_trials_is_refused() {
    let exchanged = |u: [f64; 9]| core::array::from_fn(|i| u[(i + 4) % 9]);
    for (name, change) in [
        ("zeros", &(|_| [0.0; 9]) as &dyn Fn([f64; 9]) -> [f64; 9]),
        ("as-volts", &|u| u.map(|x| 1e-3 * x)),
        ("of-another-sensor", &exchanged),
    ] {
        let (code, said) = with_static(name, change);
        assert_eq!(code, 4, "{name}: {said}");
        assert!(
            said.contains("mV from the static record's") && said.contains("record at rest again"),
            "{name}: {said}"
        );
    }
    // One channel's plug was seated again.
    let (code, said) = with_static("one-zero", |u| {
        core::array::from_fn(|i| if i == 4 { u[i] + 0.05 } else { u[i] })
    });
    assert_eq!(code, 4, "{said}");
    assert!(said.contains("channel 5's zero -50"), "{said}");
    assert!(said.contains("right before the trials"), "{said}");
}

#[test]
fn neg_a_trial_is_no_static_record() {
    let (code, said) = calibrated("static-moves", |s| {
        s.replace("\"static.csv", "\"linear-06.csv")
    });
    assert_eq!(code, 4, "{said}");
    assert!(said.contains("the sensor moved, or it is"), "{said}");
}

/// The entry of a recording, changed.
pub fn with_entry(session: &str, recording: &str, change: impl Fn(&str) -> String) -> String {
    let entries = session
        .split("[[recording]]")
        .map(|entry| match entry.contains(recording) {
            true => change(entry),
            false => entry.to_owned(),
        });
    entries.collect::<Vec<_>>().join("[[recording]]")
}

/// The vectors of this key, the other way round.
pub fn reversed(session: &str, key: &str) -> String {
    let begins = format!("{key} = [");
    let lines = session
        .lines()
        .map(|line| match line.strip_prefix(&begins) {
            Some(vector) => {
                let numbers = vector.trim_end_matches(']').split(',');
                let turned = numbers.map(|x| -x.trim().parse::<f64>().expect("a number"));
                format!("{key} = {:?}\n", turned.collect::<Vec<f64>>())
            }
            None => format!("{line}\n"),
        });
    lines.collect()
}

/// A line of an entry.
fn line_of<'a>(session: &'a str, recording: &str, key: &str) -> &'a str {
    let entry = session
        .split("[[recording]]")
        .find(|entry| entry.contains(recording));
    let mut lines = entry.expect("an entry").lines();
    let line = lines.find(|line| line.starts_with(key));
    line.expect("a line of it")
}

/// A session in which one line stands in the entry of the other recording, and the other way round.
fn with_exchanged(session: &str, [a, b]: [&str; 2], key: &str) -> String {
    let lines = [a, b].map(|name| line_of(session, name, key).to_owned());
    let changed = with_entry(session, a, |entry| entry.replace(&lines[0], &lines[1]));
    with_entry(&changed, b, |entry| entry.replace(&lines[1], &lines[0]))
}

#[test]
fn neg_names_in_another_order_are_put_in_order() {
    let names = |order: [usize; 9]| order.map(|i| format!("\"u{i}\"")).join(", ");
    let own = names([1, 2, 3, 4, 5, 6, 7, 8, 9]);
    for (name, order, present) in [
        (
            "shifted",
            [2, 3, 4, 5, 6, 7, 8, 9, 1],
            "9, 1, 2, 3, 4, 5, 6, 7, 8",
        ),
        (
            "shuffled",
            [3, 2, 9, 1, 4, 5, 8, 7, 6],
            "4, 2, 1, 5, 6, 9, 8, 7, 3",
        ),
    ] {
        let (_, said) = calibrated(name, |s| s.replace(&own, &names(order)));
        assert!(
            said.contains(&format!("with channels {present} taken for limbs 1 to 9")),
            "{said}"
        );
        assert!(said.contains("leave gain_n_per_v as it is"), "{said}");
    }
}

#[test]
fn neg_gains_of_another_recording_or_of_none_are_told() {
    let (code, said) = calibrated("gains-exchanged", |s| {
        with_exchanged(s, ["linear-02", "linear-03"], "gain_n_per_v")
    });
    assert_eq!(code, 4, "{said}");
    for other in ["linear-02", "linear-03"] {
        assert!(
            said.contains(&format!(
                "with the gains that the session states for {other}.csv"
            )),
            "{said}"
        );
    }
    let (_, said) = calibrated("gains-missing", |s| {
        let line = line_of(s, "linear-04", "gain_n_per_v").to_owned();
        with_entry(s, "linear-04", |entry| entry.replace(&line, ""))
    });
    assert!(
        said.contains("linear-04.csv: state this recording's own gain_n_per_v"),
        "{said}"
    );
    // From the right to the left.
    let session = fs::read_to_string(day().0.join("session.toml")).expect("reads");
    let (code, said) = calibrated("gains-reversed", |s| {
        let line = line_of(s, "linear-04", "gain_n_per_v").to_owned();
        let mut list: Vec<&str> = line
            .split(['[', ']'])
            .nth(1)
            .expect("nine")
            .split(", ")
            .collect();
        list.reverse();
        let reversed = format!("gain_n_per_v = [{}]", list.join(", "));
        with_entry(s, "linear-04", |entry| entry.replace(&line, &reversed))
    });
    let line = line_of(&session, "linear-04", "gain_n_per_v");
    let gains = line.split(['[', ']']).nth(1).expect("nine");
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains(&format!("with gains of {gains} N/V")),
        "{said}"
    );
}

#[test]
fn neg_a_compound_run_is_no_linear_trial() {
    let (code, said) = calibrated("compound-as-linear", |s| {
        with_entry(s, "compound-01", |entry| {
            entry.replace("\"validation\"", "\"linear\"")
        })
    });
    assert_eq!(code, 4, "{said}");
    assert!(said.contains("as in a compound run"), "{said}");
}

#[test]
fn neg_directions_of_other_wedges_are_told_by_where_they_point() {
    let (code, said) = calibrated("directions-exchanged", |s| {
        with_exchanged(s, ["linear-02", "linear-05"], "direction")
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("whether its direction or its file is that of linear-05.csv"),
        "{said}"
    );
    // A run that is not fitted fails as a whole, and what is odd about it says why.
    let (code, said) = calibrated("wedge-of-a-run", |s| {
        let other = line_of(s, "linear-02", "direction").to_owned();
        let own = line_of(s, "compound-01", "direction").to_owned();
        with_entry(s, "compound-01", |entry| entry.replace(&own, &other))
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("the channels show motion along") && said.contains("compound-01.csv"),
        "{said}"
    );
}

//! Recordings that something happened to between the converter and the file, and sessions that take one recording for another.

use std::cell::Cell;
use std::fs;

use crate::mistakes::{calibrated, reversed, rewritten, with_entry};
use crate::program::{code, run, stderr, stdout, text};
use crate::self_calibrate::day;

/// Writes a recording with other readings, of which the change knows the row.
fn by_row(recording: &str, name: &str, change: impl Fn(usize, &mut [f64])) {
    let row = Cell::new(0);
    rewritten(recording, name, |readings| {
        change(row.get(), readings);
        row.set(row.get() + 1);
    });
}

/// The numbers of a recording.
fn rows_of(recording: &str) -> Vec<Vec<f64>> {
    let record = fs::read_to_string(day().0.join(recording)).expect("reads");
    let rows = record.lines().map(|line| line.split(',').map(str::parse));
    rows.filter_map(|row| row.collect::<Result<Vec<f64>, _>>().ok())
        .collect()
}

#[test]
fn neg_a_zero_that_was_taken_off_is_told() {
    for (name, of, what) in [
        (
            "tared",
            (|rows: &[Vec<f64>], i| rows[0][i]) as fn(&[Vec<f64>], usize) -> f64,
            "the first sample is exactly 0 V",
        ),
        (
            "centred",
            |rows, i| rows.iter().map(|row| row[i]).sum::<f64>() / rows.len() as f64,
            "the mean is exactly 0 V",
        ),
    ] {
        for recording in ["static", "linear-03"] {
            let rows = rows_of(&format!("{recording}.csv"));
            let zero: [f64; 9] = core::array::from_fn(|i| of(&rows, i));
            rewritten(
                &format!("{recording}.csv"),
                &format!("{name}-{recording}.csv"),
                |row| {
                    row[..9]
                        .iter_mut()
                        .zip(zero)
                        .for_each(|(u, zero)| *u -= zero)
                },
            );
        }
        let (code, said) = calibrated(name, |s| {
            s.replace("\"static.csv", &format!("\"{name}-static.csv"))
                .replace("\"linear-03.csv", &format!("\"{name}-linear-03.csv"))
        });
        assert_eq!(code, 4, "{said}");
        let wanted = format!("{name}-static.csv, {name}-linear-03.csv {what}");
        assert!(said.contains(&wanted), "{said}");
    }
}

#[test]
fn neg_repeated_and_rounded_values_are_told() {
    let rows = rows_of("linear-04.csv");
    by_row("linear-04.csv", "held.csv", |at, row| {
        row[..9].copy_from_slice(&rows[at - at % 4][..9])
    });
    by_row("angular-05.csv", "rounded.csv", |_, row| {
        for u in &mut row[..9] {
            *u = format!("{u:.1e}").parse().expect("a number");
        }
    });
    for (file, recording, wanted) in [
        ("held", "linear-04", "each row stands there 4 times"),
        (
            "rounded",
            "angular-05",
            "no voltage has more than 3 significant digits",
        ),
    ] {
        let (code, said) = calibrated(file, |s| {
            s.replace(&format!("\"{recording}.csv"), &format!("\"{file}.csv"))
        });
        assert_eq!(code, 4, "{said}");
        assert!(said.contains(&format!("{file}.csv {wanted}")), "{said}");
        assert!(!said.contains("converter clips"), "{said}");
    }
}

#[test]
fn neg_samples_that_were_lost_are_told() {
    let frozen = rows_of("linear-05.csv")[1500][4];
    for (name, change, wanted) in [
        (
            "zeros",
            (|at, row| {
                if (1500..1600).contains(&at) {
                    row[..9].fill(0.0);
                }
            }) as fn(usize, &mut [f64]),
            "zeros.csv 100 samples in a row, from sample 1500 on, stand at 0.0000 V",
        ),
        (
            "no-standard",
            |at, row| {
                if at >= 1500 {
                    row[9] = 0.0;
                }
            },
            "no-standard.csv of the standard accelerometer",
        ),
    ] {
        by_row("linear-05.csv", &format!("{name}.csv"), change);
        let (code, said) = calibrated(name, |s| {
            s.replace("\"linear-05.csv", &format!("\"{name}.csv"))
        });
        assert_eq!(code, 4, "{said}");
        assert!(said.contains(wanted), "{said}");
    }
    by_row("linear-05.csv", "frozen.csv", |at, row| {
        if (1500..1700).contains(&at) {
            row[4] = frozen;
        }
    });
    let (code, said) = calibrated("frozen", |s| s.replace("\"linear-05.csv", "\"frozen.csv"));
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("frozen.csv; channel 5 200 samples in a row"),
        "{said}"
    );
}

#[test]
fn neg_a_static_record_that_somebody_touched_is_told() {
    let rows = rows_of("static.csv").len();
    by_row("static.csv", "touched.csv", |at, row| {
        if (rows / 3..rows / 3 + rows / 20).contains(&at) {
            row.iter_mut().for_each(|u| *u += 0.5);
        }
    });
    let (code, said) = calibrated("touched", |s| s.replace("\"static.csv", "\"touched.csv"));
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("touched.csv about") && said.contains("+500."),
        "{said}"
    );
}

#[test]
fn neg_recordings_that_stand_for_each_other_are_told() {
    let exchange = |s: &str, [a, b]: [&str; 2]| {
        s.replace(&format!("\"{a}.csv"), "\"~")
            .replace(&format!("\"{b}.csv"), &format!("\"{a}.csv"))
            .replace("\"~", &format!("\"{b}.csv"))
    };
    for pair in [["linear-03", "linear-04"], ["compound-02", "compound-03"]] {
        let (code, said) = calibrated(&format!("exchanged-{}", pair[0]), |s| exchange(s, pair));
        assert_eq!(code, 4, "{said}");
        assert!(
            said.contains("each turns as another of them should")
                && said.contains("see which recording each entry of the session names"),
            "{said}"
        );
    }
    // The file that was copied over another one is the copy, whichever comes first.
    let folder = &day().0;
    fs::copy(folder.join("linear-06.csv"), folder.join("copied-over.csv")).expect("copies");
    let (code, said) = calibrated("copied-over", |s| {
        s.replace("\"linear-05.csv", "\"copied-over.csv")
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("copied-over.csv the same samples as linear-06.csv"),
        "{said}"
    );
}

#[test]
fn neg_a_gyroscope_that_turns_the_other_way_is_told() {
    let (code, said) = calibrated("gyroscope-reversed", |s| {
        with_entry(s, "role = \"angular\"", |entry| {
            reversed(entry, "direction")
        })
    });
    assert!(matches!(code, 1 | 4), "{said}");
    assert!(
        said.contains("with the standard gyroscope reversed all trials agree"),
        "{said}"
    );
}

#[test]
fn neg_a_down_that_does_not_turn_so_is_told() {
    let (code, said) = calibrated("down", |s| {
        ["compound-01", "compound-02", "compound-03"]
            .iter()
            .fold(s.to_owned(), |s, run| {
                let file = format!("file = \"{run}.csv\"\n");
                with_entry(&s, &file, |entry| {
                    entry.replace(&file, &format!("{file}down = [0, 0, -1]\n"))
                })
            })
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("gravity not handled") && !said.contains("clocks disagree"),
        "{said}"
    );
}

#[test]
fn neg_zeros_that_are_not_the_calibrations_are_told() {
    let folder = &day().0;
    let calibration = folder.file("calibration.json");
    let session = fs::read_to_string(folder.join("session.toml")).expect("reads");
    let decoupled = |recording: &str| {
        // The session's entry of compound-02 stands for each of these.
        let session = session.replace("compound-02.csv", recording);
        let session = folder.write(&format!("zeros-of-{recording}.toml"), session);
        let [recording, out] = [recording, "zeros-out.csv"].map(|name| folder.file(name));
        let arguments = ["--session", &session, "--out", &out];
        stderr(&run(&[
            &["decouple", &calibration, &recording],
            &arguments[..],
        ]
        .concat()))
    };
    let wanted = "zeros, gains or unit are not the calibration's";
    assert!(!decoupled("compound-02.csv").contains(wanted));
    // Tared to its first sample, with that sample's noise; a plug that was seated anew.
    let first: [f64; 9] = core::array::from_fn(|i| rows_of("compound-02.csv")[0][i]);
    rewritten("compound-02.csv", "tared-run.csv", |row| {
        row[..9]
            .iter_mut()
            .zip(first)
            .for_each(|(u, zero)| *u -= zero);
    });
    rewritten("compound-02.csv", "seated-anew.csv", |row| row[1] += 0.05);
    for recording in ["tared-run.csv", "seated-anew.csv"] {
        let said = decoupled(recording);
        assert!(said.contains(wanted), "{recording}: {said}");
    }
    rewritten("compound-02.csv", "dead-run.csv", |row| row[4] = 0.0);
    let said = decoupled("dead-run.csv");
    assert!(said.contains("dead") && !said.contains(wanted), "{said}");
}

#[test]
fn neg_a_namesake_of_a_recording_is_told() {
    let folder = &day().0;
    let elsewhere = folder.join("elsewhere");
    fs::create_dir_all(&elsewhere).expect("a folder");
    let copy = elsewhere.join("compound-02.csv");
    fs::copy(folder.join("compound-02.csv"), &copy).expect("copied");
    let [calibration, session] = ["calibration.json", "session.toml"].map(|name| folder.file(name));
    let out = folder.file("namesake-out.csv");
    let told = |recording: &str| {
        let arguments = ["--session", &session, "--out", &out];
        let said = run(&[&["decouple", &calibration, recording], &arguments[..]].concat());
        stderr(&said).contains("the name is the same, the file is not")
    };
    assert!(told(copy.to_str().expect("text")));
    assert!(!told(&folder.file("compound-02.csv")));
}

#[test]
fn neg_a_channel_that_stands_still_from_some_sample_on_is_told() {
    let rows = rows_of("linear-08.csv");
    let held = rows[rows.len() / 2][7];
    let half = rows.len() / 2;
    by_row("linear-08.csv", "held.csv", |row, readings| {
        if row >= half {
            readings[7] = held;
        }
    });
    let (status, said) = calibrated("held", |s| s.replace("linear-08.csv", "held.csv"));
    assert_eq!(status, 4, "{said}");
    assert!(said.contains("dead limb: held.csv; channel 8"), "{said}");
    let from = format!("from sample {half} on, while the other channels move");
    assert!(said.contains(&from), "{said}");
    let inspected = run(&["inspect", text(&day().0.join("held.csv")), "--strict"]);
    let said = stdout(&inspected);
    assert!(said.contains("u8 stands still to the last bit"), "{said}");
    assert_ne!(code(&inspected), 0);
}

#[test]
fn neg_a_standard_that_shows_no_motion_is_told_from_a_drive_that_turns_otherwise() {
    let noise = Cell::new(0.5_f64);
    by_row("angular-06.csv", "deaf.csv", |_, readings| {
        noise.set((noise.get() * 997.0 + 0.123).fract());
        readings[10] = 1e-3 * (noise.get() - 0.5);
    });
    let (status, said) = calibrated("deaf", |s| s.replace("angular-06.csv", "deaf.csv"));
    assert_eq!(status, 4, "{said}");
    let wanted = "recording cannot be used: deaf.csv the nine channels move at";
    assert!(said.contains(wanted), "{said}");
}

#[test]
fn neg_an_error_of_a_spreadsheet_is_no_comment() {
    let record = fs::read_to_string(day().0.join("linear-03.csv")).expect("reads");
    let mut lines: Vec<String> = record.lines().map(str::to_owned).collect();
    let cells: Vec<&str> = record.lines().nth(900).expect("a row").split(',').collect();
    lines[900] = format!("#N/A,{}", cells[1..].join(","));
    let path = day().0.write("spreadsheet.csv", lines.join("\n") + "\n");
    let refused = run(&["inspect", &path]);
    assert_ne!(code(&refused), 0);
    let said = stderr(&refused);
    assert!(
        said.contains("line 901, column 1") && said.contains("#N/A"),
        "{said}"
    );
    // Behind the last row it is a comment, as a footer is to be.
    lines[900] = record.lines().nth(900).expect("a row").to_owned();
    lines.push(format!("#mean,{}", cells[1..].join(",")));
    let path = day().0.write("footer.csv", lines.join("\n") + "\n");
    assert_eq!(code(&run(&["inspect", &path])), 0);
}

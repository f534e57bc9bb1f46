//! Recordings that are decoupled or checked without their session, and what nobody told of them.

use std::fs;

use crate::mistakes::rewritten;
use crate::program::{code, done, run, stderr};
use crate::self_calibrate::day;

/// A row of text with more in one of its cells.
fn with(row: &str, place: usize, more: f64) -> String {
    let cells = row.split(',').enumerate().map(|(at, cell)| {
        let value: f64 = cell.parse().expect("a number");
        if at == place {
            (value + more).to_string()
        } else {
            cell.to_owned()
        }
    });
    cells.collect::<Vec<_>>().join(",")
}

/// Samples per second of the day's trials.
const RATE_HZ: f64 = 2000.0;

#[test]
fn neg_a_run_that_begins_or_ends_in_motion_is_told() {
    let (folder, _) = day();
    let record = fs::read_to_string(folder.join("compound-03.csv")).expect("reads");
    let lines: Vec<&str> = record.lines().collect();
    let head = lines
        .iter()
        .position(|line| line.starts_with(|c: char| c == '-' || c.is_ascii_digit()));
    let (head, rows) = lines.split_at(head.expect("rows"));
    let session = fs::read_to_string(folder.join("session.toml")).expect("reads");
    let entry = session
        .split("[[recording]]")
        .find(|e| e.contains("compound-03.csv"));
    let line = |key: &str| {
        let line = entry.and_then(|e| e.lines().find_map(|l| l.strip_prefix(key)));
        line.expect("a key")
            .trim_start_matches([' ', '=', '['])
            .replace([']', ' '], "")
    };
    let gain = line("gain_n_per_v");
    let calibration = folder.file("calibration.json");
    let out = folder.file("ends.csv");
    let said = |name: &str, rows: &[&str], more: &[&str]| {
        let text = [head, rows].concat().join("\n") + "\n";
        let path = folder.write(name, text);
        let first = [
            "decouple",
            &calibration,
            &path,
            "--gain",
            &gain,
            "--out",
            &out,
        ];
        stderr(&done(&[&first[..], more].concat()))
    };
    let middle = rows.len() / 2;
    let begins = said("begins.csv", &rows[middle..], &[]);
    assert!(begins.contains("it begins in motion"), "{begins}");
    let ends = said("ends-in.csv", &rows[..middle], &["--rest-to-rest"]);
    assert!(
        ends.contains("it ends in motion") && !ends.contains("it begins"),
        "{ends}"
    );
    let whole = said("whole.csv", rows, &["--rest-to-rest"]);
    assert!(!whole.contains("in motion"), "{whole}");
    // A zero that has moved by a five-hundredth of the range is told, and calibrated ones are no word.
    let moved: Vec<String> = rows.iter().map(|row| with(row, 3, 0.02)).collect();
    let moved: Vec<&str> = moved.iter().map(String::as_str).collect();
    let off = said("moved.csv", &moved, &[]);
    assert!(
        off.contains("1 of its channels do not begin at their calibrated zeros, limb 4 stands +"),
        "{off}"
    );
    assert!(!said("still.csv", rows, &[]).contains("zeros"));
    // Hum is no motion.
    let humming: Vec<String> = (rows.iter().enumerate())
        .map(|(at, row)| {
            let hum_v = 0.5 * (0.3 + core::f64::consts::TAU * 50.0 * at as f64 / RATE_HZ).sin();
            let cells = row
                .split(',')
                .enumerate()
                .map(|(column, cell)| match column {
                    0..9 => (cell.parse::<f64>().expect("a number") + hum_v).to_string(),
                    _ => cell.to_owned(),
                });
            cells.collect::<Vec<_>>().join(",")
        })
        .collect();
    let humming: Vec<&str> = humming.iter().map(String::as_str).collect();
    let hums = said("hums.csv", &humming, &["--rest-to-rest"]);
    assert!(!hums.contains("in motion"), "{hums}");
}

#[test]
fn neg_a_calibration_that_is_not_good_says_nothing_of_limbs() {
    let (folder, gains) = day();
    let good = fs::read_to_string(folder.join("calibration.json")).expect("reads");
    let verdict = good
        .lines()
        .find(|line| line.trim_start().starts_with("\"verdict\""));
    let bad = good.replace(verdict.expect("a verdict"), "  \"verdict\": \"bad\",");
    let bad = folder.write("bad.json", bad);
    let tumble = folder.file("tumble.csv");
    let arguments = [
        "self-calibrate",
        &bad,
        &tumble,
        "--gain",
        gains,
        "--down",
        "0,0,-1",
    ];
    let refused = run(&arguments);
    assert_eq!(code(&refused), 1);
    assert!(stderr(&refused).contains("its verdict is \"not good\""));
    let forced = run(&[&arguments[..], &["--force"]].concat());
    assert_eq!(code(&forced), 3);
    assert!(stderr(&forced).contains("do not trust the result"));
    // Millivolts taken for volts are no drift.
    rewritten("tumble.csv", "tumble-mv.csv", |readings| {
        readings[..9].iter_mut().for_each(|u| *u *= 1e3);
    });
    let calibration = folder.file("calibration.json");
    let tumble = folder.file("tumble-mv.csv");
    let refused = run(&["self-calibrate", &calibration, &tumble, "--gain", gains]);
    assert_eq!(code(&refused), 1);
    assert!(
        stderr(&refused).contains("--unit mV"),
        "{}",
        stderr(&refused)
    );
}

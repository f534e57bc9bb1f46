//! Drives, standards and recorders that do not keep one time, and what only looks as if they did not.

use core::f64::consts::TAU;
use std::cell::Cell;
use std::fs;

use crate::mistakes::{calibrated, rewritten, with_entry};
use crate::self_calibrate::day;

/// Columns of the day's trials, and their samples per second.
const ACCELEROMETER: usize = 9;
const GYROSCOPE: usize = 10;
const RATE_HZ: f64 = 2000.0;

/// Parts per million within which a day's trials tell the difference of two clocks.
const TOLD_PPM: f64 = 1.0;

#[test]
fn inv_a_frame_that_vibrates_is_no_clock() {
    let rows = rows_of("linear-01.csv");
    let of_row = |peak: f64, row: &Vec<f64>| peak.max(row[ACCELEROMETER].abs());
    let peak = rows.iter().fold(0.0, of_row);
    for (hz, share) in [(43.0, 0.4), (120.0, 1.0)] {
        let sample = Cell::new(0.0);
        rewritten("linear-01.csv", "shaken.csv", |row| {
            let n = sample.replace(sample.get() + 1.0);
            // It is still while nothing moves.
            let swell = (0.5 * TAU * n / rows.len() as f64).sin().powi(2);
            row[ACCELEROMETER] += share * peak * swell * (TAU * hz * n / RATE_HZ).sin();
        });
        let (code, said) = calibrated("shaken", |s| s.replace("linear-01.csv", "shaken.csv"));
        assert!(
            matches!(code, 0 | 3) && !said.contains("clocks disagree"),
            "{hz} Hz: {said}"
        );
    }
}

#[test]
fn neg_a_trial_of_the_other_kind_is_not_judged_for_its_clock() {
    let noise = Cell::new(0.5_f64);
    rewritten("angular-06.csv", "crosswise.csv", |row| {
        noise.set((noise.get() * 997.0 + 0.123).fract());
        row[ACCELEROMETER] = 0.05 * (noise.get() - 0.5);
    });
    let (code, said) = calibrated("crosswise", |s| {
        s.replace("\"linear-02.csv\"", "\"crosswise.csv\"")
            .replace("\"angular-06.csv\"", "\"linear-02.csv\"")
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("of the standards only the one that trials of the other kind need")
            && !said.contains("clocks disagree"),
        "{said}"
    );
}

/// The rows of one of the day's recordings.
fn rows_of(recording: &str) -> Vec<Vec<f64>> {
    let record = fs::read_to_string(day().0.join(recording)).expect("reads");
    let rows = record.lines().map(|line| line.split(',').map(str::parse));
    rows.filter_map(|row| row.collect::<Result<Vec<f64>, _>>().ok())
        .collect()
}

/// The day's session with standards in files of their own, whose clock runs slower by so many parts per million, by the recording.
fn own_clock(name: &str, slower_ppm: impl Fn(&str) -> f64) -> (i32, String) {
    let folder = &day().0;
    let session = fs::read_to_string(folder.join("session.toml")).expect("reads");
    let entries = session.split("[[recording]]").skip(1);
    let moving = entries.filter(|entry| !entry.contains("\"static\""));
    let files: Vec<&str> = moving
        .filter_map(|entry| entry.split('"').nth(1))
        .filter(|file| !file.contains("tap"))
        .collect();
    for file in &files {
        let rows = rows_of(file);
        let step = 1.0 + 1e-6 * slower_ppm(file);
        let between = |at: f64, column: usize| {
            let (before, share) = (at.floor() as usize, at.fract());
            let after = rows.get(before + 1).unwrap_or(&rows[before]);
            rows[before][column] + share * (after[column] - rows[before][column])
        };
        let samples = ((rows.len() - 1) as f64 / step) as usize + 1;
        let standards = (0..samples).map(|n| {
            let at = n as f64 * step;
            let [a, w] = [ACCELEROMETER, GYROSCOPE].map(|column| between(at, column));
            format!("{a},{w}\n")
        });
        let heading = "accelerometer [m/s^2],gyroscope [rad/s]";
        let text = format!(
            "# sample_rate_hz = {RATE_HZ}\n{heading}\n{}",
            standards.collect::<String>()
        );
        folder.write(&format!("{name}-{file}"), text);
    }
    calibrated(name, |s| {
        files.iter().fold(s.to_owned(), |s, file| {
            let line = format!("file = \"{file}\"\n");
            with_entry(&s, &line, |entry| {
                let reference = format!("{line}reference_file = \"{name}-{file}\"\n");
                entry.replace(&line, &reference)
            })
        })
    })
}

/// What is said of two quartzes, parts per million; none where nothing is.
fn told_ppm(said: &str) -> Option<f64> {
    let (_, told) = said.split_once("by the clock of the channels (")?;
    told.split_once(' ')?.0.parse().ok()
}

#[test]
fn inv_a_quartz_of_the_standards_is_taken_off() {
    for ppm in [10.0, -20.0, 50.0, 150.0] {
        let (code, said) = own_clock("quartz", |_| ppm);
        assert_eq!(code, 0, "{ppm}: {said}");
        let told = told_ppm(&said).expect("it is said");
        assert!((told + ppm).abs() < TOLD_PPM, "{ppm}: {said}");
    }
    let (code, said) = own_clock("quartz", |_| 0.0);
    assert_eq!(code, 0, "{said}");
    assert_eq!(told_ppm(&said), None, "{said}");
}

#[test]
fn inv_one_bad_trial_does_not_bend_a_quartz() {
    let (code, said) = own_clock("bad-quartz", |file| match file {
        "linear-06.csv" => 300.0,
        _ => 40.0,
    });
    assert_eq!(code, 4, "{said}");
    let told = told_ppm(&said).expect("it is said");
    assert!((told + 40.0).abs() < 4.0 * TOLD_PPM, "{said}");
    assert!(said.contains("linear-06.csv"), "{said}");
}

#[test]
fn neg_more_than_two_quartzes_differ_by_is_told() {
    let (code, said) = own_clock("no-quartz", |_| 1000.0);
    assert_eq!(code, 4, "{said}");
    assert!(said.contains("clocks disagree"), "{said}");
    assert_eq!(told_ppm(&said), None, "{said}");
}

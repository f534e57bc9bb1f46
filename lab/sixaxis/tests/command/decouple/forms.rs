//! One run in the forms that recorders and scripts give it: the same answer in all, a refusal that says why, or a warning.

use std::fs;
use std::process::Output;
use std::sync::OnceLock;

use super::session::{ACCELERATIONS, LIMBS, apart, calibration, columns, voltages, write};
use crate::program::{Folder, code, fed, run, stderr, stdout, text};

/// Largest difference of a column over its peak: text in six digits of a millisecond, or a clock in hours.
const SAME: f64 = 1e-6;
const SENSOR: [&str; 6] = [
    "fx",
    "fy",
    "fz",
    "alpha_sensor_x",
    "alpha_sensor_y",
    "alpha_sensor_z",
];

struct Run {
    folder: Folder,
    volts: Vec<Vec<f64>>,
    rate_hz: f64,
    expected: Vec<Vec<f64>>,
}

/// The compound run, and what it is decoupled to.
fn the_run() -> &'static Run {
    static RUN: OnceLock<Run> = OnceLock::new();
    RUN.get_or_init(|| {
        let folder = Folder::new("decouple-forms");
        let (volts, rate_hz) = voltages();
        let path = folder.join("plain.npz");
        write(&path, &LIMBS, "V", &volts, rate_hz);
        let out = folder.file("plain.parquet");
        let said = decouple(text(&path), &out, &[]);
        assert_eq!(code(&said), 0, "{}", stderr(&said));
        Run {
            expected: columns(out.as_ref(), &SENSOR).0,
            folder,
            volts,
            rate_hz,
        }
    })
}

fn decouple(recording: &str, out: &str, more: &[&str]) -> Output {
    let calibration = calibration();
    let first = ["decouple", &calibration, recording, "--gain", "0.05"];
    let last = ["--down", "0,0,-1", "--out", out];
    run(&[&first[..], &last, more].concat())
}

impl Run {
    /// Rows of text, by a column before the voltages and one behind them.
    fn table(&self, headings: &str, separator: &str, row: impl Fn(usize) -> [String; 2]) -> String {
        let mut lines = headings.to_owned() + "\n";
        for sample in 0..self.volts[0].len() {
            let volts = self.volts.iter().map(|column| column[sample].to_string());
            let [before, behind] = row(sample);
            let cells: Vec<String> = [before].into_iter().chain(volts).chain([behind]).collect();
            lines += &(cells.join(separator) + "\n");
        }
        lines
    }

    /// What is said of a file of this name and content; it must be decoupled as the run is.
    fn same(&self, name: &str, content: impl AsRef<[u8]>, more: &[&str]) -> String {
        let path = self.folder.write(name, content);
        let out = self.folder.file(&format!("{name}.parquet"));
        let output = decouple(&path, &out, more);
        let said = stderr(&output);
        assert_eq!(code(&output), 0, "{name}: {said}");
        let apart = apart(&columns(out.as_ref(), &SENSOR).0, &self.expected);
        assert!(apart < SAME, "{name}: {apart:e}; {said}");
        said
    }

    fn refused(&self, name: &str, content: impl AsRef<[u8]>, more: &[&str]) -> String {
        let path = self.folder.write(name, content);
        let out = self.folder.file(&format!("{name}.parquet"));
        let output = decouple(&path, &out, more);
        assert_eq!(code(&output), 1, "{name}: {}", stderr(&output));
        assert!(!self.folder.join(format!("{name}.parquet")).exists());
        stderr(&output)
    }

    fn stamp(&self, sample: usize) -> f64 {
        sample as f64 / self.rate_hz
    }
}

fn headings(before: &str, behind: &str, separator: &str) -> String {
    let limbs = LIMBS.map(|limb| format!("{limb} [V]"));
    let cells = [before].into_iter().map(str::to_owned).chain(limbs);
    cells
        .chain([behind.to_owned()])
        .collect::<Vec<_>>()
        .join(separator)
}

#[test]
fn ref_a_clock_is_told_by_its_name_and_read_in_its_unit() {
    let run = the_run();
    // A temperature stands before the time, and is called as it might be.
    let warm = run.table(&headings("T [°C]", "time [s]", ","), ",", |sample| {
        [
            format!("{}", 21.0 + 1e-3 * sample as f64),
            run.stamp(sample).to_string(),
        ]
    });
    run.same("warm.csv", &warm, &[]);
    let hours = run.table(&headings("time [h]", "none", ","), ",", |sample| {
        [(run.stamp(sample) / 3600.0).to_string(), "0".to_owned()]
    });
    run.same("hours.csv", &hours, &[]);
    let counted = run.table(&headings("time [samples]", "none", ","), ",", |sample| {
        [sample.to_string(), "0".to_owned()]
    });
    let said = run.refused("counted.csv", &counted, &[]);
    assert!(
        said.contains("\"samples\" is no unit of time stamps"),
        "{said}"
    );
    // Milliseconds that are said to be seconds.
    let path = run.folder.write(
        "slow.csv",
        run.table(&headings("time [s]", "none", ","), ",", |sample| {
            [(1e3 * run.stamp(sample)).to_string(), "0".to_owned()]
        }),
    );
    let output = decouple(&path, &run.folder.file("slow.parquet"), &[]);
    let said = stderr(&output);
    assert!(
        said.contains("is that the unit of its time stamps"),
        "{said}"
    );
}

/// Times of day as spreadsheets write them, over midnight, and since a start.
#[test]
fn ref_times_are_read_in_the_forms_of_spreadsheets() {
    let run = the_run();
    for (name, start_s, days) in [
        ("morning", 9.0 * 3600.0 + 59.0 * 60.0 + 58.0, ""),
        ("midnight", 86_398.0, ""),
        ("day-and-more", 25.0 * 3600.0, ""),
        ("pandas", 0.0, "0 days "),
    ] {
        let wraps = if name == "midnight" {
            86_400.0
        } else {
            f64::MAX
        };
        let table = run.table(&headings("time", "none", ","), ",", |sample| {
            let now = (start_s + run.stamp(sample)) % wraps;
            let (hours, minutes) = ((now / 3600.0).floor(), (now / 60.0).floor() % 60.0);
            let seconds = now % 60.0;
            [
                format!("{days}{hours}:{minutes:02}:{seconds:09.6}"),
                "0".to_owned(),
            ]
        });
        run.same(&format!("{name}.csv"), &table, &[]);
    }
    let american = run.table(&headings("time", "none", ","), ",", |sample| {
        [
            format!("05/31/2024 14:03:{:09.6}", run.stamp(sample)),
            "0".to_owned(),
        ]
    });
    let said = run.refused("american.csv", &american, &[]);
    assert!(said.contains("neither a number nor a time"), "{said}");
    // Raw and scaled, say: nobody says which is meant.
    let names = headings("time [s]", "u4 [V]", ",");
    let twice = run.table(&names, ",", |sample| {
        [run.stamp(sample).to_string(), "0".to_owned()]
    });
    let said = run.refused("twice.csv", &twice, &[]);
    assert!(
        said.contains("no channel \"u4\"; it has time, u1,"),
        "{said}"
    );
    assert!(said.contains("more than once"), "{said}");
}

#[test]
fn ref_tables_are_read_however_they_are_laid_out() {
    let run = the_run();
    let rate = run.rate_hz.to_string();
    let tabs = run.table(&headings("remark", "", "\t"), "\t", |_| {
        [String::new(), String::new()]
    });
    run.same("tabs.tsv", &tabs, &["--rate", &rate]);
    let names: Vec<String> = (1..=9).map(|column| format!("column_{column}")).collect();
    let names = names.join(",");
    let options = ["--rate", &rate, "--unit", "V", "--channels", &names];
    let samples = run.volts[0].len();
    for (name, fortran, shape) in [
        ("channels.npy", false, format!("(9, {samples})")),
        ("turned.npy", true, format!("(9, {samples})")),
        ("samples.npy", false, format!("({samples}, 9)")),
    ] {
        let order = if fortran { "True" } else { "False" };
        let header = format!("{{'descr': '<f8', 'fortran_order': {order}, 'shape': {shape}, }}");
        let header = format!("{header:<117}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        let by_channel = run.volts.iter().flatten().copied().collect::<Vec<f64>>();
        let by_sample = (0..samples)
            .flat_map(|s| run.volts.iter().map(move |c| c[s]))
            .collect();
        let values: Vec<f64> = if name == "channels.npy" {
            by_channel
        } else {
            by_sample
        };
        bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
        run.same(name, &bytes, &options);
    }
}

#[test]
fn prop_an_excluded_channel_need_not_be_there() {
    let run = the_run();
    let eight: Vec<&str> = LIMBS.into_iter().filter(|limb| *limb != "u5").collect();
    let volts: Vec<Vec<f64>> = (0..9)
        .filter(|l| *l != 4)
        .map(|l| run.volts[l].clone())
        .collect();
    let path = run.folder.join("eight.npz");
    write(&path, &eight, "V", &volts, run.rate_hz);
    let outs = ["eight.parquet", "without.parquet"].map(|name| run.folder.file(name));
    let whole = run.folder.file("plain.npz");
    for (recording, out) in [text(&path), &whole].into_iter().zip(&outs) {
        let output = decouple(recording, out, &["--excluded", "5"]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
    }
    let [eight, nine] = outs.map(|out| columns(out.as_ref(), &ACCELERATIONS).0);
    assert_eq!(eight, nine);
    let output = decouple(text(&path), &run.folder.file("none.parquet"), &[]);
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).contains("u5"), "{}", stderr(&output));
}

#[test]
fn neg_a_recorder_that_hung_is_told() {
    let run = the_run();
    let hung = |name: &str, volts: &[Vec<f64>], more: &[&str]| {
        let path = run.folder.join(name);
        write(&path, &LIMBS, "V", volts, run.rate_hz);
        stderr(&decouple(
            text(&path),
            &run.folder.file("hung.parquet"),
            more,
        ))
    };
    let told = "all channels stand still to the last bit";
    let said = hung("sound.npz", &run.volts, &[]);
    assert!(!said.contains(told), "{said}");
    let half = run.volts[0].len() / 2;
    let mut volts = run.volts.clone();
    for column in &mut volts {
        let value = column[half];
        column[half..half + 200].fill(value);
    }
    let said = hung("hung.npz", &volts, &[]);
    assert!(said.contains(told), "{said}");
    let mut volts = run.volts.clone();
    volts.iter_mut().for_each(|column| column[half..].fill(0.0));
    let said = hung("padded.npz", &volts, &["--excluded", "5"]);
    assert!(said.contains(told), "{said}");
}

#[test]
fn neg_a_streams_stamps_are_held_against_its_rate() {
    let run = the_run();
    let stream = |rows: &str, rate: &str| {
        let decouple = ["decouple", &calibration(), "-", "--gain", "0.05"];
        let output = fed(&[&decouple[..], &["--rate", rate]].concat(), rows);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        output
    };
    let rate = run.rate_hz.to_string();
    let all = run.table(&headings("time [s]", "none", ","), ",", |sample| {
        [run.stamp(sample).to_string(), "0".to_owned()]
    });
    assert!(!stderr(&stream(&all, &rate)).contains("time stamp"));
    let lines: Vec<&str> = all.lines().collect();
    let gap = [&lines[..100], &lines[300..]].concat().join("\n") + "\n";
    let said = stderr(&stream(&gap, &rate));
    assert!(said.contains("line 101: the time stamp is"), "{said}");
    let said = stderr(&stream(&all, &(2.0 * run.rate_hz).to_string()));
    assert!(
        said.contains("is the rate another") && said.contains("in all"),
        "{said}"
    );
    // Times of a calendar, in seconds since the first.
    let whole = run.table(&headings("time", "none", ","), ",", |sample| {
        let stamp = 10.0 + run.stamp(sample);
        [format!("2024-05-31T14:03:{stamp:09.6}"), "0".to_owned()]
    });
    let output = stream(&whole, &rate);
    assert!(
        !stderr(&output).contains("time stamp"),
        "{}",
        stderr(&output)
    );
    let printed = stdout(&output);
    let first = printed.lines().nth(1).and_then(|row| row.split(',').next());
    let first: f64 = first.expect("a row").parse().expect("seconds");
    assert!((first - run.stamp(1)).abs() < 1e-6, "{first}");
}

#[test]
fn neg_no_recording_is_written_over() {
    let run = the_run();
    let names = LIMBS.map(|limb| limb.replace('u', "ai"));
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let path = run.folder.join("field.npz");
    write(&path, &names, "V", &run.volts, run.rate_hz);
    let before = fs::read(&path).expect("reads");
    let plain = run.folder.file("plain.npz");
    let output = decouple(&plain, text(&path), &[]);
    assert_eq!(code(&output), 1, "{}", stderr(&output));
    assert!(stderr(&output).contains("would be written over"));
    assert_eq!(fs::read(&path).expect("reads"), before);
    // A result is.
    let result = run.folder.file("result.npz");
    for _ in 0..2 {
        let output = decouple(&plain, &result, &[]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
    }
    let day = Folder::new("decouple-forms-day");
    let kept = day.write("linear-01.csv", "u1\n1\n");
    let simulate = |more: &[&str]| {
        let first = ["simulate", "--out", text(&day), "--engine", "rigid"];
        let short = ["--trials", "3", "--rate", "500"];
        crate::program::run(&[&first[..], &short, more].concat())
    };
    let output = simulate(&[]);
    assert_eq!(code(&output), 1);
    let said = stderr(&output);
    assert!(
        said.contains("linear-01.csv") && said.contains("--force"),
        "{said}"
    );
    assert_eq!(fs::read_to_string(&kept).expect("reads"), "u1\n1\n");
    assert_eq!(code(&simulate(&["--force"])), 0);
}

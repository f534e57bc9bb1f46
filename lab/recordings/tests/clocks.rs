//! What a gap is, every command is told by the same rule: `inspect` names it where `calibrate` and `decouple` refuse it. Standards of a file of
//! their own are read on the clock of the limbs.

use std::fmt::Write as _;
use std::path::Path;

use sixaxis_recordings::Error;
use sixaxis_recordings::ingest::columns::stamps;
use sixaxis_recordings::ingest::{find, readings};
use sixaxis_recordings::inspect::{Expected, Severity, inspect};
use sixaxis_recordings::session::SessionFile;

const SESSION: &str = concat!(
    include_str!("card.toml"),
    r#"
[[recording]]
file = "run.csv"
role = "linear"
direction = [1, 0, 0]
frequency_hz = 1.0
"#
);

/// The sample before which each command finds a hole in a recording with these time stamps; -1 for none.
fn found(folder: &Path, stamps_s: &[f64]) -> [i64; 3] {
    let mut text = String::from("time [s]");
    for limb in 1..=9 {
        let _ = write!(text, ",u{limb} [V]");
    }
    text.push_str(",accelerometer [m/s^2],gyroscope [rad/s]\n");
    for t in stamps_s {
        let values: Vec<String> = (0..11)
            .map(|k| (t * 6.0 + f64::from(k)).sin().to_string())
            .collect();
        let _ = writeln!(text, "{t},{}", values.join(","));
    }
    let run = folder.join("run.csv");
    std::fs::write(&run, text).expect("writes");
    let session = SessionFile::parse(&folder.join("session.toml"), SESSION.to_owned());
    let session = session.expect("a session");
    let inspection =
        inspect(&run, Some(Expected::of(&session, &run)), &mut |_, _| {}).expect("it can be read");
    let noticed = inspection
        .told(Severity::Noticed)
        .any(|fact| fact.kind == "gap");
    if let Some(fact) = inspection.facts.iter().find(|fact| fact.kind == "gap") {
        assert!(
            fact.text.starts_with("gap before sample 200 (line 202): "),
            "{}",
            fact.text
        );
    }
    let clock = inspection.groups[0].time_stamps.as_ref().expect("stamps");
    assert_eq!(noticed, clock.gaps > 0);
    let refused = |error: Error| match error {
        Error::Sample {
            sample,
            line,
            cause,
            ..
        } if cause.contains("gap") => {
            // One line of headings, and lines count from 1.
            assert_eq!(line, Some(sample + 2));
            let before_s = stamps_s[sample as usize - 1];
            assert!(
                cause.contains(&format!("after time {before_s} s")),
                "{cause}"
            );
            sample as i64
        }
        other => panic!("{other}"),
    };
    let whole = readings::read(&session, 0);
    let source = sixaxis_recordings::open(&run).expect("opens");
    let time = find::time(&run, source.layout(), None).expect("finds");
    let streamed = stamps(&run, &time.expect("time stamps"), Some(1000.0));
    [
        clock.first_gaps.first().map_or(-1, |gap| gap.sample as i64),
        whole.map_or_else(refused, |_| -1),
        streamed.map_or_else(refused, |_| -1),
    ]
}

#[test]
fn a_missing_sample_is_a_gap_to_inspect_calibrate_and_decouple_alike() {
    let folder = tempfile::tempdir().expect("a folder");
    let even: Vec<f64> = (0..400).map(|k| f64::from(k) * 1e-3).collect();
    assert_eq!(found(folder.path(), &even), [-1; 3]);
    // Jitter of a third of a step is resampled, not refused.
    let jitter: Vec<f64> = even
        .iter()
        .enumerate()
        .map(|(k, t)| t + 3e-4 * ((k * 7919) % 13) as f64 / 13.0)
        .collect();
    assert_eq!(found(folder.path(), &jitter), [-1; 3]);
    // A single sample is missing, and more of them.
    for missing in [1, 2, 50] {
        let mut stamps_s = jitter.clone();
        stamps_s.drain(200..200 + missing);
        assert_eq!(
            found(folder.path(), &stamps_s),
            [200; 3],
            "{missing} missing"
        );
    }
}

/// Samples per second of limbs and standards, and how much later the standards' file begins, s.
const RATES_HZ: [f64; 2] = [1000.0, 500.0];
const LATER_S: f64 = 0.25;

/// What the standard accelerometer shows at a time after the first sample of the limbs.
fn acceleration(t: f64) -> f64 {
    t.sin()
}

/// When the standards begin after the limbs by a session that says so, or does not, and by what the two files have for time stamps.
fn begins_s(folder: &Path, stamp: &dyn Fn(f64) -> String, stated: &str) -> f64 {
    let mut limbs = String::from("time");
    for limb in 1..=9 {
        let _ = write!(limbs, ",u{limb} [V]");
    }
    limbs.push('\n');
    let mut standards = String::from("time,accelerometer [m/s^2],gyroscope [rad/s]\n");
    for k in 0..1000 {
        let t = f64::from(k) / RATES_HZ[0];
        let _ = writeln!(limbs, "{}{}", stamp(t), format!(",{t}").repeat(9));
        let t = LATER_S + f64::from(k) / RATES_HZ[1];
        let _ = writeln!(standards, "{},{},0", stamp(t), acceleration(t));
    }
    std::fs::write(folder.join("run.csv"), limbs).expect("writes");
    std::fs::write(folder.join("standards.csv"), standards).expect("writes");
    let text = format!("{SESSION}reference_file = \"standards.csv\"\n{stated}\n");
    let session = SessionFile::parse(&folder.join("session.toml"), text).expect("a session");
    let read = readings::read(&session, 0).expect("it can be read");
    // The limbs show the time, and the standards the sine of theirs.
    let sample = 100;
    let t = read.voltage_v[0][sample];
    t + LATER_S - read.accelerometer_m_s2[sample].asin()
}

#[test]
fn standards_of_a_file_of_their_own_begin_when_the_dates_say() {
    let folder = tempfile::tempdir().expect("a folder");
    let dated = |t: f64| format!("2024-05-31T14:03:{:09.6}", 7.0 + t);
    let relative = |t: f64| format!("{t:.6}");
    let close = |begins_s: f64, expected_s: f64| {
        let off_s = (begins_s - expected_s).abs();
        assert!(off_s < 1e-6, "{begins_s} s and not {expected_s} s");
    };
    // Stamps of seconds may be each recorder's own: files that do not say otherwise begin together.
    for (stamp, expected_s) in [
        (&relative as &dyn Fn(f64) -> String, 0.0),
        (&dated, LATER_S),
    ] {
        close(begins_s(folder.path(), stamp, ""), expected_s);
        close(
            begins_s(folder.path(), stamp, "reference_start_s = 0.1"),
            0.1,
        );
    }
}

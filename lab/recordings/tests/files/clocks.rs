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
    include_str!("../card.toml"),
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

/// Samples per second of limbs and standards.
const RATES_HZ: [f64; 2] = [1000.0, 500.0];

/// What the time stamps of a file look like, s after the limbs begin.
type Stamp = fn(f64) -> String;

/// So many seconds after 14:03:07.
fn of_day(t: f64) -> String {
    format!("14:03:{:09.6}", 7.0 + t)
}

fn dated(t: f64) -> String {
    format!("2024-05-31T{}", of_day(t))
}

/// Two hours ahead of universal time.
fn summer_time(t: f64) -> String {
    format!("{}+02:00", dated(t))
}

fn universal(t: f64) -> String {
    format!("2024-05-31T12:03:{:09.6}Z", 7.0 + t)
}

/// The date in a column of its own.
fn two_columns(t: f64) -> String {
    format!("31.05.2024,{}", of_day(t))
}

fn relative(t: f64) -> String {
    format!("{t:.6}")
}

/// When the standards are taken to begin after the limbs, who begin so many seconds later, in a session that says so, or does not.
fn taken_to_begin(
    folder: &Path,
    later_s: f64,
    [limbs, standards]: [Stamp; 2],
    stated: &str,
) -> Result<f64, Error> {
    let heading = |stamp: Stamp| match stamp(0.0).contains(',') {
        true => "date,time",
        false => "time",
    };
    let mut of_limbs = String::from(heading(limbs));
    for limb in 1..=9 {
        let _ = write!(of_limbs, ",u{limb} [V]");
    }
    of_limbs.push('\n');
    let names = "accelerometer [m/s^2],gyroscope [rad/s]";
    let mut of_standards = format!("{},{names}\n", heading(standards));
    // The limbs show the time, and the accelerometer its sine.
    for k in 0..1000 {
        let t = f64::from(k) / RATES_HZ[0];
        let _ = writeln!(of_limbs, "{}{}", limbs(t), format!(",{t}").repeat(9));
        let t = later_s + f64::from(k) / RATES_HZ[1];
        let _ = writeln!(of_standards, "{},{},0", standards(t), t.sin());
    }
    std::fs::write(folder.join("run.csv"), of_limbs).expect("writes");
    std::fs::write(folder.join("standards.csv"), of_standards).expect("writes");
    let text = format!("{SESSION}reference_file = \"standards.csv\"\n{stated}\n");
    let session = SessionFile::parse(&folder.join("session.toml"), text).expect("a session");
    let read = readings::read(&session, 0)?;
    let sample = 100;
    let t = read.voltage_v[0][sample];
    Ok(t + later_s - read.accelerometer_m_s2[sample].asin())
}

#[test]
fn standards_of_a_file_of_their_own_begin_when_the_dates_say() {
    let folder = tempfile::tempdir().expect("a folder");
    for later_s in [0.25, -0.25] {
        // Seconds may be each recorder's own, and so may be the hour of a wall and universal time: such files begin together.
        for (stamps, expected_s) in [
            ([relative, relative], 0.0),
            ([dated, relative], 0.0),
            ([dated, universal], 0.0),
            ([of_day, of_day], 0.0),
            ([dated, dated], later_s),
            ([dated, two_columns], later_s),
            ([summer_time, universal], later_s),
        ] as [([Stamp; 2], f64); 7]
        {
            for (stated, expected_s) in [("", expected_s), ("reference_start_s = 0.1", 0.1)] {
                let begins_s = taken_to_begin(folder.path(), later_s, stamps, stated);
                let begins_s = begins_s.expect("it can be read");
                let off_s = (begins_s - expected_s).abs();
                let [limbs, standards] = stamps.map(|stamp| stamp(0.0));
                assert!(
                    off_s < 1e-6,
                    "{limbs}, {standards}, {stated:?}: {begins_s} s and not {expected_s} s"
                );
            }
        }
    }
    let error = taken_to_begin(folder.path(), 30.0, [dated, dated], "");
    let error = error.expect_err("standards of another run").to_string();
    assert!(
        error.contains("reference_start_s")
            && error.contains("from 30 to 31.998 s after the recording's first sample"),
        "{error}"
    );
}

/// What a session of a sine on every channel, a millisecond a sample, has of sample 100 when it says so.
fn with_delays(folder: &Path, accelerometer: &str, gyroscope: &str) -> Result<[f64; 4], Error> {
    let mut text = String::from(
        "u1 [V],u2 [V],u3 [V],u4 [V],u5 [V],u6 [V],u7 [V],u8 [V],u9 [V],accelerometer [m/s^2],gyroscope [rad/s]\n",
    );
    for k in 0..1000 {
        let x = (0.02 * f64::from(k)).sin();
        let _ = writeln!(text, "{x}{}", format!(",{x}").repeat(10));
    }
    std::fs::write(folder.join("run.csv"), text).expect("writes");
    let text = format!("{SESSION}sample_rate_hz = 1000.0\n")
        .replace(
            "[accelerometer]\n",
            &format!("[accelerometer]\n{accelerometer}\n"),
        )
        .replace("[gyroscope]\n", &format!("[gyroscope]\n{gyroscope}\n"));
    let session = SessionFile::parse(&folder.join("session.toml"), text).expect("a session");
    let read = readings::read(&session, 0)?;
    let samples = read.voltage_v[8].len();
    assert_eq!(samples, read.accelerometer_m_s2.len());
    assert_eq!(samples, read.gyroscope_rad_s.len());
    let shown = [
        read.voltage_v[0][100],
        read.accelerometer_m_s2[100],
        read.gyroscope_rad_s[100],
    ];
    let [u, a, w] = shown.map(|x| x.asin() / 0.02);
    Ok([samples as f64, u, a, w])
}

#[test]
fn a_delay_of_a_standard_is_undone_as_it_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    // Sample 100 is the sine's at 2 rad, whose arc sine is pi less that.
    let at = |late: f64| (core::f64::consts::PI - 0.02 * (100.0 + late)) / 0.02;
    for (accelerometer, gyroscope, samples, late) in [
        ("", "", 1000.0, [0.0, 0.0]),
        ("delay_ms = 2.5", "", 997.0, [2.5, 0.0]),
        ("", "delay_ms = 4", 996.0, [0.0, 4.0]),
        ("delay_ms = 1.25", "delay_ms = 7.75", 992.0, [1.25, 7.75]),
    ] {
        let [read, u, a, w] = with_delays(folder.path(), accelerometer, gyroscope).expect("reads");
        assert_eq!(read, samples, "{accelerometer} {gyroscope}");
        for (found, late) in [(u, 0.0), (a, late[0]), (w, late[1])] {
            assert!(
                (found - at(late)).abs() < 1e-6,
                "{accelerometer} {gyroscope}: {found}"
            );
        }
    }
    let beyond = with_delays(folder.path(), "delay_ms = 2000.0", "");
    let beyond = beyond.expect_err("longer than the record").to_string();
    assert!(
        beyond.contains("run.csv") && beyond.contains("delay"),
        "{beyond}"
    );
}

//! What the command is given to read: pipes and devices are refused at once, numbers stay short, and nothing is overruled in silence.

use std::fs;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::program::{Folder, code, done, run, stderr, stdout};

/// A day that is simulated and calibrated in seconds: folder, session file, calibration.
fn day(name: &str) -> (Folder, String, String) {
    let folder = Folder::new(name);
    let out = folder.file("day");
    let quick = ["--engine", "rigid", "--trials", "3", "--rate", "500"];
    done(&[&["simulate", "--out", &out, "--format", "csv"][..], &quick].concat());
    let session = folder.file("day/session.toml");
    run(&["calibrate", &session]);
    let calibration = folder.file("day/calibration.json");
    (folder, session, calibration)
}

#[cfg(target_os = "linux")]
#[test]
fn neg_a_pipe_without_a_writer_holds_nobody_up() {
    let folder = Folder::new("pipes");
    let made = Command::new("mkfifo")
        .current_dir(&*folder)
        .args(["run.csv", "run.csv.gz"])
        .status();
    assert!(made.expect("mkfifo starts").success());
    let (pipe, packed) = (folder.file("run.csv"), folder.file("run.csv.gz"));
    let started = Instant::now();
    for arguments in [
        &["inspect", &pipe][..],
        &["inspect", &packed],
        &["inspect", "/dev/zero"],
        &["compare", &pipe, &pipe],
        &["calibrate", &pipe],
        &["calibrate", "/dev/zero"],
        &["decouple", &pipe, &pipe],
        &["simulate", "--plan", &pipe],
        &["simulate", "--plan", "/dev/zero"],
    ] {
        let said = Command::new("timeout")
            .args(["10", env!("CARGO_BIN_EXE_sixaxis")])
            .args(arguments)
            .output()
            .expect("timeout starts");
        assert_eq!(code(&said), 1, "{arguments:?}: {}", stderr(&said));
        let words = stderr(&said);
        assert!(
            words.contains("a pipe or a device, where a file was expected"),
            "{arguments:?}: {words}"
        );
    }
    assert!(started.elapsed() < Duration::from_secs(30));
}

#[test]
fn neg_no_number_is_three_hundred_digits_long() {
    let (folder, session, calibration) = day("digits");
    let recording = folder.file("day/compound-01.csv");
    let huge = folder.write(
        "huge.csv",
        "time,u1\ns,V\n0,1e308\n1e300,-1e308\n2e300,1e308\n3e300,5e-324\n",
    );
    let stated = fs::read_to_string(&session).expect("reads");
    let impossible = folder.write(
        "day/impossible.toml",
        stated.replacen("sample_rate_hz = 500.0", "sample_rate_hz = -1e308", 1),
    );
    for arguments in [
        &["inspect", &huge][..],
        &["compare", &huge, &huge],
        &["simulate", "--rate", "1e308", "--print-plan"],
        &["simulate", "--rate", "-1e308"],
        &["simulate", "--tumble", "1e308"],
        &["calibrate", &impossible],
        &[
            "decouple",
            &calibration,
            &recording,
            "--rate",
            "1e308",
            "--gain",
            "1e308",
        ],
        &[
            "decouple",
            &calibration,
            &recording,
            "--session",
            &session,
            "--rate",
            "1e308",
        ],
        &[
            "decouple",
            &calibration,
            &recording,
            "--session",
            &session,
            "--low-pass",
            "1e308",
        ],
    ] {
        let said = run(arguments);
        let words = stdout(&said) + &stderr(&said);
        let long = words
            .split(|c: char| !c.is_ascii_digit())
            .find(|digits| digits.len() >= 25);
        assert_eq!(long, None, "{arguments:?}: {words}");
    }
}

#[test]
fn inv_what_overrules_the_session_is_said() {
    let (folder, session, calibration) = day("overruled");
    // Nobody but the session states the rate.
    let recording = folder.file("day/compound-01.csv");
    let text = fs::read_to_string(&recording).expect("reads");
    folder.write(
        "day/compound-01.csv",
        text.replacen("# sample_rate_hz = 500\n", "", 1),
    );
    let stated = fs::read_to_string(&session).expect("reads");
    let file = "file = \"compound-01.csv\"\n";
    folder.write(
        "day/session.toml",
        stated.replacen(file, &format!("{file}sample_rate_hz = 500.0\n"), 1),
    );
    let out = folder.file("out.csv");
    let fixed = [
        "decouple",
        &calibration,
        &recording,
        "--out",
        &out,
        "--force",
        "--session",
        &session,
    ];
    let silent = run(&fixed);
    assert_eq!(code(&silent), 0, "{}", stderr(&silent));
    assert!(
        !stderr(&silent).contains("overrules"),
        "{}",
        stderr(&silent)
    );
    for (option, value, stated) in [
        ("--rate", "250", "500 Hz"),
        ("--gain", "3", "N/V"),
        ("--down", "0,1,0", "states direction"),
    ] {
        let words = stderr(&run(&[&fixed[..], &[option, value]].concat()));
        let line = words
            .lines()
            .find(|line| line.contains(&format!("{option} overrules it")));
        let line = line.unwrap_or_else(|| panic!("{option}: {words}"));
        assert!(
            line.contains("session.toml") && line.contains(stated) && line.contains(value),
            "{line}"
        );
    }
}

#[test]
fn neg_what_is_not_a_file_is_told_first() {
    let (folder, _, calibration) = day("no_file");
    let [own, missing] = ["day", "nope.tdms"].map(|name| folder.file(name));
    let recording = folder.file("day/compound-01.csv");
    for (arguments, words) in [
        (&["inspect", "-"][..], "standard input is not read here"),
        (
            &["compare", "-", &recording],
            "standard input is not read here",
        ),
        (
            &["compare", &recording, "-"],
            "standard input is not read here",
        ),
        (&["calibrate", "-"], "standard input is not read here"),
        (
            &["self-calibrate", &calibration, "-"],
            "standard input is not read here",
        ),
        (&["decouple", &calibration, &missing], "No such file"),
        (&["self-calibrate", &calibration, &missing], "No such file"),
        (&["calibrate", &own], "its session file is"),
    ] {
        let said = run(arguments);
        assert_eq!(code(&said), 1, "{arguments:?}: {}", stderr(&said));
        assert!(
            stderr(&said).contains(words),
            "{arguments:?}: {}",
            stderr(&said)
        );
    }
    // Options that do not go together are a command line that is not understood, whatever the files.
    let said = run(&["calibrate", &missing, "--robust"]);
    assert_eq!(code(&said), 2, "{}", stderr(&said));
    assert!(stderr(&said).contains("add --estimator joint"));
}

/// Our own Parquet, turned into text by other software, has its units in the names of the columns alone.
#[test]
fn inv_a_unit_at_the_end_of_a_name_is_read() {
    let (folder, session, calibration) = day("unit_in_name");
    let text = fs::read_to_string(folder.file("day/compound-01.csv")).expect("reads");
    let named = text
        .replace(" [V]", "_V")
        .replace("accelerometer [m/s^2]", "accelerometer_m_s2")
        .replace("gyroscope [rad/s]", "gyroscope_rad_s");
    assert_ne!(named, text);
    fs::write(folder.file("day/compound-01.csv"), &named).expect("writes");
    let recording = folder.file("day/compound-01.csv");
    let decouple = |out: &str| {
        let out = folder.file(out);
        done(&[
            "decouple",
            &calibration,
            &recording,
            "--session",
            &session,
            "--out",
            &out,
            "--force",
        ]);
        let text = fs::read_to_string(&out).expect("reads");
        let rows = text.lines().filter(|line| !line.starts_with('#'));
        rows.map(str::to_owned).collect::<Vec<_>>()
    };
    let by_name = decouple("by-name.csv");
    fs::write(&recording, &text).expect("writes");
    assert_eq!(by_name, decouple("by-heading.csv"));
}

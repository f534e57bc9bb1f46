//! `sixaxis calibrate` as a laboratory calls it: the binary, on sessions that the reference plays.

use std::path::Path;
use std::process::Output;

use sixaxis_reference::laboratory::defect::{Defect, Kind, Where};
use sixaxis_reference::laboratory::plan::{DefectChoice, Engine, SensorChoice, SessionPlan};
use sixaxis_reference::laboratory::session::simulate_session;
use sixaxis_reference::laboratory::write::write;

use sixaxis_recordings::{Block, Layout, create, open};

use crate::program::{Folder, Session, code, run, stderr, stdout, text};

/// Plays a session with the rigid engine, which takes a fraction of a second.
fn session(name: &str, defect: DefectChoice) -> Session {
    let plan = SessionPlan {
        seed: 14,
        sensor: SensorChoice::Random,
        engine: Engine::Rigid,
        static_duration_s: 60.0,
        defect,
        ..SessionPlan::default()
    };
    let played = simulate_session(&plan).expect("a session is played");
    Session::write(&format!("calibrate-{name}"), &played)
}

fn calibrate(arguments: &[&str]) -> Output {
    run(&[&["calibrate"], arguments].concat())
}

/// What a page must be to be opened anywhere.
fn check_page(path: &Path) -> String {
    let html = std::fs::read_to_string(path).expect("the report");
    assert!(html.trim_end().ends_with("</html>"), "the page is cut");
    assert!(
        !html.contains(">NaN") && !html.contains("inf "),
        "a number is missing"
    );
    let without_names = html
        .replace("http://www.w3.org/2000/svg", "")
        .replace("http-equiv", "");
    assert!(!without_names.contains("http"), "the page asks the network");
    html
}

#[test]
fn healthy_session_is_good_and_its_files_stand_beside_it() {
    let session = session("healthy", DefectChoice::None);
    let output = calibrate(&[text(&session)]);
    assert_eq!(code(&output), 0, "{}", stdout(&output));
    let said = stdout(&output);
    assert!(said.starts_with("Good: "), "{said}");
    assert!(said.contains("24 of 25 determined"), "{said}");
    assert!(
        said.lines()
            .all(|line| line.starts_with("  /") || line.chars().count() <= 96)
    );
    let beside = session.with_file_name("calibration.json");
    let calibration: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&beside).expect("a calibration")).expect("JSON");
    assert_eq!(calibration["verdict"], "good");
    let html = check_page(&session.with_file_name("calibration.html"));
    for id in [
        "next",
        "parameters",
        "trials",
        "validation",
        "steps",
        "preprocessing",
        "rest",
        "provenance",
    ] {
        assert!(html.contains(&format!("<section id=\"{id}\">")), "{id}");
    }
    assert!(html.contains("tile good"));
    assert!(!html.contains("tile bad") && !html.contains("tile warn"));

    // The same as constants for a firmware; a test of `sixaxis-calibration` compiles such a file.
    let output = calibrate(&[text(&session), "--format", "rust"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let source = session.with_file_name("calibration.rs");
    let source = std::fs::read_to_string(source).expect("a source beside the session file");
    for (key, value) in calibration["parameters"].as_object().expect("an object") {
        let numbers = value
            .as_array()
            .map_or(std::slice::from_ref(value), Vec::as_slice);
        for number in numbers {
            let literal = format!("{:?}", number.as_f64().expect("a number"));
            assert!(source.contains(&literal), "{key}: {literal}");
        }
    }
}

#[test]
fn defect_is_not_good_and_nothing_is_green() {
    let all_day = Defect {
        kind: Kind::InvertedChannel,
        magnitude: 1.0,
        place: Where::Everywhere,
        channel: 4,
        seed: 0,
    };
    let session = session("inverted", DefectChoice::Exactly(all_day));
    let folder = session.parent().expect("a folder");
    let (out, report) = (folder.join("to/c.json"), folder.join("to/r.html"));
    std::fs::create_dir(folder.join("to")).expect("a folder");
    let output = calibrate(&[
        text(&session),
        "--out",
        text(&out),
        "--report",
        text(&report),
        "--json",
        "--quiet",
    ]);
    assert_eq!(code(&output), 4, "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
    let summary: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(summary["verdict"], "bad");
    assert_eq!(summary["findings"][0]["cause"], "inverted_channel");
    assert!(!summary["next"].as_array().expect("a list").is_empty());
    assert_eq!(summary["files"]["report"], text(&report));
    let html = check_page(&report);
    assert!(html.contains("tile bad") && !html.contains("tile good"));
    assert!(html.contains("channel inverted"));
    // A calibration is written if and only if it is named.
    assert_eq!(
        summary["files"]["calibration"].as_str(),
        out.exists().then(|| text(&out))
    );
    assert!(!session.with_file_name("calibration.html").exists());
}

#[test]
fn recording_that_is_cut_is_a_finding() {
    let session = session("cut", DefectChoice::None);
    let cut = session.with_file_name("linear-03.npz");
    let bytes = std::fs::read(&cut).expect("a recording");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).expect("a shorter one");
    let output = calibrate(&[text(&session)]);
    assert_eq!(code(&output), 4);
    assert!(stdout(&output).contains("recording cannot be used: linear-03.npz"));
    let html = check_page(&session.with_file_name("calibration.html"));
    assert!(html.contains("recording cannot be used"));
}

#[test]
fn quiet_says_nothing_and_the_code_says_it_all() {
    let session = session("quiet", DefectChoice::None);
    let elsewhere = Folder::new("calibrate-elsewhere");
    let out = elsewhere.join("day.json");
    let output = calibrate(&[text(&session), "--quiet", "--out", text(&out)]);
    assert_eq!(
        (code(&output), stdout(&output), stderr(&output)),
        (0, String::new(), String::new())
    );
    // The page goes where the calibration goes: the session's folder may be anybody's.
    check_page(&out.with_extension("html"));
    assert!(!session.with_file_name("calibration.html").exists());
}

#[test]
fn what_cannot_be_done_is_an_error_and_writes_nothing() {
    let folder = Folder::new("calibrate-errors");
    let absent = folder.join("session.toml");
    let output = calibrate(&[text(&absent)]);
    assert_eq!(code(&output), 1);
    assert!(
        stderr(&output).contains("session.toml"),
        "{}",
        stderr(&output)
    );
    std::fs::write(&absent, "[sensor]\nlimb_length_mm = -1\n").expect("a file");
    let output = calibrate(&[text(&absent)]);
    assert_eq!(code(&output), 1);
    assert_eq!(std::fs::read_dir(&*folder).expect("a folder").count(), 1);
    assert_eq!(code(&calibrate(&[])), 2);
}

#[test]
fn what_is_read_is_never_written_over() {
    let session = session("over", DefectChoice::None);
    let before = std::fs::read(&*session).expect("a session");
    let recording = session.with_file_name("linear-01.npz");
    for target in [&*session, &recording] {
        for option in ["--out", "--report"] {
            let output = calibrate(&[text(&session), option, text(target)]);
            assert_eq!(code(&output), 1);
            assert!(
                stderr(&output).contains("written over"),
                "{}",
                stderr(&output)
            );
        }
    }
    assert_eq!(std::fs::read(&*session).expect("a session"), before);
    let one = session.with_file_name("one");
    let output = calibrate(&[text(&session), "--out", text(&one), "--report", text(&one)]);
    assert_eq!(code(&output), 1);
    assert!(!one.exists());
}

#[test]
fn schemas_are_json() {
    for (format, title) in [("session", "Session"), ("calibration", "Calibration")] {
        let output = calibrate(&["--schema", format]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let schema: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
        assert_eq!(schema["title"], title);
    }
}

#[test]
fn repetition_ends_with_a_verdict_on_k_over_m() {
    let session = session("iterate", DefectChoice::None);
    let output = calibrate(&[text(&session), "--iterate", "3"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let said = stdout(&output);
    assert!(said.contains("Steps 2 to 4, repeated"), "{said}");
    // Noise leaves step 4 without a minimum, so that the first pass is the last.
    assert!(said.contains("cannot be had from this campaign"), "{said}");
    let output = calibrate(&[text(&session), "--iterate", "3", "--json", "--quiet"]);
    let summary: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert!(
        summary["iteration"]["end"]["undetermined"].is_object(),
        "{summary}"
    );
    assert!(summary["iteration"]["stiffness_per_mass_per_s2"].is_null());
    let output = calibrate(&[text(&session), "--iterate", "0"]);
    assert_eq!(code(&output), 2, "{}", stderr(&output));
}

/// Takes a channel out of a recording.
fn without_channel(path: &Path, name: &str) {
    let mut source = open(path).expect("opens");
    let layout = source.layout().clone();
    let kept: Vec<usize> = (0..layout.channels.len())
        .filter(|at| layout.channels[*at].name != name)
        .collect();
    source.select(&kept).expect("selects");
    let mut rows = Block::default();
    let mut all = Block::new(kept.len());
    while source.read(&mut rows, 1 << 20).expect("reads") > 0 {
        for (all, column) in all.columns.iter_mut().zip(&rows.columns) {
            all.extend_from_slice(column);
        }
    }
    let channels = kept.iter().map(|at| layout.channels[*at].clone()).collect();
    let layout = Layout { channels, ..layout };
    let mut sink = create(path, &layout).expect("creates");
    sink.write(&all).expect("writes");
    sink.finish().expect("finishes");
}

#[test]
fn one_cause_in_many_recordings_is_one_finding() {
    let session = session("one-cause", DefectChoice::None);
    for number in 1..=6 {
        without_channel(
            &session.with_file_name(format!("linear-0{number}.npz")),
            "u7",
        );
    }
    without_channel(&session.with_file_name("angular-01.npz"), "u2");
    let output = calibrate(&[text(&session), "--json", "--quiet"]);
    let summary: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let findings: Vec<(usize, &str)> = summary["findings"]
        .as_array()
        .expect("a list")
        .iter()
        .filter(|finding| finding["cause"] == "unreadable")
        .map(|finding| {
            let recordings = finding["recordings"].as_array().expect("a list");
            (
                recordings.len(),
                finding["evidence"].as_str().expect("text"),
            )
        })
        .collect();
    assert_eq!(findings.len(), 2, "{findings:?}");
    for ((recordings, evidence), (expected, channel)) in findings.iter().zip([(6, "u7"), (1, "u2")])
    {
        assert_eq!(*recordings, expected);
        let start = format!("no channel \"{channel}\"; it has u1");
        assert!(evidence.starts_with(&start), "{evidence}");
    }
}

#[test]
fn unusable_session_is_an_error_and_an_earlier_calibration_is_mentioned() {
    let session = session("unusable", DefectChoice::None);
    let calibration = session.with_file_name("calibration.json");
    let toml = std::fs::read_to_string(&*session).expect("a session");
    std::fs::write(session.with_file_name("static.npz"), b"PK").expect("a broken record");
    let refused = || {
        let output = calibrate(&[text(&session), "--quiet"]);
        assert_eq!((code(&output), stdout(&output)), (1, String::new()));
        stderr(&output)
    };
    let said = refused();
    assert!(said.contains("no calibration is written"), "{said}");
    assert!(!said.contains("earlier run"), "{said}");
    assert!(!calibration.exists());
    std::fs::write(&calibration, "that of yesterday").expect("a file");
    for broken in [
        toml.clone(),
        toml.replace("limb_length_mm", "limb_lenght_mm"),
    ] {
        std::fs::write(&*session, broken).expect("a session");
        let said = refused();
        let words = format!("{} is from before", text(&calibration));
        assert!(said.contains(&words), "{said}");
    }
    let kept = std::fs::read_to_string(&calibration).expect("it is still there");
    assert_eq!(kept, "that of yesterday");
}

#[test]
fn recording_that_was_cut_short_is_a_reservation() {
    let plan = SessionPlan {
        seed: 14,
        sensor: SensorChoice::Random,
        engine: Engine::Rigid,
        static_duration_s: 60.0,
        ..SessionPlan::default()
    };
    let folder = Folder::new("calibrate-cut-short");
    let played = simulate_session(&plan).expect("a session is played");
    let session = write(&played, &folder, "tdms").expect("a session is written");
    for name in ["linear-03.tdms", "angular-02.tdms"] {
        let cut = folder.join(name);
        let bytes = std::fs::read(&cut).expect("a recording");
        std::fs::write(&cut, &bytes[..bytes.len() - 800]).expect("a shorter one");
    }
    let output = calibrate(&[text(&session), "--json", "--quiet"]);
    assert_eq!(code(&output), 3, "{}", stdout(&output));
    let summary: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let reservations = summary["reservations"].to_string();
    let words = "linear-03.tdms and angular-02.tdms: its last segment is cut short";
    assert!(reservations.contains(words), "{reservations}");
}

//! `sixaxis simulate` as people run it.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::program::{Folder, sixaxis, stderr, stdout};

impl Folder {
    fn simulate(&self, arguments: &[&str]) -> Output {
        command(self, arguments)
            .output()
            .expect("the command starts")
    }
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = sixaxis();
    command.current_dir(folder).arg("simulate").args(arguments);
    command
}

/// A campaign that takes no time.
const QUICK: [&str; 6] = ["--engine", "rigid", "--trials", "3", "--rate", "200"];

#[test]
fn prop_it_says_what_it_wrote_and_what_comes_next() {
    let folder = Folder::new("next");
    let done = folder.simulate(&[&QUICK[..], &["--out", "a day"]].concat());
    assert!(done.status.success(), "{}", stderr(&done));
    let said = stdout(&done);
    assert!(
        said.contains("sixaxis calibrate 'a day/session.toml'"),
        "{said}"
    );
    assert!(said.contains("truth"), "{said}");
    for name in [
        "session.toml",
        "static.csv",
        "fast-03.csv",
        "truth/truth.json",
        "truth/plan.toml",
    ] {
        assert!(
            folder.join("a day").join(name).exists(),
            "{name} is missing"
        );
    }
}

#[test]
fn prop_another_session_is_replaced_only_if_told_so() {
    let folder = Folder::new("force");
    let first = [&QUICK[..], &["--out", "day"]].concat();
    assert!(folder.simulate(&first).status.success());
    let session = folder.join("day/session.toml");
    let before = std::fs::read_to_string(&session).expect("it was written");
    let second = [&first[..], &["--seed", "2"]].concat();
    let refused = folder.simulate(&second);
    assert_eq!(refused.status.code(), Some(1));
    assert!(stderr(&refused).contains("--force"), "{}", stderr(&refused));
    assert_eq!(
        std::fs::read_to_string(&session).ok().as_deref(),
        Some(&*before)
    );
    assert!(
        folder
            .simulate(&[&second[..], &["--force"]].concat())
            .status
            .success()
    );
    let after = std::fs::read_to_string(&session).expect("it was written");
    assert_ne!(after, before);
}

#[test]
fn prop_a_killed_run_leaves_no_session_file() {
    let folder = Folder::new("killed");
    // MuJoCo is busy with this for most of a minute.
    let mut child = command(&folder, &["--out", "day"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the command starts");
    let started = Instant::now();
    while !folder.join("day").exists() && started.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(200));
    child.kill().expect("it is still at work");
    let status = child.wait().expect("it ends");
    assert!(!status.success(), "it was done before it could be killed");
    assert!(folder.join("day").exists());
    assert!(!folder.join("day/session.toml").exists());
    // What it left is in nobody's way.
    let again = folder.simulate(&[&QUICK[..], &["--out", "day"]].concat());
    assert!(again.status.success(), "{}", stderr(&again));
}

#[test]
fn prop_a_plan_is_printed_played_and_overridden() {
    let folder = Folder::new("plan");
    let printed =
        folder.simulate(&[&QUICK[..], &["--print-plan", "--defect", "dead_limb"]].concat());
    assert!(printed.status.success());
    folder.write("plan.toml", stdout(&printed));
    let again = folder.simulate(&["--plan", "plan.toml", "--print-plan"]);
    assert_eq!(stdout(&again), stdout(&printed));
    for (out, more) in [
        ("a", &[][..]),
        ("b", &["--seed", "5", "--defect", "none"][..]),
    ] {
        let done = folder.simulate(&[&["--plan", "plan.toml", "--out", out], more].concat());
        assert!(done.status.success(), "{}", stderr(&done));
    }
    let truth = |out: &str| {
        std::fs::read_to_string(folder.join(out).join("truth/truth.json")).expect("it is there")
    };
    assert!(truth("a").contains("dead_limb"));
    assert!(truth("b").contains("\"defect\": null"));
    // What is in the truth folder plays the same session again.
    let replayed = folder.simulate(&["--plan", "a/truth/plan.toml", "--out", "c"]);
    assert!(replayed.status.success(), "{}", stderr(&replayed));
    let recording = |out: &str| std::fs::read(folder.join(out).join("linear-01.csv")).ok();
    assert_eq!(recording("a"), recording("c"));
    assert_ne!(recording("a"), recording("b"));
}

#[test]
fn prop_refusals_name_file_and_line() {
    let folder = Folder::new("refused");
    folder.write("unknown.toml", "seed = 1\n[rig]\nrests = 1.0\n");
    folder.write(
        "impossible.toml",
        "[rig]\nmounting = \"axis_level\"\nrest_s = -1.0\n",
    );
    for (arguments, code, said) in [
        (&["--plan", "unknown.toml"][..], 1, "unknown.toml, line 3"),
        (
            &["--plan", "impossible.toml"][..],
            1,
            "impossible.toml, line 3: rig.rest_s",
        ),
        (&["--plan", "missing.toml"][..], 1, "missing.toml"),
        (&["--rate", "nan"][..], 1, "sample_rate_hz"),
        (&["--format", "npy"][..], 2, "npz"),
        (&["--defect", "gremlins"][..], 2, "dead_limb"),
    ] {
        let refused = folder.simulate(arguments);
        let error = stderr(&refused);
        assert_eq!(refused.status.code(), Some(code), "{arguments:?}: {error}");
        assert!(error.contains(said), "{arguments:?}: {error}");
    }
    assert!(!folder.join("sixaxis-session").exists());
}

//! `sixaxis campaign` as people run it: killed and resumed, in shards, in folders that are not its own or not whole.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::program::{Folder, sixaxis, stderr, stdout};

/// Cases of a part.
const PART: u64 = 64;

impl Folder {
    fn campaign(&self, arguments: &[&str]) -> Output {
        command(self, arguments)
            .output()
            .expect("the command starts")
    }

    /// Runs and expects it to be done.
    fn run(&self, out: &str, count: u64, more: &[&str]) -> String {
        let count = count.to_string();
        let done = self.campaign(
            &[
                &[
                    "run",
                    "--plan",
                    "plan.toml",
                    "--count",
                    &count,
                    "--out",
                    out,
                ],
                more,
            ]
            .concat(),
        );
        assert!(done.status.success(), "{}", stderr(&done));
        stdout(&done) + &stderr(&done)
    }

    fn summary(&self, folders: &[&str]) -> Output {
        self.campaign(&[&["summary", "--json"], folders].concat())
    }

    /// Names and contents of the parts.
    fn parts(&self, out: &str) -> Vec<(String, Vec<u8>)> {
        let mut parts: Vec<(String, Vec<u8>)> = std::fs::read_dir(self.join(out))
            .expect("the folder is there")
            .map(|entry| entry.expect("it can be listed").path())
            .filter(|path| path.extension().is_some_and(|e| e == "parquet"))
            .map(|path| {
                let name = path.file_name().expect("it has one").to_string_lossy();
                (
                    name.into_owned(),
                    std::fs::read(&path).expect("it can be read"),
                )
            })
            .collect();
        parts.sort();
        parts
    }
}

/// A folder with the plan.
fn prepared(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder.write("plan.toml", PLAN);
    folder
}

/// The same with trials too short for a joint fit, which takes nine tenths of the time of a case.
fn prepared_without_joint(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder.write("plan.toml", PLAN.replace("200.0", "125.0"));
    folder
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = sixaxis();
    command.current_dir(folder).arg("campaign").args(arguments);
    command
}

/// A session that is played and calibrated in milliseconds.
const PLAN: &str = "\
engine = \"rigid\"
sensor = \"random\"
trials_per_step = 3
sample_rate_hz = 200.0
static_duration_s = 30.0
static_rate_hz = 10.0
";

#[test]
fn inv_a_killed_run_goes_on_to_the_same_bytes() {
    let folder = prepared_without_joint("campaign-killed");
    let count = 4 * PART;
    folder.run("undisturbed", count, &["--threads", "2"]);
    let mut child = command(
        &folder,
        &[
            "run",
            "--plan",
            "plan.toml",
            "--count",
            &count.to_string(),
            "--out",
            "killed",
            "--threads",
            "1",
        ],
    )
    .stdout(Stdio::null())
    .stderr(Stdio::null())
    .spawn()
    .expect("the command starts");
    // Once something is finished and before everything is.
    let patience = Instant::now() + Duration::from_secs(120);
    while Instant::now() < patience
        && (!folder.join("killed").exists() || folder.parts("killed").is_empty())
    {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().expect("it is still at work");
    let status = child.wait().expect("it has ended");
    assert!(!status.success(), "it was done before it could be killed");
    let whole = folder.parts("undisturbed");
    let left = folder.parts("killed");
    assert!(
        !left.is_empty() && left.len() < whole.len(),
        "{} parts",
        left.len()
    );
    assert!(
        left.iter().all(|part| whole.contains(part)),
        "what is there is whole"
    );
    // A reader of what is there so far is told what is not.
    assert_eq!(folder.summary(&["killed"]).status.code(), Some(3));
    let said = folder.run("killed", count, &["--threads", "1"]);
    let found = left.len() as u64 * PART;
    assert!(
        said.contains(&format!("{found} found done, {} done", count - found)),
        "{said}"
    );
    assert!(folder.parts("killed") == whole, "the parts differ");
    let again = folder.run("killed", count, &[]);
    assert!(again.contains(" 0 done"), "{again}");
    assert!(
        folder.parts("killed") == whole,
        "nothing was left to be done"
    );
}

#[test]
fn inv_shards_in_any_order_are_the_whole_campaign() {
    let folder = prepared("campaign-shards");
    let count = PART + 8;
    folder.run("whole", count, &[]);
    for (out, shard) in [("third", "3/3"), ("first", "1/3"), ("second", "2/3")] {
        folder.run(out, count, &["--shard", shard]);
        // The same folder for all of them will do as well.
        folder.run("shared", count, &["--shard", shard, "--threads", "1"]);
    }
    let whole = folder.summary(&["whole"]);
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    for folders in [
        &["first", "second", "third"][..],
        &["second", "third", "first"],
        &["shared"],
    ] {
        let merged = folder.summary(folders);
        assert_eq!(merged.status.code(), Some(0), "{}", stderr(&merged));
        assert_eq!(stdout(&merged), stdout(&whole), "{folders:?}");
    }
    let two = folder.summary(&["first", "third"]);
    assert_eq!(two.status.code(), Some(3));
    let two: serde_json::Value = serde_json::from_slice(&two.stdout).expect("it is JSON");
    assert_eq!(
        two["missing_seeds"],
        serde_json::json!([[count / 3 + 1, 2 * count / 3]])
    );
    let twice = folder.summary(&["shared", "second"]);
    assert_eq!(twice.status.code(), Some(1));
    let said = stderr(&twice);
    assert!(said.contains("shared") && said.contains("second"), "{said}");
}

#[test]
fn prop_a_folder_of_another_plan_is_refused_with_the_difference() {
    let folder = prepared("campaign-other");
    folder.run("out", 3, &[]);
    let before = folder.parts("out");
    std::fs::write(folder.join("plan.toml"), PLAN.replace("200.0", "250.0"))
        .expect("it can be written");
    let run = ["run", "--plan", "plan.toml", "--count", "3", "--out", "out"];
    let refusals = [folder.campaign(&run), {
        // The parts know it, too.
        std::fs::remove_file(folder.join("out/plan.toml")).expect("it is there");
        folder.campaign(&run)
    }];
    for refused in refusals {
        assert_eq!(refused.status.code(), Some(1));
        let said = stderr(&refused);
        assert!(
            said.contains("sample_rate_hz: 200.0 there, 250.0 here"),
            "{said}"
        );
    }
    assert!(folder.parts("out") == before, "nothing was touched");
}

#[test]
fn prop_a_damaged_part_is_named_set_aside_and_done_again() {
    let folder = prepared_without_joint("campaign-damaged");
    let count = PART + 5;
    folder.run("out", count, &[]);
    let whole = folder.parts("out");
    let (first, second) = (&whole[0], &whole[1]);
    let path = |name: &str| folder.join("out").join(name);
    std::fs::write(path(&first.0), &first.1[..first.1.len() / 2]).expect("it can be written");
    let mut flipped = second.1.clone();
    // In the values, where the format itself would not notice; one of them may fall on a byte that says nothing.
    for share in [5, 4, 3] {
        let place = flipped.len() / share;
        flipped[place] ^= 1;
    }
    std::fs::write(path(&second.0), &flipped).expect("it can be written");
    let refused = folder.summary(&["out"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(stderr(&refused).contains(&first.0), "{}", stderr(&refused));
    let said = folder.run("out", count, &[]);
    for (name, _) in [first, second] {
        assert!(said.contains(name), "{said}");
        assert!(path(&format!("{name}.damaged-1")).exists(), "it is kept");
    }
    assert!(folder.parts("out") == whole, "the parts differ");
}

#[test]
fn prop_refusals_say_what_would_be_right() {
    let folder = prepared("campaign-refusals");
    for (arguments, code, words) in [
        (
            &[
                "run",
                "--plan",
                "plan.toml",
                "--count",
                "3",
                "--out",
                "o",
                "--shard",
                "4/3",
            ][..],
            2,
            "3/16",
        ),
        (
            &["run", "--plan", "none.toml", "--count", "3", "--out", "o"],
            1,
            "none.toml",
        ),
        (
            &["run", "--plan", "plan.toml", "--count", "0", "--out", "o"],
            2,
            "--count",
        ),
        (
            &[
                "run",
                "--plan",
                "plan.toml",
                "--first-seed",
                "9223372036854775807",
                "--count",
                "2",
                "--out",
                "o",
            ],
            1,
            "go beyond",
        ),
        (&["summary", "."], 1, "no parts"),
        (&["summary", "nowhere"], 1, "nowhere"),
    ] {
        let refused = folder.campaign(arguments);
        assert_eq!(refused.status.code(), Some(code), "{arguments:?}");
        let said = stderr(&refused);
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn prop_the_table_has_all_parameters() {
    let folder = prepared("campaign-table");
    folder.run("out", 5, &[]);
    let table = folder.campaign(&["summary", "out"]);
    assert_eq!(table.status.code(), Some(0));
    let said = stdout(&table);
    assert!(
        said.starts_with("5 cases of seeds 1 to 5: 5 calibrated"),
        "{said}"
    );
    for name in ["d1", "d9", "s1/m", "s9/m", "I1/m", "I6/m", "k/m"] {
        assert!(
            said.lines().any(|line| line.starts_with(name)),
            "{name}: {said}"
        );
    }
}

#[test]
fn prop_seeds_that_nobody_asked_for_are_told() {
    let folder = prepared("campaign-gap");
    folder.run("first", 3, &[]);
    folder.run("second", 2, &["--first-seed", "10"]);
    let said = stdout(&folder.campaign(&["summary", "second", "first"]));
    assert!(
        said.starts_with("5 cases of seeds 1 to 11, without 4 to 9, which nobody asked for: 5"),
        "{said}"
    );
}

#[test]
fn neg_more_threads_than_can_be_started_are_refused() {
    for command in [
        &["campaign", "run", "--count", "1", "--out", "c"][..],
        &["report"],
    ] {
        let arguments = [command, &["--threads", "4294967296"]].concat();
        assert_eq!(crate::program::code(&crate::program::run(&arguments)), 2);
    }
}

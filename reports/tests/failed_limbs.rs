//! `sixaxis decouple --failed` as a user meets it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use sixaxis_calibration::calibration::Calibration;
use sixaxis_calibration::verdict::Grade;

/// By how much the answer may move, over its peak: a coarse bound, chosen and not measured.
const APART: f64 = 0.1;

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sixaxis"))
        .args(arguments)
        .output()
        .expect("starts")
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path of plain letters")
}

/// A calibration and a stream of rows, from a simulated session.
fn session() -> (PathBuf, PathBuf) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("failed_limbs");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("makes a folder");
    let simulated = run(&["simulate", "--out", text(&folder), "--seed", "3"]);
    assert!(simulated.status.success(), "{}", errors(&simulated));
    let calibration = folder.join("calibration.json");
    let toml = folder.join("session.toml");
    run(&["calibrate", text(&toml), "--out", text(&calibration)]);
    let mut known = Calibration::read(&calibration).expect("a calibration");
    known.verdict = Grade::Good;
    known.write(&calibration).expect("writes");
    let compound = std::fs::read_dir(&folder)
        .expect("lists")
        .map(|entry| entry.expect("an entry").path())
        .find(|path| text(path).contains("compound-03") || text(path).contains("compound_03"));
    let compound = compound.unwrap_or_else(|| {
        let mut all: Vec<PathBuf> = std::fs::read_dir(&folder)
            .expect("lists")
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| text(path).contains("compound"))
            .collect();
        all.sort();
        all.pop().expect("a compound run")
    });
    (calibration, compound)
}

/// The accelerations of a table of rows.
fn accelerations(path: &Path) -> Vec<[f64; 6]> {
    let text = std::fs::read_to_string(path).expect("reads");
    text.lines()
        .filter_map(|line| {
            let numbers: Vec<f64> = line.split(',').filter_map(|n| n.parse().ok()).collect();
            numbers.get(1..7).map(|six| six.try_into().expect("six"))
        })
        .collect()
}

#[test]
fn limbs_are_done_without() {
    let (calibration, compound) = session();
    let toml = calibration.with_file_name("session.toml");
    let out = |name: &str| calibration.with_file_name(name);
    let decouple = |to: &Path, more: &[&str]| {
        let mut arguments = vec![
            "decouple",
            text(&calibration),
            text(&compound),
            "--session",
            text(&toml),
            "--out",
            text(to),
        ];
        arguments.extend(more);
        run(&arguments)
    };
    let healthy = decouple(&out("healthy.csv"), &[]);
    assert!(healthy.status.success(), "{}", errors(&healthy));
    let reduced = decouple(&out("reduced.csv"), &["--failed", "2,5", "--json"]);
    assert!(reduced.status.success(), "{}", errors(&reduced));
    assert!(errors(&reduced).contains("note: without limbs 2 and 5"));
    let said = String::from_utf8_lossy(&reduced.stdout).into_owned();
    let summary: serde_json::Value = serde_json::from_str(&said).expect("JSON");
    assert_eq!(summary["failed_limbs"], serde_json::json!([2, 5]));

    let (a, b) = (
        accelerations(&out("healthy.csv")),
        accelerations(&out("reduced.csv")),
    );
    assert_eq!(a.len(), b.len());
    assert!(a != b, "limbs 2 and 5 were listened to all the same");
    for half in [0..3, 3..6] {
        let size = |f: &dyn Fn(usize, usize) -> f64| {
            let each = (0..a.len()).flat_map(|i| half.clone().map(move |axis| (i, axis)));
            each.map(|(i, axis)| f(i, axis).abs()).fold(0.0, f64::max)
        };
        let apart = size(&|i, axis| a[i][axis] - b[i][axis]) / size(&|i, axis| a[i][axis]);
        assert!(apart < APART, "{half:?}: {apart}");
    }

    let lost = decouple(&out("lost.csv"), &["--failed", "2,4"]);
    assert_eq!(lost.status.code(), Some(1));
    assert!(
        errors(&lost).contains("limbs 2 and 4 failed: of a force along y - z"),
        "{}",
        errors(&lost)
    );
    assert!(!out("lost.csv").exists());
    for (limbs, why) in [("10", "a number from 1 to 9"), ("1,2,3,5", "at most three")] {
        let refused = decouple(&out("refused.csv"), &["--failed", limbs]);
        assert_eq!(refused.status.code(), Some(1), "{limbs}");
        assert!(errors(&refused).contains(why), "{}", errors(&refused));
    }
    let refused = decouple(&out("refused.csv"), &["--failed", "2", "--close"]);
    assert_eq!(refused.status.code(), Some(2), "{}", errors(&refused));
}

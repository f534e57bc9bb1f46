//! What is wrong is named, and nothing is half written.

use std::process::Stdio;
use std::time::{Duration, Instant};

use sixaxis_calibration::calibration::Calibration;
use sixaxis_calibration::report::Grade;

use super::session::{LIMBS, calibration, voltages, write};
use crate::program::{Folder, run, sixaxis, stderr, text};

#[test]
fn inv_what_is_wrong_is_named() {
    let folder = Folder::new("decouple-wrong");
    let calibration = calibration();
    let (volts, rate_hz) = voltages();
    let recording = folder.join("run.npz");
    let out = folder.join("out.csv");
    let decouple = |more: &[&str]| {
        let first = [
            "decouple",
            &calibration,
            text(&recording),
            "--out",
            text(&out),
        ];
        run(&[&first[..], &["--gain", "0.1"], more].concat())
    };
    // Not a number.
    let mut broken = volts.clone();
    broken[4][321] = f64::NAN;
    write(&recording, &LIMBS, "V", &broken, rate_hz);
    let refused = decouple(&[]);
    assert_eq!(refused.status.code(), Some(1));
    let said = stderr(&refused);
    for word in ["run.npz", "\"u5\"", "sample 321", "not a finite number"] {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert!(!out.exists());
    // At the limit of the converter: a warning.
    let mut clipped = volts.clone();
    clipped[2][100..107].fill(10.0);
    write(&recording, &LIMBS, "V", &clipped, rate_hz);
    let warned = decouple(&[]);
    assert!(warned.status.success());
    assert!(stderr(&warned).contains("7 of u3"), "{}", stderr(&warned));
    // Gains that nobody says.
    write(&recording, &LIMBS, "V", &volts, rate_hz);
    std::fs::remove_file(&out).expect("the result of before");
    let refused = run(&[
        "decouple",
        &calibration,
        text(&recording),
        "--out",
        text(&out),
    ]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(
        stderr(&refused).contains("give --gain"),
        "{}",
        stderr(&refused)
    );
    assert!(!out.exists());
    assert!(decouple(&[]).status.success());
    // The recording itself is no place for the result; --rate may not contradict the file.
    let itself = run(&[
        "decouple",
        &calibration,
        text(&recording),
        "--out",
        text(&recording),
    ]);
    assert_eq!(itself.status.code(), Some(1));
    assert_eq!(decouple(&["--rate", "123"]).status.code(), Some(1));
    // Headings without rows leave the earlier result as it is.
    let before = std::fs::read(&out).expect("the result");
    write(&recording, &LIMBS, "V", &vec![Vec::new(); 9], rate_hz);
    for more in [&[][..], &["--watch"], &["--rest-to-rest"]] {
        let refused = decouple(more);
        assert_eq!(refused.status.code(), Some(1), "{more:?}");
        assert!(stderr(&refused).contains("run.npz"), "{}", stderr(&refused));
        assert!(std::fs::read(&out).expect("the result") == before);
    }
    // Names that are not the calibration's.
    let others: Vec<String> = (1..=9).map(|k| format!("ch{k}")).collect();
    let others: Vec<&str> = others.iter().map(String::as_str).collect();
    write(&recording, &others, "V", &volts, rate_hz);
    let refused = decouple(&[]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(
        stderr(&refused).contains("--channels"),
        "{}",
        stderr(&refused)
    );
    assert!(
        decouple(&["--channels", &others.join(",")])
            .status
            .success()
    );
    // Nothing in the voltages says that all gains are of the wrong sign; the calibration does.
    write(&recording, &LIMBS, "V", &volts, rate_hz);
    assert!(!stderr(&decouple(&[])).contains("another sign"));
    let negative = run(&[
        "decouple",
        &calibration,
        text(&recording),
        "--gain=-0.1",
        "--out",
        text(&folder.join("negative.npy")),
    ]);
    let said = stderr(&negative);
    assert!(said.contains("all nine gains have another sign"), "{said}");
    // Of columns without names the command says them.
    assert!(
        said.contains("no names of its columns: time, ax, ay"),
        "{said}"
    );
    // A bad calibration.
    let bad = folder.join("bad.json");
    let mut judged = Calibration::read(calibration.as_ref()).expect("reads");
    judged.verdict = Grade::Bad;
    judged.write(&bad).expect("writes");
    let arguments = [
        "decouple",
        text(&bad),
        text(&recording),
        "--gain",
        "0.1",
        "--out",
        text(&out),
    ];
    assert_eq!(run(&arguments).status.code(), Some(1));
    let forced = run(&[&arguments[..], &["--force"]].concat());
    assert!(forced.status.success() && stderr(&forced).contains("do not trust"));
}

#[test]
fn inv_a_killed_run_leaves_the_old_result() {
    let folder = Folder::new("decouple-killed");
    let calibration = calibration();
    let (volts, rate_hz) = voltages();
    let long: Vec<Vec<f64>> = volts
        .iter()
        .map(|c| c.iter().map(|u| 0.01 * u).cycle().take(150_000).collect())
        .collect();
    let recording = folder.join("long.npz");
    write(&recording, &LIMBS, "V", &long, rate_hz);
    let out = folder.join("out.parquet");
    let start = || {
        sixaxis()
            .args([
                "decouple",
                &calibration,
                text(&recording),
                "--gain",
                "0.01",
                "--out",
            ])
            .arg(&out)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("starts")
    };
    let started = Instant::now();
    assert!(start().wait().expect("ends").success());
    let whole = started.elapsed();
    let good = std::fs::read(&out).expect("a result");
    let old = b"the old result";
    let mut killed = 0;
    for round in 0..20_u32 {
        std::fs::write(&out, old).expect("writes");
        let mut child = start();
        // Spread over the whole run, in no order; the last ones may come too late.
        let share = f64::from(round * 7 % 20) / 19.0;
        std::thread::sleep(whole.mul_f64(share).max(Duration::from_millis(1)));
        let _ = child.kill();
        killed += u32::from(!child.wait().expect("ends").success());
        let found = std::fs::read(&out).expect("old or new");
        assert!(
            found == old || found == good,
            "round {round}: half a result"
        );
    }
    assert!(killed >= 10, "{killed} of 20 were killed in time");
}

//! `--excluded`: what a lost channel says is not looked at, and sets that cannot be done without are refused.

use super::session::{
    ACCELERATIONS, LIMBS, calibration, columns, compound, session, voltages, write,
};
use crate::program::{Folder, code, done, fed, run, stderr, stdout, text};

/// Largest difference from the healthy answer over its peak: the parameters are a laboratory's, which the rows of the healthy
/// limbs do not fit exactly.
const WITHIN: f64 = 0.1;

#[test]
fn ref_a_lost_channel_is_not_missed() {
    let folder = Folder::new("decouple-failed");
    let (mut volts, rate_hz) = voltages();
    // Half of the time nothing, half of the time no number.
    let lost = &mut volts[4];
    let half = lost.len() / 2;
    lost[..half].fill(f64::NAN);
    lost[half..].fill(7.0);
    let broken = folder.join("compound-03.npz");
    write(&broken, &LIMBS, "V", &volts, rate_hz);
    let toml = session().join("session.toml");
    let calibration = calibration();
    let decouple = |recording: &str, name: &str, more: &[&str]| {
        let out = folder.file(name);
        let arguments = ["decouple", &calibration, recording, "--out", &out];
        done(&[&arguments[..], more].concat());
        columns(out.as_ref(), &ACCELERATIONS).0
    };
    let toml = ["--session", text(&toml)];
    let healthy = decouple(text(&compound()), "healthy.parquet", &toml);
    let gains = done(
        &[
            &["decouple", &calibration, text(&compound()), "--json"],
            &toml[..],
            &["--out", &folder.file("json.parquet")],
        ]
        .concat(),
    );
    let summary: serde_json::Value = serde_json::from_str(&stdout(&gains)).expect("JSON");
    let list = |key: &str| -> String {
        let values = summary[key].as_array().expect("numbers");
        let texts: Vec<String> = values.iter().map(ToString::to_string).collect();
        texts.join(",")
    };
    let (gain, down) = (list("gain_n_per_v"), list("gravity_ground_m_s2"));
    let settings = ["--gain", &gain, "--down", &down, "--excluded", "5"];
    let without = decouple(text(&broken), "without.parquet", &settings);
    assert!(healthy != without, "limb 5 was listened to all the same");
    for (healthy, without) in healthy.iter().zip(&without) {
        let peak = healthy.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let apart = healthy.iter().zip(without);
        let apart = apart.fold(0.0_f64, |a, (x, y)| a.max((x - y).abs()));
        assert!(apart < WITHIN * peak, "{apart} of {peak}");
    }
    // With the channel that is lost it cannot be done.
    let refused = run(&["decouple", &calibration, text(&broken), "--gain", &gain]);
    assert_eq!(code(&refused), 1);
    // Another limb's failure does not help.
    let refused = run(&[
        "decouple",
        &calibration,
        text(&broken),
        "--gain",
        &gain,
        "--excluded",
        "3",
    ]);
    assert!(stderr(&refused).contains("\"u5\""), "{}", stderr(&refused));
}

#[test]
fn inv_sets_that_cannot_be_done_without_are_refused() {
    let folder = Folder::new("decouple-failed-refused");
    let out = folder.file("out.csv");
    for (failed, said) in [
        (
            "2,4",
            "limbs 2 and 4 excluded: the remaining limbs cannot observe a force along",
        ),
        ("1,2,3", "limbs 1, 2 and 3 excluded"),
        ("1,2,3,4", "at most three"),
    ] {
        let refused = run(&[
            "decouple",
            &calibration(),
            text(&compound()),
            "--gain",
            "0.01",
            "--excluded",
            failed,
            "--out",
            &out,
        ]);
        assert_eq!(code(&refused), 1, "{failed}");
        assert!(stderr(&refused).contains(said), "{}", stderr(&refused));
        assert!(!folder.join("out.csv").exists());
    }
}

#[test]
fn neg_limbs_are_numbers_that_stand_there_once() {
    for (wrong, said) in [
        ("1,1", "limb 1 stands there twice"),
        ("5,x", "\"x\" is no limb's number"),
        ("5,", "\"\" is no limb's number"),
        ("10", "10"),
    ] {
        let refused = run(&["decouple", &calibration(), "none.csv", "--excluded", wrong]);
        assert_eq!(code(&refused), 2, "{wrong}");
        assert!(stderr(&refused).contains(said), "{}", stderr(&refused));
    }
}

#[test]
fn inv_a_stream_does_not_read_a_lost_channel() {
    let lost = ["0", "nan", "broken", "-inf"];
    let rows = lost.map(|lost| format!("0,0.1,0,0,{lost},0.1,0,0,{lost}\n"));
    let (calibration, gain) = (calibration(), ["--gain", "0.01"]);
    let decouple = ["decouple", &calibration, "-", "--rate", "1000"];
    let ended = fed(
        &[&decouple[..], &gain, &["--excluded", "5 , 9"]].concat(),
        &rows.concat(),
    );
    assert_eq!(code(&ended), 0, "{}", stderr(&ended));
    assert_eq!(stdout(&ended).lines().count(), 3);
    assert!(stderr(&ended).contains("note: without limbs 5 and 9"));
}

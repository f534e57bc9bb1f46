//! What a session says is honoured or refused, and another sensor's session is no session.

use super::session::{
    ACCELERATIONS, LIMBS, apart, calibration, columns, compound, session, voltages, write,
};
use crate::program::{Folder, done, run, stderr, text};

/// The session's file with something in it replaced, in a folder of its own.
fn session_with(folder: &Folder, name: &str, from: &str, to: &str) -> String {
    let toml = std::fs::read_to_string(session().join("session.toml")).expect("a session");
    assert!(toml.contains(from), "the session has no {from:?}");
    let path = folder.join(name);
    std::fs::write(&path, toml.replacen(from, to, 1)).expect("writes");
    text(&path).to_owned()
}

#[test]
fn inv_another_sensor_s_session_is_refused() {
    let folder = Folder::new("decouple-guards-sensor");
    let (calibration, recording) = (calibration(), compound());
    for (name, from, to, words) in [
        (
            "serial",
            "simulated-3",
            "B-17",
            ["\"B-17\"", "\"simulated-3\""],
        ),
        (
            "drawing",
            "half_edge_mm = 21",
            "half_edge_mm = 22",
            ["half_edge_mm is 22", "with 21"],
        ),
    ] {
        let toml = session_with(&folder, &format!("{name}.toml"), from, to);
        let out = folder.join("out.csv");
        let arguments = [
            "decouple",
            &calibration,
            text(&recording),
            "--session",
            &toml,
        ];
        let refused = run(&[&arguments[..], &["--out", text(&out)]].concat());
        assert_eq!(refused.status.code(), Some(1), "{name}");
        for word in words {
            assert!(
                stderr(&refused).contains(word),
                "{word}: {}",
                stderr(&refused)
            );
        }
        assert!(!out.exists());
    }
}

#[test]
fn inv_conditioning_of_a_session_is_honoured_or_refused() {
    // While the run is still at rest: in motion the window holds a slope, which counts as scatter.
    const WILD: usize = 20;
    let folder = Folder::new("decouple-guards-conditioning");
    let calibration = calibration();
    let recording = folder.join(compound().file_name().expect("a name"));
    let decouple = |toml: &str, out: &str, more: &[&str]| {
        let out = folder.join(out);
        let first = [
            "decouple",
            &calibration,
            text(&recording),
            "--session",
            toml,
        ];
        let output = run(&[&first[..], &["--out", text(&out)], more].concat());
        (output, out)
    };
    let (mut volts, rate_hz) = voltages();
    write(&recording, &LIMBS, "V", &volts, rate_hz);
    let stages = |name: &str, stage: &str, settings: &str| {
        let off = format!("{stage} = false");
        session_with(&folder, name, &off, &format!("{stage} = {settings}"))
    };
    let plain = text(&session().join("session.toml")).to_owned();
    let rejecting = stages(
        "outliers.toml",
        "outliers",
        "{ half_width = 10, sigmas = 20.0 }",
    );
    let (_, sound) = decouple(&rejecting, "sound.parquet", &[]);
    let sound = columns(&sound, &ACCELERATIONS).0;
    // One wild sample.
    volts[4][WILD] += 3.0;
    write(&recording, &LIMBS, "V", &volts, rate_hz);
    let (_, kept) = decouple(&plain, "kept.parquet", &[]);
    let (_, mended) = decouple(&rejecting, "mended.parquet", &[]);
    let off = |path| apart(&columns(path, &ACCELERATIONS).0, &sound);
    let (kept, mended) = (off(&kept), off(&mended));
    assert!(mended < 1e-3 && kept > 0.03, "{mended:e} and {kept:e}");
    // The monitor sees the channels as they are.
    let (watched, _) = decouple(&rejecting, "watched.parquet", &["--watch"]);
    assert!(
        stderr(&watched).contains("outliers are not replaced"),
        "{}",
        stderr(&watched)
    );
    // A trend is known only when the run is over.
    let trend = stages("trend.toml", "detrend", "{ rest_s = 0.2 }");
    let (refused, out) = decouple(&trend, "trend.parquet", &[]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(
        stderr(&refused).contains("preprocessing.detrend"),
        "{}",
        stderr(&refused)
    );
    assert!(!out.exists());
    let first = [
        "decouple",
        &calibration,
        text(&recording),
        "--session",
        &trend,
    ];
    done(&[&first[..], &["--rest-to-rest", "--out", text(&out)]].concat());
}

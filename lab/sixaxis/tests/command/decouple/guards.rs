//! What a session says is honoured or refused, and another sensor's session is no session.

use std::path::Path;

use sixaxis_calibration::calibration::Calibration;

use super::session::{
    ACCELERATIONS, LIMBS, apart, calibration, columns, compound, session, voltages, write,
};
use crate::program::{Folder, done, fed, run, stderr, text};

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

/// What is said of sums of forces that do not add up.
const BROKEN_SUMS: &str = "limb forces that add up to zero in any motion do not";

#[test]
fn inv_limb_forces_that_do_not_add_up_are_named() {
    let folder = Folder::new("decouple-guards-sums");
    let healthy = calibration();
    let session = text(&session().join("session.toml")).to_owned();
    let recording = folder.join(compound().file_name().expect("a name"));
    let (volts, rate_hz) = voltages();
    let told = |volts: &[Vec<f64>], calibration: &str, more: &[&str]| {
        write(&recording, &LIMBS, "V", volts, rate_hz);
        let out = folder.file("out.parquet");
        let first = ["decouple", calibration, text(&recording), "--out", &out];
        run(&[&first[..], &["--session", &session], more].concat())
    };
    let said = |volts: &[Vec<f64>], calibration: &str, more: &[&str]| {
        let output = told(volts, calibration, more);
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    let sound = said(&volts, &healthy, &[]);
    assert!(!sound.contains(BROKEN_SUMS), "{sound}");
    // Nothing but noise adds up to noise.
    let still: Vec<Vec<f64>> = (0..9)
        .map(|limb| {
            let noise = (0..20_000_u32).map(|k| (k * 7919 + limb * 104_729) % 1013);
            noise.map(|k| 1e-5 * f64::from(k)).collect()
        })
        .collect();
    let sound = said(&still, &healthy, &[]);
    assert!(!sound.contains(BROKEN_SUMS), "{sound}");
    // Limbs unequal by a few percent look like this to a calibration that takes them for equal, sensitivities that have changed by a
    // percent to one that knows how unequal they are.
    let mut equal = Calibration::read(healthy.as_ref()).expect("a calibration");
    assert!(equal.limbs.is_some());
    equal.limbs = None;
    let path = folder.join("equal.json");
    equal.write(&path).expect("writes");
    for (calibration, share) in [(text(&path), 0.03), (&healthy, 0.01)] {
        let mut unequal = volts.clone();
        for (limb, column) in unequal.iter_mut().enumerate() {
            let gain = 1.0 + share * f64::from(limb as i32 % 3 - 1);
            column.iter_mut().for_each(|u| *u *= gain);
        }
        let sound = said(&unequal, calibration, &[]);
        assert!(!sound.contains(BROKEN_SUMS), "{sound}");
    }
    // Each channel in turn in another range.
    for limb in 0..9 {
        let mut halved = volts.clone();
        halved[limb].iter_mut().for_each(|u| *u *= 0.5);
        let said = said(&halved, &healthy, &[]);
        assert!(said.contains(BROKEN_SUMS), "{limb}: {said}");
    }
    let mut swapped = volts.clone();
    swapped.swap(0, 5);
    let mut dead = volts.clone();
    dead[0].fill(0.02);
    let mut inverted = volts.clone();
    inverted[8].iter_mut().for_each(|u| *u = -*u);
    for (name, broken) in [
        ("swapped", &swapped),
        ("dead", &dead),
        ("inverted", &inverted),
    ] {
        for more in [&[][..], &["--rest-to-rest"]] {
            // Also where the rate of these has run away, which is another day's luck.
            let said = stderr(&told(broken, &healthy, more));
            assert!(said.contains(BROKEN_SUMS), "{name}: {said}");
        }
    }
    // Where the rate runs away before a first row, the sums say why.
    let mut swapped = volts.clone();
    swapped.swap(0, 1);
    let away = stderr(&told(&swapped, &healthy, &["--rest-to-rest"]));
    assert!(away.contains("has run away"), "{away}");
    assert!(away.contains(BROKEN_SUMS), "{away}");
    // A sum with a limb that is not read says nothing.
    let excluded = said(&dead, &healthy, &["--excluded", "1"]);
    assert!(!excluded.contains(BROKEN_SUMS), "{excluded}");
    // A sensor of the same drawing with other limbs.
    let mut another = Calibration::read(healthy.as_ref()).expect("a calibration");
    for (limb, scale) in another
        .parameters
        .scale_per_mass_per_kg
        .iter_mut()
        .enumerate()
    {
        *scale *= 1.0 + 0.3 * f64::from(limb as i32 % 3 - 1);
    }
    let path = folder.join("another.json");
    another.write(&path).expect("writes");
    let said = said(&volts, text(&path), &[]);
    assert!(said.contains(BROKEN_SUMS), "{said}");
}

#[test]
fn inv_a_stream_is_told_of_broken_sums_before_it_ends() {
    let (volts, rate_hz) = voltages();
    let mut rows = String::new();
    // Twice the run, to be long enough for a verdict before the end.
    for k in (0..volts[0].len()).chain(0..volts[0].len()) {
        let mut row: Vec<String> = volts.iter().map(|column| column[k].to_string()).collect();
        row.swap(0, 5);
        rows += &(row.join(",") + "\n");
    }
    let (rate, calibration) = (rate_hz.to_string(), calibration());
    let decouple = ["decouple", &calibration, "-", "--gain", "0.1", "--rate"];
    let said = stderr(&fed(&[&decouple[..], &[&rate]].concat(), &rows));
    assert!(said.contains(&format!("{BROKEN_SUMS}: limbs")), "{said}");
    assert!(said.contains("warning: standard input, line "), "{said}");
    assert_eq!(said.matches(BROKEN_SUMS).count(), 1, "{said}");
}

/// Below the converter's limit, which is told by itself.
#[test]
fn inv_an_amplifier_at_its_end_is_told() {
    let folder = Folder::new("decouple-guards-amplifier");
    let (mut volts, rate_hz) = voltages();
    let path = folder.join("run.csv");
    let decouple = |volts: &[Vec<f64>]| {
        write(&path, &LIMBS, "V", volts, rate_hz);
        let out = folder.file("out.csv");
        let first = ["decouple", &calibration(), text(&path), "--out", &out];
        stderr(&done(&[&first[..], &["--gain", "0.1"]].concat()))
    };
    let sound = decouple(&volts);
    assert!(!sound.contains("crests are cut off"), "{sound}");
    let highest_v = volts[6].iter().fold(0.0_f64, |high, u| high.max(*u));
    volts[6]
        .iter_mut()
        .for_each(|u| *u = u.min(0.8 * highest_v));
    let cut = decouple(&volts);
    let told = cut.lines().find(|line| line.contains("crests are cut off"));
    let told = told.unwrap_or_else(|| panic!("{cut}"));
    let named = LIMBS.map(|name| told.contains(&format!("{name} at ")));
    assert_eq!(named, core::array::from_fn(|limb| limb == 6), "{told}");
}

#[test]
fn inv_a_recording_that_was_cut_short_is_told() {
    let folder = Folder::new("decouple-guards-cut");
    let (volts, rate_hz) = voltages();
    let path = folder.join("run.tdms");
    write(&path, &LIMBS, "V", &volts, rate_hz);
    let decouple = |out: &str| {
        let out = folder.file(out);
        let first = ["decouple", &calibration(), text(&path), "--out", &out];
        stderr(&done(&[&first[..], &["--gain", "0.1"]].concat()))
    };
    assert!(!decouple("whole.csv").contains("cut short"));
    let bytes = std::fs::read(&path).expect("a recording");
    std::fs::write(&path, &bytes[..bytes.len() - 800]).expect("a shorter one");
    let said = decouple("cut.csv");
    let words = format!("warning: {}: its last segment is cut short", text(&path));
    assert!(said.contains(&words), "{said}");
    // A result that was cut is compared up to there.
    let (whole, cut) = (folder.file("whole.csv"), folder.file("broken.csv"));
    let rows = std::fs::read(&whole).expect("a result");
    std::fs::write(&cut, &rows[..rows.len() - 40]).expect("a shorter one");
    let page = folder.file("page.html");
    let said = stderr(&done(&["compare", &cut, &whole, "--out", &page]));
    let words = format!("warning: {cut}: its last line breaks off");
    assert!(said.contains(&words), "{said}");
}

#[test]
fn inv_a_high_pass_that_is_undone_is_told() {
    let folder = Folder::new("decouple-guards-high-pass");
    let (with, out) = (folder.join("high-pass.json"), folder.file("out.csv"));
    let mut known = Calibration::read(Path::new(&calibration())).expect("a calibration");
    known.sensor.amplifier_high_pass_hz = Some(0.1);
    known.write(&with).expect("writes");
    let said = |calibration: &str| {
        let recording = compound();
        let arguments = ["decouple", calibration, text(&recording), "--gain", "0.1"];
        stderr(&done(&[&arguments[..], &["--out", &out]].concat()))
    };
    // The root of 16 over the corner in rad/s.
    let words = "high-pass of 0.1 Hz is undone about the level at rest, whose noise becomes a ramp: as large as a channel's noise after 6 s";
    let undone = said(text(&with));
    assert!(undone.contains(words), "{undone}");
    assert!(!said(&calibration()).contains("high-pass"));
}

#[test]
fn inv_names_and_units_can_be_stated() {
    const NAMES: [&str; 9] = ["a", "b", "c", "d", "e", "f", "g", "h", "i"];
    let folder = Folder::new("decouple-guards-names");
    let (volts, rate_hz) = voltages();
    let (plain, other) = (folder.join("plain.npz"), folder.join("other.csv"));
    write(&plain, &LIMBS, "V", &volts, rate_hz);
    let mut text_of = format!("# sample_rate_hz = {rate_hz}\n{}\n", NAMES.join(","));
    for k in 0..volts[0].len() {
        let row: Vec<String> = volts.iter().map(|u| (1e3 * u[k]).to_string()).collect();
        text_of += &(row.join(",") + "\n");
    }
    std::fs::write(&other, text_of).expect("writes");
    let names = NAMES.join(",");
    let stated = ["--channels", &names, "--unit", "mV"];
    let decouple = |path: &std::path::Path, out: &str, more: &[&str]| {
        let out = folder.join(out);
        let calibration = calibration();
        let first = ["decouple", &calibration, text(path), "--out", text(&out)];
        (run(&[&first[..], &["--gain", "0.1"], more].concat()), out)
    };
    let (_, expected) = decouple(&plain, "plain.parquet", &[]);
    let (_, found) = decouple(&other, "other.parquet", &stated);
    let off = apart(
        &columns(&found, &ACCELERATIONS).0,
        &columns(&expected, &ACCELERATIONS).0,
    );
    assert!(off < 1e-9, "{off:e}");
    let (refused, _) = decouple(&other, "refused.parquet", &stated[..2]);
    assert!(stderr(&refused).contains("--unit"), "{}", stderr(&refused));
    assert!(!stderr(&refused).contains("earlier run"));
    std::fs::write(folder.join("refused.parquet"), "that of yesterday").expect("writes");
    let (refused, out) = decouple(&plain, "refused.parquet", &["--unit", "mV"]);
    let said = stderr(&refused);
    assert!(said.contains("the file says \"V\""), "{said}");
    let words = format!("{} is from before", text(&out));
    assert!(said.contains(&words), "{said}");
    for (option, value) in [
        ("--unit", "g"),
        ("--channels", "a,b"),
        ("--channels", "a,b,c,d,e,f,g,h,h"),
    ] {
        assert_eq!(
            decouple(&other, "no.csv", &[option, value]).0.status.code(),
            Some(2)
        );
    }
    let inspect = |more: &[&str]| {
        let output = done(&[&["inspect", "--json", text(&other)], more].concat());
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        json["files"][0].clone()
    };
    assert!(inspect(&[])["sensor"].is_null());
    let file = inspect(&stated);
    assert_eq!(file["sensor"]["limbs"][8], "i");
    assert_eq!(
        file["groups"][0]["channels"][0]["unit"]["measures"],
        "voltage"
    );
}

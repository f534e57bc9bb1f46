//! `--uncertainty`: a standard deviation beside each acceleration.

use std::path::Path;

use sixaxis_calibration::calibration::Calibration;

use super::session::{ACCELERATIONS, calibration, columns, compound, session, write};
use crate::program::{Folder, done, run, stderr, text};

/// Rounding of a few thousand steps.
const TWICE: f64 = 1e-9;

/// What a sample's own noise gives it is turned into ground axes with and without aids alike; the attitude's part grows without.
#[test]
fn inv_a_samples_noise_is_of_the_grounds_axes_with_aids_too() {
    let folder = Folder::new("decouple-deviations-aided");
    let recording = compound();
    let toml = session().join("session.toml");
    let deviations = |name: &str, more: &[&str]| {
        let out = folder.join(name);
        let arguments = [
            "decouple",
            &calibration(),
            text(&recording),
            "--session",
            text(&toml),
            "--uncertainty",
            "--until-sd",
            "60",
            "--out",
            text(&out),
        ];
        done(&[&arguments[..], more].concat());
        columns(&out, &["sd_alpha_x", "sd_alpha_y", "sd_alpha_z"]).0
    };
    let open = deviations("open.parquet", &[]);
    let aided = deviations("aided.parquet", &["--aid", "rest"]);
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for (open, aided) in open.iter().flatten().zip(aided.iter().flatten()) {
        least = least.min(aided / open);
        most = most.max(aided / open);
    }
    assert!(least > 0.9 && most < 1.2, "{least} to {most} times");
}

/// Where a high-pass is undone deviations come from the filter that knows how zeros wander: with a corner at which they do not, in the
/// median as without, a low-pass or none; down, known to 0.1°, and second order make more of them at the end.
#[test]
fn inv_zeros_that_wander_are_in_the_deviations() {
    let folder = Folder::new("decouple-deviations-wander");
    let recording = compound();
    let deviations = |corner_hz: Option<f64>, low_pass: &[&str]| {
        let (with, out) = (folder.join("calibration.json"), folder.join("out.parquet"));
        let mut known = Calibration::read(Path::new(&calibration())).expect("a calibration");
        known.sensor.amplifier_high_pass_hz = corner_hz;
        known.write(&with).expect("writes");
        let arguments = [
            "decouple",
            text(&with),
            text(&recording),
            "--gain",
            "0.1",
            "--uncertainty",
            "--until-sd",
            "60",
            "--out",
            text(&out),
        ];
        done(&[&arguments[..], low_pass].concat());
        columns(
            &out,
            &["sd_alpha_x", "sd_alpha_y", "sd_alpha_z", "sd_attitude"],
        )
        .0
    };
    for low_pass in [&[][..], &["--low-pass", "100"]] {
        let none = deviations(None, low_pass);
        let still = deviations(Some(1e-6), low_pass);
        let pairs = none[..3].iter().flatten().zip(still[..3].iter().flatten());
        let mut ratios: Vec<f64> = pairs.map(|(none, still)| still / none).collect();
        ratios.sort_by(f64::total_cmp);
        let ratio = ratios[ratios.len() / 2];
        println!("{low_pass:?}: {ratio} times");
        assert!((0.9..1.15).contains(&ratio), "{low_pass:?}: {ratio} times");
    }
    let last = |corner_hz| {
        let attitude = &deviations(corner_hz, &[])[3];
        attitude.last().copied().expect("rows")
    };
    let (none, wandering) = (last(None), last(Some(0.1)));
    assert!(wandering > 1.4 * none, "{wandering} rad, {none} without");
}

/// Deviations know the calibration's noise: a recording of more of it is told, one of as much is not.
#[test]
fn neg_a_noisier_recording_is_told() {
    let folder = Folder::new("decouple-noisier");
    let names: Vec<String> = (1..=9).map(|limb| format!("u{limb}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let (still, rate_hz) = columns(&compound(), &names);
    let path = folder.join("compound-03.parquet");
    let session = std::fs::read_to_string(session().join("session.toml")).expect("reads");
    let (own, other) = (compound(), path.file_name().expect("a name"));
    let own = own.file_name().expect("a name").to_string_lossy();
    let toml = folder.write(
        "session.toml",
        session.replace(&*own, &other.to_string_lossy()),
    );
    let noise_v = Calibration::read(Path::new(&calibration())).expect("a calibration");
    let noise_v = noise_v.covariance.propagated.expect("it is there");
    let mut random = 1_u64;
    let mut unit = || {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        12.0_f64.sqrt() * ((random >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
    };
    for (times, channels, told) in [
        (0.0, 0..9, None),
        (1.0, 0..9, None),
        (5.0, 2..4, Some("channels 3, 4 have up to 5.")),
        (
            5.0,
            0..9,
            Some("channels 1, 2, 3, 4, 5, 6, 7, 8, 9 have up to 5."),
        ),
    ] {
        let mut louder = still.clone();
        for limb in channels {
            let size_v = times * noise_v.channel_noise_v[limb];
            louder[limb].iter_mut().for_each(|u| *u += size_v * unit());
        }
        write(&path, &names, "V", &louder, rate_hz.expect("a rate"));
        let out = folder.join("out.parquet");
        let said = run(&[
            "decouple",
            &calibration(),
            text(&path),
            "--session",
            &toml,
            "--out",
            text(&out),
        ]);
        let said = stderr(&said);
        let words = "times the white noise";
        match told {
            Some(told) => assert!(said.contains(told) && said.contains(words), "{said}"),
            None => assert!(!said.contains(words), "{said}"),
        }
    }
}

#[test]
fn inv_deviations_stand_beside_the_accelerations() {
    const DEVIATIONS: [&str; 6] = [
        "sd_ax",
        "sd_ay",
        "sd_az",
        "sd_alpha_x",
        "sd_alpha_y",
        "sd_alpha_z",
    ];
    let folder = Folder::new("decouple-deviations");
    let recording = compound();
    let toml = session().join("session.toml");
    let decouple = |calibration: &str, name: &str, more: &[&str]| {
        let out = folder.join(name);
        let mut arguments = vec![
            "decouple",
            calibration,
            text(&recording),
            "--session",
            text(&toml),
            "--out",
            text(&out),
        ];
        arguments.extend(more);
        done(&arguments);
        out
    };
    let plain = decouple(&calibration(), "plain.parquet", &[]);
    let known = decouple(&calibration(), "known.parquet", &["--uncertainty"]);
    let short = ["--uncertainty", "--accelerations"];
    let short = decouple(&calibration(), "short.parquet", &short);
    assert_eq!(
        columns(&plain, &ACCELERATIONS).0,
        columns(&known, &ACCELERATIONS).0
    );
    let (deviations, _) = columns(&known, &DEVIATIONS);
    assert_eq!(deviations, columns(&short, &DEVIATIONS).0);
    let sound = |sd: &f64| sd.is_finite() && *sd > 0.0;
    assert!(deviations.iter().flatten().all(sound));

    // Noise of a sample is the larger part at first; a filter takes most of it off.
    let filtered = ["--uncertainty", "--low-pass", "30"];
    let filtered = decouple(&calibration(), "filtered.parquet", &filtered);
    let (quiet, _) = columns(&filtered, &DEVIATIONS);
    for (quiet, noisy) in quiet.iter().zip(&deviations) {
        assert!(quiet[0] < noisy[0]);
    }

    // Errors twice as large are known half as well.
    let path = folder.join("doubled.json");
    let mut doubled = Calibration::read(Path::new(&calibration())).expect("a calibration");
    let propagated = doubled.covariance.propagated.as_mut().expect("it is there");
    for table in [&mut propagated.noise, &mut propagated.standards] {
        table.iter_mut().flatten().for_each(|x| *x *= 4.0);
    }
    propagated
        .channel_noise_v
        .iter_mut()
        .for_each(|x| *x *= 2.0);
    doubled.write(&path).expect("writes");
    let twice = decouple(text(&path), "doubled.parquet", &["--uncertainty"]);
    let (twice, _) = columns(&twice, &DEVIATIONS);
    let pairs = twice.iter().flatten().zip(deviations.iter().flatten());
    for (twice, once) in pairs {
        assert!((twice / once / 2.0 - 1.0).abs() < TWICE, "{twice} {once}");
    }

    doubled.covariance.propagated = None;
    doubled.write(&path).expect("writes");
    let old = run(&[
        "decouple",
        text(&path),
        text(&recording),
        "--session",
        text(&toml),
        "--uncertainty",
    ]);
    assert!(stderr(&old).contains("calibrate again"), "{}", stderr(&old));
}

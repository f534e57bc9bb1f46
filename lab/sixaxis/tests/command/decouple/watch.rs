//! `--watch`: a limb dies in mid-run, is named and done without.

use std::ops::Range;
use std::path::Path;

use sixaxis_calibration::calibration::Calibration;
use sixaxis_panel::chain::{Beside, Chain, Choice};
use sixaxis_panel::columns::{COLUMNS, MOTION};
use sixaxis_panel::control::Stages;
use sixaxis_recordings::session::SessionFile;

use super::session::{
    BLOCKS_AND_SAMPLES, LIMBS, apart, calibration, columns, compound, session, voltages, write,
};
use crate::program::{Folder, done, run, stderr, text};

/// The limb that dies, from 0, and where in the run.
const LIMB: usize = 4;
const SHARE: f64 = 0.4;
/// Rounding to the 32 bits of the panel's charts.
const SHOWN: f64 = 1e-6;

#[test]
fn ref_a_limb_that_dies_is_named_and_done_without() {
    let folder = Folder::new("decouple-watch");
    let (toml, json) = (session().join("session.toml"), calibration());
    let known = Calibration::read(json.as_ref()).expect("a calibration");
    let sound = compound();
    let (mut volts, rate_hz) = voltages();
    let samples = volts[0].len();
    let onset = (SHARE * samples as f64) as usize;
    let zero = known.parameters.zero_drift_v[LIMB];
    volts[LIMB][onset..].fill(zero);
    let failed = folder.join(sound.file_name().expect("a name"));
    write(&failed, &LIMBS, "V", &volts, rate_hz);

    let out = |name: &str| folder.join(name);
    let decouple = |recording: &Path, out: &Path, watch: bool| {
        let mut arguments = vec!["decouple", &json, text(recording)];
        arguments.extend(["--session", text(&toml), "--out", text(out)]);
        if watch {
            arguments.push("--watch");
        }
        stderr(&done(&arguments))
    };
    // A sound run: nothing is said, and every row is the decoupler's own but for rounding.
    let names = [
        "ax", "ay", "az", "alpha_x", "alpha_y", "alpha_z", "wx", "wy", "wz",
    ];
    let (plain, watched) = (out("plain.csv"), out("watched.csv"));
    decouple(&sound, &plain, false);
    let said = decouple(&sound, &watched, true);
    assert!(!said.contains("limb"), "{said}");
    let (expected, _) = columns(&plain, &names);
    let apart = apart(&columns(&watched, &names).0, &expected);
    assert!(apart <= BLOCKS_AND_SAMPLES, "{apart:e}");
    // A limb dies.
    let survived = out("survived.csv");
    let said = decouple(&failed, &survived, true);
    assert!(said.contains("limb 5: "), "{said}");
    assert!(
        said.contains("decoded without limb 5 from sample"),
        "{said}"
    );
    let (flags, _) = columns(&survived, &["excluded_limbs", "suspected_limbs"]);
    assert!(flags[0][..onset - 2].iter().all(|&limbs| limbs == 0.0));
    let switched = flags[0]
        .iter()
        .position(|&limbs| limbs == 5.0)
        .expect("a row without limb 5");
    // What was done without does not break the sums of what is left.
    assert!(!said.contains("add up to zero"), "{said}");
    // The recording is decoded once more: no row has the failed limb in it, and none is doubted.
    assert!(switched <= onset && flags[1].iter().all(|&limbs| limbs == 0.0));
    // A channel that delivers no numbers is as good as dead, at once.
    volts[LIMB][onset..].fill(f64::NAN);
    let other = Folder::new("decouple-watch-silent");
    let silent = other.join(failed.file_name().expect("a name"));
    write(&silent, &LIMBS, "V", &volts, rate_hz);
    let unreadable = out("unreadable.csv");
    let said = decouple(&silent, &unreadable, true);
    assert!(said.contains("limb 5: "), "{said}");
    let (flags, _) = columns(&unreadable, &["excluded_limbs"]);
    let first = flags[0].iter().position(|&limbs| limbs == 5.0);
    assert!(first.is_some_and(|row| row <= onset), "{first:?}");
    // From there on the answers are those of the sound run but for the noise of one limb less; with the dead limb they are not.
    let blind = out("blind.csv");
    decouple(&failed, &blind, false);
    let rms = |path: &Path| {
        let (found, _) = columns(path, &names);
        let from = onset - 1;
        let share = |axis: usize| {
            let peak = expected[axis].iter().fold(0.0_f64, |a, x| a.max(x.abs()));
            let squares: f64 = found[axis][from..]
                .iter()
                .zip(&expected[axis][from..])
                .map(|(x, y)| ((x - y) / peak).powi(2))
                .sum();
            (squares / (samples - from) as f64).sqrt()
        };
        (0..names.len()).map(share).fold(0.0, f64::max)
    };
    let (with, without) = (rms(&survived), rms(&blind));
    assert!(with < 0.1 * without, "{with} {without}");
}

/// The monitor saw what the low-pass made of a channel: it took limb 4's death for another sensitivity of limb 2, and decoded on with limb 4.
#[test]
fn neg_a_low_pass_does_not_hide_which_limb_has_died() {
    const DEAD: usize = 3;
    let folder = Folder::new("decouple-watch-filtered");
    let (toml, json) = (session().join("session.toml"), calibration());
    let known = Calibration::read(json.as_ref()).expect("a calibration");
    let sound = compound();
    let name = sound.file_name().expect("a name");
    let (mut volts, rate_hz) = voltages();
    let samples = volts[0].len();
    let onset = (SHARE * samples as f64) as usize;
    let decouple = |recording: &Path, out: &Path, more: &[&str]| {
        let first = ["decouple", &json, text(recording), "--session", text(&toml)];
        let filtered = ["--low-pass", "30", "--out", text(out)];
        stderr(&done(&[&first[..], &filtered, more].concat()))
    };
    let names = [
        "ax", "ay", "az", "alpha_x", "alpha_y", "alpha_z", "wx", "wy", "wz",
    ];
    let plain = folder.join("plain.csv");
    decouple(&sound, &plain, &[]);
    let (expected, _) = columns(&plain, &names);
    // Nothing is said of a sound run, and every row is that without a monitor.
    let watched = folder.join("watched.csv");
    let said = decouple(&sound, &watched, &["--watch"]);
    assert!(!said.contains("limb"), "{said}");
    assert!(apart(&columns(&watched, &names).0, &expected) <= BLOCKS_AND_SAMPLES);
    for (kind, value) in [
        ("dead", known.parameters.zero_drift_v[DEAD]),
        ("unreadable", f64::NAN),
    ] {
        volts[DEAD][onset..].fill(value);
        let dying = Folder::new(&format!("decouple-watch-filtered-{kind}"));
        let failed = dying.join(name);
        write(&failed, &LIMBS, "V", &volts, rate_hz);
        let out = dying.join("out.csv");
        let said = decouple(&failed, &out, &["--watch"]);
        assert!(
            said.contains("limb 4: ") && said.contains("decoded without limb 4 from sample"),
            "{said}"
        );
        let (flags, _) = columns(&out, &["excluded_limbs", "suspected_limbs"]);
        // From as far before the failure as the filter carries it.
        let carried = (5.0 * rate_hz / 30.0).ceil() as usize;
        let without = |row: usize| flags[0][row] == 4.0;
        let first = (0..flags[0].len()).position(without).expect("a row");
        let expected_first = onset - carried - 1;
        assert!(first.abs_diff(expected_first) <= 8, "{kind}: {first}");
        assert!((first..flags[0].len()).all(without));
        assert!(flags[1].iter().all(|&limbs| limbs == 0.0));
        let (found, _) = columns(&out, &names);
        for (axis, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let peak = expected.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
            let off = found.iter().zip(expected).map(|(x, y)| (x - y).abs());
            let off = off.fold(0.0, f64::max) / peak;
            assert!(off < 0.1, "{kind}: {} by {off}", names[axis]);
        }
    }
}

/// In the panel a low-pass of 100 Hz is on unless it is switched off, and the monitor saw what it made of a channel.
#[test]
fn neg_the_panel_s_low_pass_does_not_hide_which_limb_has_died() {
    let (toml, json) = (session().join("session.toml"), calibration());
    let known = Calibration::read(json.as_ref()).expect("a calibration");
    let file = SessionFile::read(&toml).expect("a session");
    let entry = file.entry(&compound()).expect("an entry");
    let of_all = file.session.sensor.gain_n_per_v;
    let (volts, rate_hz) = voltages();
    let samples = 0..volts[0].len();
    let onset = (SHARE * volts[0].len() as f64) as usize;
    // What is shown of the motion, and what is said of the limbs.
    let shown = |watch: bool, failing: Option<(usize, f64)>| {
        let mut chain = Chain::idle();
        chain
            .condition(&Stages::default(), None, rate_hz)
            .expect("conditions");
        let choice = Choice {
            session: &file.session,
            calibration: Some(&known),
            gain_n_per_v: entry.gain_n_per_v.unwrap_or(of_all).each(),
            gravity_ground_m_s2: glam::DVec3::ZERO,
            direction: None,
            watch,
        };
        chain.restart(&choice).expect("begins");
        let mut motion = Vec::new();
        for sample in samples.clone() {
            let mut row = core::array::from_fn(|limb| volts[limb][sample]);
            if let Some((limb, value)) = failing
                && sample >= onset
            {
                row[limb] = value;
            }
            let mut cells = [f32::NAN; COLUMNS];
            chain.push(&row, Beside::default(), &mut cells);
            motion.extend(cells[MOTION].iter().map(|x| f64::from(*x)));
        }
        let flags = chain.flags();
        (
            motion,
            chain.messages().join("\n"),
            flags,
            chain.has_stopped(),
        )
    };
    let (plain, _, _, _) = shown(false, None);
    let (watched, said, flags, _) = shown(true, None);
    assert!(said.is_empty() && flags == [0.0; 2], "{said}");
    // Behind the low-pass, as without the monitor, but for the first sample, which has no motion.
    let given =
        |motion: &[f64]| -> Vec<f64> { motion.iter().copied().filter(|x| x.is_finite()).collect() };
    let apart = apart(&[given(&watched)], &[given(&plain)]);
    assert!(apart < SHOWN, "{apart:e}");
    for limb in 0..LIMBS.len() {
        for value in [known.parameters.zero_drift_v[limb], f64::NAN] {
            let (_, said, flags, has_stopped) = shown(true, Some((limb, value)));
            let named = said.contains(&format!("decoded without limb {} from", limb + 1));
            assert!(
                named && flags == [(limb + 1) as f64, 0.0],
                "limb {}, {value}: {flags:?}, {said}",
                limb + 1
            );
            assert!(!has_stopped, "{said}");
        }
    }
}

#[test]
fn prop_watch_is_refused_where_it_has_no_meaning() {
    let json = calibration();
    let stream = ["decouple", &json, "-", "--rate", "1000", "--gain", "0.01"];
    let refused = run(&[&stream[..], &["--watch", "--low-pass", "30"]].concat());
    assert_eq!(refused.status.code(), Some(1));
    assert!(
        stderr(&refused).contains("--watch with --low-pass, which reads a recording twice"),
        "{}",
        stderr(&refused)
    );
    let refused = run(&["decouple", "a.json", "b.csv", "--watch", "--rest-to-rest"]);
    assert!(!refused.status.success());
    assert!(
        stderr(&refused).contains("--rest-to-rest"),
        "{}",
        stderr(&refused)
    );
    let alone = run(&[
        "decouple",
        "a.json",
        "b.csv",
        "--false-alarms-per-hour",
        "2",
    ]);
    assert!(!alone.status.success());
}

/// A converter of sixteen bits ends a step below its range's end. What stands there is its own channel's fault, however few samples.
#[test]
fn neg_samples_at_the_converter_s_end_are_no_other_limb_s() {
    let folder = Folder::new("decouple-clipped");
    let (toml, json) = (session().join("session.toml"), calibration());
    let (mut volts, rate_hz) = voltages();
    let at = volts[0].len() / 2;
    for limb in [2, 3] {
        volts[limb][at..at + 10].fill(9.9997);
    }
    let clipped = folder.join(compound().file_name().expect("a name"));
    write(&clipped, &LIMBS, "V", &volts, rate_hz);
    let out = folder.join("out.csv");
    let arguments = ["decouple", &json, text(&clipped), "--session", text(&toml)];
    let arguments = [&arguments[..], &["--out", text(&out)]].concat();
    let said = stderr(&done(&arguments));
    assert!(said.contains("10 of u3, 10 of u4"), "{said}");
    let said = stderr(&done(&[&arguments[..], &["--watch"]].concat()));
    assert!(
        said.contains("limbs 3 and 4: no readable value since"),
        "{said}"
    );
    let named = said
        .lines()
        .filter(|line| line.contains(": no readable") || line.contains("limb "));
    assert_eq!(named.count(), 1, "{said}");
    // More channels than can be done without, one after another: the sensor was driven too hard.
    for (place, limb) in [0, 4, 5, 8].into_iter().enumerate() {
        let from = at + 20 * (place + 1);
        volts[limb][from..from + 10].fill(9.9997);
    }
    write(&clipped, &LIMBS, "V", &volts, rate_hz);
    let said = stderr(&done(&[&arguments[..], &["--watch"]].concat()));
    assert!(said.contains("at the converter's limit"), "{said}");
}

/// Samples at the converter's end of more limbs than can be done without are of a sensor that was driven too hard, wherever the file is cut into
/// blocks to be read; of those that are far apart each is a failure of its own, and no sound limb's.
#[test]
fn neg_the_converter_s_end_does_not_depend_on_blocks() {
    const SAMPLES: usize = 40_000;
    let folder = Folder::new("decouple-overdriven");
    let (toml, json) = (session().join("session.toml"), calibration());
    let (volts, rate_hz) = voltages();
    // From rest to rest, again and again.
    let repeated = |v: &Vec<f64>| v.iter().copied().cycle().take(SAMPLES).collect();
    let volts: Vec<Vec<f64>> = volts.iter().map(repeated).collect();
    let clipped = folder.join(compound().file_name().expect("a name"));
    let out = folder.join("out.csv");
    let said_of = |clips: &[(usize, Range<usize>)]| {
        let mut volts = volts.clone();
        for (limb, samples) in clips {
            volts[*limb][samples.clone()].fill(9.9997);
        }
        write(&clipped, &LIMBS, "V", &volts, rate_hz);
        let arguments = ["decouple", &json, text(&clipped), "--session", text(&toml)];
        stderr(&done(
            &[&arguments[..], &["--out", text(&out), "--watch"]].concat(),
        ))
    };
    let said = |clips: &[(usize, usize)]| {
        let short = clips.iter().map(|&(limb, at)| (limb, at..at + 3));
        said_of(&short.collect::<Vec<_>>())
    };
    for last in [16_370, 16_390] {
        let driven = said(&[(0, 16_350), (4, 16_360), (5, last)]);
        assert!(driven.contains("at the converter's limit"), "{driven}");
        assert!(
            driven.contains("sample 16350: the sensor is driven beyond"),
            "{driven}"
        );
        assert!(!driven.contains("decoded without"), "{last}: {driven}");
    }
    // Standing still is no failure there, nor is one that stays there excused by others that clip for a moment.
    let held = said_of(&[0, 4, 5].map(|limb| (limb, 16_000..16_200)));
    assert!(!held.contains("decoded without"), "{held}");
    let stays = said_of(&[(3, 5_000..SAMPLES), (0, 9_000..9_003), (6, 9_000..9_003)]);
    assert!(
        stays.contains("limb 4: no readable value since sample 5000"),
        "{stays}"
    );
    assert_eq!(stays.matches("decoded without").count(), 1, "{stays}");
    let clips = [(0, 500), (4, 9_700), (5, 18_900), (8, 28_100)];
    let apart = said(&clips);
    for (limb, _) in clips {
        let named = format!("limb {}: no readable value since", limb + 1);
        assert!(apart.contains(&named), "{named}: {apart}");
    }
    assert_eq!(
        apart.matches("decoded without").count(),
        clips.len(),
        "{apart}"
    );
    assert!(!apart.contains("noise"), "{apart}");
}

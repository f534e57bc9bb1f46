//! `sixaxis decouple --watch` as a user meets it: a limb dies in mid-run, is named and done without.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use sixaxis_calibration::calibration::Calibration;
use sixaxis_calibration::verdict::Grade;
use sixaxis_recordings::{Block, Channel, Layout, create, open};

const LIMBS: [&str; 9] = ["u1", "u2", "u3", "u4", "u5", "u6", "u7", "u8", "u9"];
/// The limb that dies, from 0, and where in the run.
const LIMB: usize = 4;
const SHARE: f64 = 0.4;

fn sixaxis(arguments: &[&str]) -> Output {
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

fn read(path: &Path, names: &[&str]) -> (Vec<Vec<f64>>, Option<f64>) {
    let mut source = open(path).expect("opens");
    let layout = source.layout().clone();
    let indices: Vec<usize> = names
        .iter()
        .map(|name| {
            let is = |c: &Channel| c.name.rsplit('/').next() == Some(name);
            layout.channels.iter().position(is).expect("a channel")
        })
        .collect();
    source.select(&indices).expect("selects");
    let mut all = vec![Vec::new(); names.len()];
    let mut block = Block::default();
    while source.read(&mut block, 1000).expect("reads") > 0 {
        for (all, column) in all.iter_mut().zip(&block.columns) {
            all.extend_from_slice(column);
        }
    }
    (all, layout.channels[indices[0]].sample_rate_hz)
}

#[test]
fn ref_a_limb_that_dies_is_named_and_done_without() {
    let folder: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join("watch");
    let _ = std::fs::remove_dir_all(&folder);
    let session = folder.join("session");
    std::fs::create_dir_all(&session).expect("makes a folder");
    let simulated = sixaxis(&["simulate", "--out", text(&session), "--seed", "3"]);
    assert!(simulated.status.success(), "{}", errors(&simulated));
    let (toml, json) = (
        session.join("session.toml"),
        session.join("calibration.json"),
    );
    sixaxis(&["calibrate", text(&toml), "--out", text(&json)]);
    // What the verdict does is tested by itself; here it is good.
    let mut calibration = Calibration::read(&json).expect("a calibration");
    calibration.verdict = Grade::Good;
    calibration.write(&json).expect("writes");
    let sound = std::fs::read_dir(&session)
        .expect("lists")
        .map(|entry| entry.expect("an entry").path())
        .find(|path| path.file_stem().is_some_and(|stem| stem == "compound-03"))
        .expect("the session has it");
    let (mut volts, rate_hz) = read(&sound, &LIMBS);
    let samples = volts[0].len();
    let onset = (SHARE * samples as f64) as usize;
    let zero = calibration.parameters.zero_drift_v[LIMB];
    volts[LIMB][onset..].fill(zero);
    let failed = folder.join(sound.file_name().expect("a name"));
    let layout = Layout {
        channels: LIMBS
            .iter()
            .map(|name| Channel {
                sample_rate_hz: rate_hz,
                ..Channel::new(*name, Some("V"))
            })
            .collect(),
        ..Layout::default()
    };
    let mut sink = create(&failed, &layout).expect("creates");
    sink.write(&Block { columns: volts }).expect("writes");
    sink.finish().expect("finishes");

    let out = |name: &str| folder.join(name);
    let decouple = |recording: &Path, out: &Path, watch: bool| {
        let mut arguments = vec!["decouple", text(&json), text(recording)];
        arguments.extend(["--session", text(&toml), "--out", text(out)]);
        if watch {
            arguments.push("--watch");
        }
        let output = sixaxis(&arguments);
        assert!(output.status.success(), "{}", errors(&output));
        errors(&output)
    };
    // A sound run: nothing is said, and every row is the decoupler's own.
    let names = [
        "ax", "ay", "az", "alpha_x", "alpha_y", "alpha_z", "wx", "wy", "wz",
    ];
    let (plain, watched) = (out("plain.csv"), out("watched.csv"));
    decouple(&sound, &plain, false);
    let said = decouple(&sound, &watched, true);
    assert!(!said.contains("limb"), "{said}");
    let (expected, _) = read(&plain, &names);
    assert_eq!(read(&watched, &names).0, expected);
    // A limb dies.
    let survived = out("survived.csv");
    let said = decouple(&failed, &survived, true);
    assert!(said.contains("limb 5: "), "{said}");
    assert!(said.contains("decoded without limb 5"), "{said}");
    let (flags, _) = read(&survived, &["without_limbs", "suspected_limbs"]);
    assert!(flags[0][..onset - 2].iter().all(|&limbs| limbs == 0.0));
    let switched = flags[0]
        .iter()
        .position(|&limbs| limbs == 5.0)
        .expect("a row without limb 5");
    assert!(flags[1].iter().all(|&limbs| limbs == 0.0));
    // From there on the answers are those of the sound run but for the noise of one limb less; with the dead limb they are not.
    let blind = out("blind.csv");
    decouple(&failed, &blind, false);
    let rms = |path: &Path| {
        let (found, _) = read(path, &names);
        let from = switched + 1;
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

#[test]
fn prop_watch_is_refused_where_it_has_no_meaning() {
    let refused = sixaxis(&["decouple", "a.json", "b.csv", "--watch", "--close"]);
    assert!(!refused.status.success());
    assert!(errors(&refused).contains("--close"), "{}", errors(&refused));
    let alone = sixaxis(&[
        "decouple",
        "a.json",
        "b.csv",
        "--false-alarms-per-hour",
        "2",
    ]);
    assert!(!alone.status.success());
}

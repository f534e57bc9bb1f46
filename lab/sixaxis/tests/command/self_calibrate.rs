//! `sixaxis self-calibrate` as a user meets it: a recording from the field, a calibration, a sentence.

use std::cell::Cell;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::OnceLock;

use serde_json::Value;
use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::LIMBS;
use sixaxis_recordings::{Block, Layout, create};
use sixaxis_reference::compliant::compliant_forces_m_s2;
use sixaxis_reference::laboratory::chain::Chain;
use sixaxis_reference::motion::TrueMotion;
use sixaxis_reference::sensor::TrueSensor;

use crate::mistakes::rewritten;
use crate::program::{Folder, gains, run, simulated, stderr, stdout, text};

/// A day in the laboratory and a tumble after it, limb 4 off by 0.3 %: the folder, and the gains of the tumble.
pub fn day() -> &'static (Folder, String) {
    static DAY: OnceLock<(Folder, String)> = OnceLock::new();
    DAY.get_or_init(|| {
        let options = "--seed 5 --tumble 20 --drift-limb 4=0.3%";
        let (folder, said) = simulated("self-calibrate", options);
        let calibrated = run(&["calibrate", text(&folder.join("session.toml")), "--quiet"]);
        assert!(
            matches!(calibrated.status.code(), Some(0 | 3)),
            "{calibrated:?}"
        );
        (folder, gains(&said))
    })
}

/// Runs on one of the day's recordings.
fn checked(recording: &Path, more: &[&str]) -> Output {
    let (folder, gains) = day();
    let calibration = folder.join("calibration.json");
    let mut arguments = vec![
        "self-calibrate",
        text(&calibration),
        text(recording),
        "--down",
        "0,0,-1",
        "--gain",
        gains.as_str(),
    ];
    arguments.extend_from_slice(more);
    run(&arguments)
}

#[test]
fn a_drifted_limb_is_named_with_its_interval() {
    let tumble = day().0.join("tumble.csv");
    let new = day().0.join("corrected.json");
    let output = checked(&tumble, &["--json", "--write-calibration", text(&new)]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    let said: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(said["finding"], "drifted");
    let limbs = said["limbs"].as_array().expect("nine limbs");
    for limb in limbs {
        assert_eq!(limb["drifted"], limb["limb"] == 4);
    }
    let change = limbs[3]["change_percent"].as_f64().expect("a number");
    let half = limbs[3]["half_width_95_percent"]
        .as_f64()
        .expect("a number");
    // Two and a half half widths of 95 % are one in a million; an interval as wide as the drift would say nothing.
    assert!(
        (change - 0.3).abs() < 2.5 * half && half < 0.1,
        "{change} +- {half}"
    );
    let people = checked(&tumble, &[]);
    assert!(
        stdout(&people).starts_with("Limb 4 has drifted by +0."),
        "{people:?}"
    );
    // With the corrected calibration nothing has drifted.
    let corrected = Calibration::read(&new).expect("a calibration");
    let old = Calibration::read(&day().0.join("calibration.json")).expect("a calibration");
    for limb in 0..LIMBS {
        let ratio = corrected.parameters.scale_per_mass_per_kg[limb]
            / old.parameters.scale_per_mass_per_kg[limb];
        let expected = if limb == 3 { change / 100.0 } else { 0.0 };
        assert!((ratio - 1.0 - expected).abs() < 1e-12, "limb {}", limb + 1);
    }
    let again = run(&[
        "self-calibrate",
        text(&new),
        text(&tumble),
        "--down",
        "0,0,-1",
        "--gain",
        &day().1,
    ]);
    assert_eq!(again.status.code(), Some(0), "{again:?}");
}

/// Plays a day in the laboratory by the plan with these lines changed, and a tumble of so many seconds after it, into `folder`/`name`: the
/// gains of the tumble.
fn play(
    folder: &Folder,
    name: &str,
    lines: &[(&str, &str)],
    tumble_s: &str,
    drift: &[&str],
) -> String {
    let printed = run(&["simulate", "--print-plan", "--engine", "rigid"]);
    let mut plan = stdout(&printed);
    for (key, value) in lines {
        let line = plan
            .lines()
            .find(|line| line.starts_with(&format!("{key} = ")));
        let line = line.expect(key).to_owned();
        plan = plan.replacen(&line, &format!("{key} = {value}"), 1);
    }
    let plan = folder.write(&format!("{name}.toml"), plan);
    let out = folder.file(name);
    let arguments = ["--plan", &plan, "--out", &out, "--tumble", tumble_s];
    gains(&stdout(&run(
        &[&["simulate"], &arguments[..], drift].concat()
    )))
}

/// The calibration of such a day checked with a tumble: what is said.
fn check(folder: &Folder, day: &str, tumble: &str, gains: &str) -> Output {
    let session = folder.file(&format!("{day}/session.toml"));
    run(&["calibrate", &session, "--quiet"]);
    let calibration = folder.file(&format!("{day}/calibration.json"));
    let tumble = folder.file(&format!("{tumble}/tumble.csv"));
    let arguments = ["--gain", gains, "--down", "0,0,-1", "--json"];
    run(&[&["self-calibrate", &calibration, &tumble], &arguments[..]].concat())
}

/// A day and a tumble after it: what is said.
fn of_a_day(name: &str, lines: &[(&str, &str)], tumble_s: &str, drift: &[&str]) -> Output {
    let folder = Folder::new(name);
    let gains = play(&folder, "day", lines, tumble_s, drift);
    check(&folder, "day", "day", &gains)
}

/// The usual room: limbs unequal by 1 %, channels that show up to 0.5 % of the next one.
const ROOM: [(&str, &str); 6] = [
    ("seed", "500"),
    ("sensor", "\"random\""),
    ("wedge_error_deg", "0.05"),
    ("stiffness_spread", "0.01"),
    ("cross_talk", "0.005"),
    ("sensitivity_drift", "0.0005"),
];

#[test]
fn ref_cross_talk_that_the_joint_fit_has_found_hides_no_drift_and_makes_none() {
    let healthy = of_a_day("cross-talk", &ROOM, "20", &[]);
    assert_eq!(healthy.status.code(), Some(0), "{healthy:?}");
    let drift = ["--drift-limb", "4=1%"];
    let drifted = of_a_day("cross-talk-drifted", &ROOM, "20", &drift);
    assert_eq!(drifted.status.code(), Some(3), "{drifted:?}");
    let said: Value = serde_json::from_slice(&drifted.stdout).expect("JSON");
    for limb in said["limbs"].as_array().expect("nine limbs") {
        assert_eq!(limb["drifted"], limb["limb"] == 4, "{limb}");
    }
}

#[test]
fn neg_cross_talk_that_came_since_says_nothing_of_limbs() {
    let folder = Folder::new("cross-talk-since");
    let tight = ROOM.map(|(key, value)| (key, if key == "cross_talk" { "0.0" } else { value }));
    play(&folder, "day", &tight, "5", &[]);
    let gains = play(&folder, "field", &ROOM, "5", &[]);
    let output = check(&folder, "day", "field", &gains);
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    let said: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(said["finding"], "misfit");
    assert!(
        said["limbs"]
            .as_array()
            .expect("limbs")
            .iter()
            .all(|limb| limb["drifted"] == false)
    );
    assert!(stderr(&output).contains("Cross-talk"), "{output:?}");
}

#[test]
fn ref_limbs_that_the_joint_fit_knows_to_be_unequal_have_not_drifted() {
    let unequal = [
        ("seed", "11"),
        ("stiffness_spread", "0.002"),
        ("wedge_error_deg", "0.01"),
    ];
    let healthy = of_a_day("unequal", &unequal, "20", &[]);
    assert_eq!(healthy.status.code(), Some(0), "{healthy:?}");
    let drift = ["--drift-limb", "4=0.3%"];
    let drifted = of_a_day("unequal-drifted", &unequal, "20", &drift);
    assert_eq!(drifted.status.code(), Some(3), "{drifted:?}");
    let said: Value = serde_json::from_slice(&drifted.stdout).expect("JSON");
    let limbs = said["limbs"].as_array().expect("nine limbs");
    for limb in limbs {
        assert_eq!(limb["drifted"], limb["limb"] == 4, "{limb}");
    }
    let number = |key: &str| limbs[3][key].as_f64().expect("a number");
    let (change, half) = (number("change_percent"), number("half_width_95_percent"));
    assert!(
        (change - 0.3).abs() < 2.5 * half && half < 0.05,
        "{change} +- {half}"
    );
}

#[test]
fn regress_the_truth_of_a_day_says_which_limb_has_drifted() {
    let (folder, _) = day();
    let truth = std::fs::read(folder.join("truth/tumble.json")).expect("it is there");
    let truth: Value = serde_json::from_slice(&truth).expect("JSON");
    let expected = [0.0, 0.0, 0.0, 0.003, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(truth, serde_json::json!({ "drift_of_scale": expected }));
}

#[test]
fn neg_a_wrong_gain_is_no_drift() {
    let (folder, gains) = day();
    let mut wrong: Vec<f64> = gains
        .split(',')
        .map(|gain| gain.trim().parse().expect("a gain"))
        .collect();
    wrong[5] *= 2.5;
    let wrong = wrong
        .iter()
        .map(f64::to_string)
        .collect::<Vec<_>>()
        .join(",");
    let [calibration, tumble, new] =
        ["calibration.json", "tumble.csv", "by-gain.json"].map(|name| folder.file(name));
    let of = |more: &[&str]| {
        let arguments = [
            "self-calibrate",
            &calibration,
            &tumble,
            "--gain",
            &wrong,
            "--down",
            "0,0,-1",
        ];
        run(&[&arguments[..], more].concat())
    };
    let asks = "is its gain (--gain or --session) the range that this recording was made with?";
    let told = of(&[]);
    assert_eq!(told.status.code(), Some(3), "{told:?}");
    assert!(
        stderr(&told).contains("limb 6") && stderr(&told).contains(asks),
        "{told:?}"
    );
    let refused = of(&["--write-calibration", &new]);
    assert_eq!(refused.status.code(), Some(1), "{refused:?}");
    assert!(
        stderr(&refused).contains(asks) && !Path::new(&new).exists(),
        "{refused:?}"
    );
    let forced = of(&["--write-calibration", &new, "--force"]);
    assert_eq!(forced.status.code(), Some(3), "{forced:?}");
    assert!(Path::new(&new).exists());
}

#[test]
fn neg_plugs_exchanged_within_a_pair_are_not_told_as_two_drifts_alone() {
    let (folder, gains) = day();
    let [tumble, exchanged, new, again] = [
        "tumble.csv",
        "exchanged.csv",
        "of-this-tumble.json",
        "of-the-exchanged.json",
    ]
    .map(|name| folder.file(name));
    let corrected = checked(Path::new(&tumble), &["--write-calibration", &new]);
    assert_eq!(corrected.status.code(), Some(3), "{corrected:?}");
    let of = |calibration: &str, recording: &str, more: &[&str]| {
        let arguments = ["self-calibrate", calibration, recording, "--gain", gains];
        run(&[&arguments[..], &["--down", "0,0,-1"], more].concat())
    };
    let lines = std::fs::read_to_string(&tumble).expect("the tumble");
    let heading = lines.lines().find(|line| line.contains("u2"));
    let heading = heading.expect("a heading");
    let at = |name: &str| heading.split(',').position(|column| column.contains(name));
    let (second, fourth) = (at("u2").expect("u2"), at("u4").expect("u4"));
    let rows = lines.lines().map(|line| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if !line.starts_with('#') && line != heading {
            cells.swap(second, fourth);
        }
        cells.join(",") + "\n"
    });
    std::fs::write(&exchanged, rows.collect::<String>()).expect("the exchanged");
    let asks = "limbs 2 and 4 would show the same with their plugs exchanged";
    let told = of(&new, &exchanged, &["--write-calibration", &again]);
    assert_eq!(told.status.code(), Some(1), "{told:?}");
    assert!(stderr(&told).contains(asks), "{told:?}");
    assert!(!Path::new(&again).exists());
    // One limb that has drifted asks nothing of the kind.
    assert!(!stderr(&corrected).contains("exchanged"), "{corrected:?}");
}

#[test]
fn the_same_tumble_before_and_after_cancels() {
    let tumble = day().0.join("tumble.csv");
    let before = day().0.join("before.csv");
    std::fs::copy(&tumble, &before).expect("a copy");
    let output = checked(&tumble, &["--since", text(&before)]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let itself = checked(&tumble, &["--since", text(&tumble)]);
    assert_eq!(itself.status.code(), Some(1), "{itself:?}");
    assert!(
        stderr(&itself).contains("the recording itself"),
        "{itself:?}"
    );
}

#[test]
fn a_motion_too_poor_is_refused_by_name() {
    let session = day().0.join("session.toml");
    let calibration = day().0.join("calibration.json");
    let linear = day().0.join("linear-01.csv");
    let output = run(&[
        "self-calibrate",
        text(&calibration),
        text(&linear),
        "--session",
        text(&session),
        "--json",
    ]);
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    let said: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(said["finding"], "too_poor");
    let open = said["open_in_words"].as_str().expect("words");
    for twins in [
        "limb 2 against limb 4",
        "limb 3 against limb 7",
        "limb 6 against limb 8",
    ] {
        assert!(open.contains(twins), "{open}");
    }
    assert!(said["limbs"].as_array().is_some_and(Vec::is_empty));
    assert_eq!(said["open_because_of"], "motion");
}

#[test]
fn neg_a_channel_that_is_wrong_is_no_poor_motion() {
    let folder = &day().0;
    let sample = Cell::new(0);
    rewritten("tumble.csv", "inverted.csv", |readings| readings[4] *= -1.0);
    rewritten("tumble.csv", "cable-off.csv", |readings| {
        sample.set(sample.get() + 1);
        if sample.get() > 100_000 {
            readings[6] = 0.0;
        }
    });
    for name in ["inverted.csv", "cable-off.csv"] {
        let path = folder.join(name);
        let output = checked(&path, &["--json"]);
        assert_eq!(output.status.code(), Some(4), "{name}: {output:?}");
        let said: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(said["finding"], "misfit", "{name}");
        assert_eq!(said["open_because_of"], "channels", "{name}");
        let people = stdout(&checked(&path, &[]));
        let leads = "The coordination equations do not fit this recording";
        assert!(people.starts_with(leads), "{name}: {people}");
        assert!(
            people.contains("a channel is dead, inverted") && !people.contains("more axes"),
            "{name}: {people}"
        );
    }
    // In a motion that is too poor as well neither is put first.
    rewritten("linear-01.csv", "poor-and-inverted.csv", |readings| {
        readings[4] *= -1.0;
    });
    let output = checked(&folder.join("poor-and-inverted.csv"), &[]);
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    let said = stdout(&output);
    assert!(
        said.starts_with("Either the motion is too poor or a channel is wrong"),
        "{said}"
    );
}

/// The tumble with a second of rest before it and a second turned over after it, all scale factors so many times what was calibrated.
fn turned_over(name: &str, factor: f64, chain: &Chain) -> PathBuf {
    let (folder, gains) = day();
    let mut sensor = TrueSensor::identified();
    for scale in &mut sensor.scale_per_mass_per_kg {
        *scale *= factor;
    }
    let numbers: Vec<f64> = gains
        .split(',')
        .map(|g| g.parse().expect("a gain"))
        .collect();
    let gain_n_per_v = numbers.try_into().expect("nine gains");
    let mut rng = rand_pcg::Pcg64::new(7, 7);
    let field = sixaxis_reference::rig::field::Field::by_hand(
        &mut rng,
        sixaxis_reference::rig::field::Pace::Brisk,
        10.0,
        10_000.0,
    );
    let turned_over = TrueMotion::at_rest(glam::DQuat::from_rotation_x(std::f64::consts::PI));
    let mut motion = vec![TrueMotion::at_rest(glam::DQuat::IDENTITY); 10_000];
    motion.extend(field.simulate(&sensor).1);
    motion.extend(vec![turned_over; 10_000]);
    let forces = compliant_forces_m_s2(&sensor, field.gravity_ground_m_s2, &motion)
        .expect("limbs that hold");
    let voltage_v = chain.record(&forces, &sensor, &gain_n_per_v, 10_000.0, &mut rng);
    let layout = Layout::of_a_sensor(Some(10_000.0), false);
    let path = folder.join(name);
    let mut sink = create(&path, &layout).expect("writes");
    let mut block = Block::new(LIMBS);
    block.clear(LIMBS);
    for u in voltage_v {
        for (column, u) in block.columns.iter_mut().zip(u) {
            column.push(u);
        }
    }
    sink.write(&block).expect("writes");
    sink.finish().expect("writes");
    path
}

#[test]
fn a_known_turn_tells_all_nine() {
    let path = turned_over("turned.csv", 1.01, &Chain::noise_free());
    let known = [
        "--known-change",
        "19.6133",
        "--rests",
        "0-0.9,11.1-12",
        "--json",
    ];
    let output = checked(&path, &known);
    let said: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{output:?}"));
    // One percent more than calibrated, where the calibration has the error of its accelerometer.
    let common = said["common_percent"].as_f64().expect("a number");
    let truth = fs::read_to_string(day().0.join("truth").join("truth.json")).expect("reads");
    let truth: Value = serde_json::from_str(&truth).expect("JSON");
    let error = &truth["instruments"]["accelerometer_gain_error"];
    let error = error.as_f64().expect("a number");
    let off = common - 100.0 * (1.01 / (1.0 + error) - 1.0);
    assert!(
        off.abs() < 0.1,
        "{common} % with an accelerometer off by {error}"
    );
    // No limb has drifted: all nine are off by what is common to them.
    let limbs = said["limbs"].as_array().expect("a list");
    assert_eq!(limbs.len(), LIMBS);
    for limb in limbs {
        let number = |key: &str| limb[key].as_f64().unwrap_or_else(|| panic!("{limb}"));
        let off = number("absolute_percent") - common;
        let known = number("absolute_half_width_95_percent");
        assert!(known < 0.5 && off.abs() < 1.5 * known, "{common}: {limb}");
    }
    // Told that it were twice as much, the rests are not believed.
    let wrong = checked(
        &path,
        &["--known-change", "39.2", "--rests", "0-0.9,11.1-12"],
    );
    assert_eq!(wrong.status.code(), Some(1), "{wrong:?}");
    for (rests, status) in [("0-0.9", 1), ("0-0.01,11-12", 1), ("2-1,11-12", 2)] {
        let refused = checked(&path, &["--known-change", "19.6", "--rests", rests]);
        assert_eq!(refused.status.code(), Some(status), "{rests}: {refused:?}");
    }
    let turning = checked(&path, &["--known-change", "19.6", "--rests", "0-0.9,4-5"]);
    let said = stderr(&turning);
    assert!(
        said.contains("in 4-5 s of") && said.contains("does not rest: channel u"),
        "{said}"
    );
}

#[test]
fn neg_limbs_that_have_drifted_together_are_not_said_to_have_kept_their_scale() {
    let known = ["--known-change", "19.6133", "--rests", "0-0.9,11.1-12"];
    let drifted = turned_over("together.csv", 1.05, &Chain::laboratory());
    let new = day().0.join("of-all-nine.json");
    let json = ["--json", "--write-calibration", text(&new)];
    let output = checked(&drifted, &[&known[..], &json].concat());
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    let said: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(said["finding"], "drifted");
    assert_eq!(said["common_drifted"], true);
    // Against each other they have not.
    let limbs = said["limbs"].as_array().expect("nine limbs");
    assert!(limbs.iter().all(|limb| limb["drifted"] == false));
    let people = stdout(&checked(&drifted, &known));
    assert!(
        people.starts_with("All nine limbs have drifted together by +")
            && !people.contains("No limb"),
        "{people}"
    );
    // Nothing shows that without a known change, nor once it is corrected.
    assert!(stdout(&checked(&drifted, &[])).starts_with("No limb has drifted"));
    let gains = ["--gain", &day().1, "--down", "0,0,-1"];
    let first = ["self-calibrate", text(&new), text(&drifted)];
    let again = run(&[&first[..], &gains, &known].concat());
    assert_eq!(again.status.code(), Some(0), "{again:?}");
    // What the standard accelerometer may be off by is no drift.
    let healthy = checked(&turned_over("kept.csv", 1.0, &Chain::laboratory()), &known);
    assert_eq!(healthy.status.code(), Some(0), "{healthy:?}");
    assert!(stdout(&healthy).starts_with("No limb has drifted"));
}

#[test]
fn what_is_read_is_not_written_over() {
    let (folder, _) = day();
    let tumble = folder.join("tumble.csv");
    let before = std::fs::metadata(&tumble).expect("is there").len();
    for option in ["--out", "--write-calibration"] {
        let refused = checked(&tumble, &[option, text(&tumble)]);
        assert_eq!(refused.status.code(), Some(1), "{refused:?}");
    }
    assert_eq!(std::fs::metadata(&tumble).expect("is there").len(), before);
}

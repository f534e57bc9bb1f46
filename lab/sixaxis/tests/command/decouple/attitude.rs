//! `--frame`, `--until-sd` and `--aid`: what stays true of a recording of minutes, and what is said of the rest.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use glam::{DQuat, DVec3};
use serde_json::Value;
use sixaxis_reference::motion::TrueMotion;
use sixaxis_reference::paper::GRAVITY_M_S2;
use sixaxis_reference::rig::journey::Kind;

use super::ride::Ride;
use super::session::{ACCELERATIONS, LIMBS, calibration, columns, write};
use crate::program::{done, run, stderr, stdout, text};

const RATE_HZ: f64 = 500.0;
const DURATION_S: f64 = 90.0;
const SENSOR_AXES: [&str; 6] = [
    "fx",
    "fy",
    "fz",
    "alpha_sensor_x",
    "alpha_sensor_y",
    "alpha_sensor_z",
];
/// Errors of sensor axes over the largest value: what the calibration states, 0.1 % for the forces, and noise of a sample.
const OF_PEAK: [f64; 2] = [0.01, 0.05];
/// Deviation of a filter's attitude over that of a second pass, at least.
const SMOOTHED_AT_LEAST: f64 = 1.2;
/// Deviations that no ground axis may be off by.
const NEVER: f64 = 6.0;

/// A recording of a sensor that is picked up and put down.
fn recorded() -> &'static Ride {
    static RECORDED: OnceLock<Ride> = OnceLock::new();
    RECORDED.get_or_init(|| {
        Ride::recorded(
            "decouple-attitude",
            Kind::PickAndPlace,
            5,
            RATE_HZ,
            DURATION_S,
        )
    })
}

/// Decouples it into a file of this name; what `--json` says.
fn decoupled(name: &str, more: &[&str]) -> (PathBuf, Value) {
    decoupled_from(&recorded().path(), name, more)
}

/// The same of another file of the same motion.
fn decoupled_from(path: &Path, name: &str, more: &[&str]) -> (PathBuf, Value) {
    let recorded = recorded();
    let out = recorded.folder.join(name);
    let calibration = calibration();
    let first = [
        "decouple",
        &calibration,
        text(path),
        "--gain",
        &recorded.gains,
        "--down",
        "0,0,-1",
        "--out",
        text(&out),
        "--json",
    ];
    let output = done(&[&first[..], more].concat());
    let said = serde_json::from_str(&stdout(&output)).expect("JSON");
    (out, said)
}

/// What ground axes are worth.
struct Held {
    /// Rows in which they are given.
    rows: usize,
    /// The largest error of an acceleration among them, over its deviation.
    worst: f64,
}

fn held_against_truth(path: &Path) -> Held {
    const DEVIATIONS: [&str; 3] = ["sd_ax", "sd_ay", "sd_az"];
    let (found, _) = columns(path, &ACCELERATIONS[..3]);
    let (deviations, _) = columns(path, &DEVIATIONS);
    let (mut rows, mut worst) = (0, 0.0_f64);
    // The first row is that of sample 1.
    for (row, instant) in recorded().truth[1..]
        .iter()
        .take(found[0].len())
        .enumerate()
    {
        if found[0][row].is_nan() {
            continue;
        }
        rows += 1;
        let truth = instant.linear_ground_m_s2.to_array();
        for axis in 0..3 {
            let error = found[axis][row] - truth[axis];
            worst = worst.max(error.abs() / deviations[axis][row]);
        }
    }
    Held { rows, worst }
}

/// Attitudes by a camera that sees the sensor from time to time, on the recording's clock, turned by an angle: the file and their number.
fn camera(name: &str, every: usize, off_rad: f64) -> (PathBuf, u64) {
    camera_from(1, name, every, off_rad)
}

/// The same by one that sees it from a sample on.
fn camera_from(first: usize, name: &str, every: usize, off_rad: f64) -> (PathBuf, u64) {
    let path = recorded().folder.join(name);
    let (mut lines, mut seen) = ("time [s],qw,qx,qy,qz\n".to_owned(), 0);
    let all = recorded().truth.iter().enumerate();
    let seen_at = all.skip(first).step_by(every);
    for (sample, instant) in seen_at {
        let q = instant.attitude * DQuat::from_rotation_x(off_rad);
        // A quaternion and its negative are one attitude, and cameras give either.
        let q = if seen % 2 == 1 { -q } else { q };
        let time_s = sample as f64 / RATE_HZ;
        lines += &format!("{time_s},{},{},{},{}\n", q.w, q.x, q.y, q.z);
        seen += 1;
    }
    std::fs::write(&path, lines).expect("writes");
    (path, seen)
}

#[test]
fn ref_sensor_axes_stay_true_and_ground_axes_end_where_the_attitude_is_lost() {
    let (both, said) = decoupled("open.parquet", &[]);
    let lost_s = said["attitude"]["unknown_from_s"]
        .as_f64()
        .expect("it is lost");
    assert!(lost_s > 2.0 && lost_s < DURATION_S / 2.0, "{lost_s}");
    let warning = said["warnings"][0].as_str().expect("a warning");
    assert!(warning.contains("less certain than 5.0°"), "{warning}");
    let (ground, _) = columns(&both, &ACCELERATIONS);
    let given = ground[0].iter().filter(|a| a.is_finite()).count();
    assert!(
        (given as f64 / RATE_HZ - lost_s).abs() < 0.01,
        "{given} rows, {lost_s} s"
    );
    for column in &ground {
        assert!(column[..given].iter().all(|a| a.is_finite()));
        assert!(column[given..].iter().all(|a| a.is_nan()));
    }
    // No limb fails: the monitor sees as much, and the attitude is lost when it was; made of six limbs it is lost sooner.
    let (watched, said) = decoupled("watched.parquet", &["--watch"]);
    assert_eq!(said["attitude"]["unknown_from_s"].as_f64(), Some(lost_s));
    let (ground, _) = columns(&watched, &ACCELERATIONS);
    assert!(ground[0][..given].iter().all(|a| a.is_finite()));
    assert!(ground[0][given..].iter().all(|a| a.is_nan()));
    let (_, said) = decoupled("excluded.parquet", &["--excluded", "1,6,9"]);
    let sooner_s = said["attitude"]["unknown_from_s"].as_f64();
    assert!(sooner_s.is_some_and(|s| s < lost_s), "{sooner_s:?}");
    let (rates, _) = columns(&both, &["wx"]);
    assert!(rates[0].iter().all(|w| w.is_finite()));
    let (sensor, _) = columns(&both, &SENSOR_AXES);
    let (alone, said) = decoupled("sensor.parquet", &["--frame", "sensor"]);
    assert_eq!(columns(&alone, &SENSOR_AXES).0, sensor);
    assert!(said["attitude"]["unknown_rows"].as_u64() > Some(0));
    let truth = &recorded().truth[1..=sensor[0].len()];
    for (part, limit) in OF_PEAK.into_iter().enumerate() {
        let true_value = |instant: &TrueMotion| match part {
            0 => instant.specific_force_shell_m_s2(DVec3::NEG_Z * GRAVITY_M_S2),
            _ => instant.attitude.inverse() * instant.angular_ground_rad_s2,
        };
        let peak = truth
            .iter()
            .map(|t| true_value(t).length())
            .fold(0.0, f64::max);
        let rows = truth.iter().enumerate();
        let worst = rows
            .map(|(row, t)| {
                let at = |axis: usize| sensor[3 * part + axis][row];
                (DVec3::new(at(0), at(1), at(2)) - true_value(t)).length()
            })
            .fold(0.0, f64::max);
        assert!(worst < limit * peak, "{part}: {worst:e} of {peak:e}");
    }
}

/// A rate that was taken for unknown when the first attitude came would turn the sensor by a radian until the next one does: none of them
/// would ever tell it.
#[test]
fn regress_attitudes_after_long_silence_tell_the_rate_again() {
    let (first, every) = (60 * RATE_HZ as usize, 50);
    let (fixes, seen) = camera_from(first, "late.csv", every, 0.0);
    let aid = format!("attitude={},0.5", text(&fixes));
    let (late, said) = decoupled("late.parquet", &["--aid", &aid]);
    assert_eq!(said["attitude"]["attitude"]["taken"].as_u64(), Some(seen));
    let (rates, _) = columns(&late, &["wx", "wy", "wz"]);
    let of = |row: usize| DVec3::from_array([0, 1, 2].map(|axis: usize| rates[axis][row]));
    let truth = |row: usize| recorded().truth[row + 1].rate_shell_rad_s;
    let rms = |rows: core::ops::Range<usize>| {
        let squares = rows
            .clone()
            .map(|row| (of(row) - truth(row)).length_squared());
        (squares.sum::<f64>() / rows.len() as f64).sqrt()
    };
    let settled = first + 2 * RATE_HZ as usize;
    let [before, after] = [rms(first - 1000..first - 1), rms(settled..rates[0].len())];
    println!("{before:.3} rad/s before, {after:.4} after");
    assert!(before > 0.1 && after < 0.01, "{before} {after}");
}

#[test]
fn ref_rests_and_attitudes_keep_ground_axes_within_six_deviations() {
    let (open, _) = decoupled("deviates.parquet", &["--uncertainty"]);
    let Held {
        rows: open_rows,
        worst,
    } = held_against_truth(&open);
    assert!(worst < NEVER, "open loop: {worst}");

    let (rests, said) = decoupled("rests.parquet", &["--uncertainty", "--aid", "rest"]);
    let Held { rows, worst } = held_against_truth(&rests);
    assert!(worst < NEVER, "rests: {worst}");
    // A rest is known no better than noise can hide the motion after it.
    assert!(rows > 4 * open_rows, "{rows} rows after {open_rows}");
    let used = |said: &Value, of: &str| said["attitude"][of]["taken"].as_u64().expect("a number");
    assert!(used(&said, "rest") > 20);

    let (fixes, seen) = camera("camera.csv", 1000, 2e-3);
    let aid = format!("attitude={},0.2", text(&fixes));
    let (fixed, said) = decoupled("fixed.parquet", &["--uncertainty", "--aid", &aid]);
    let Held { rows, worst } = held_against_truth(&fixed);
    assert!(worst < NEVER, "attitudes: {worst}");
    assert_eq!(rows, recorded().truth.len() - 2, "every row is given");
    assert_eq!(used(&said, "attitude"), seen);

    // Attitudes of another motion contradict everything: nobody knows the ground's axes.
    let turned = std::fs::read_to_string(&fixes).expect("reads");
    let backwards: Vec<&str> = turned.lines().skip(1).collect();
    let times = backwards
        .iter()
        .map(|line| line.split_once(',').expect("cells").0);
    let attitudes = backwards
        .iter()
        .rev()
        .map(|line| line.split_once(',').expect("cells").1);
    let lines: Vec<String> = times
        .zip(attitudes)
        .map(|(t, q)| format!("{t},{q}"))
        .collect();
    std::fs::write(
        &fixes,
        format!("time [s],qw,qx,qy,qz\n{}\n", lines.join("\n")),
    )
    .expect("writes");
    let (calibration, path) = (calibration(), recorded().path());
    let out = recorded().folder.join("wrong.parquet");
    let first = ["decouple", &calibration, text(&path), "--down", "0,0,-1"];
    let last = ["--gain", &recorded().gains, "--aid", &aid];
    let output = run(&[&first[..], &last, &["--out", text(&out)]].concat());
    assert!(
        !output.status.success() && stderr(&output).contains("camera.csv: attitude 1, at "),
        "{}",
        stderr(&output)
    );
    assert!(!out.exists());

    // Between samples, before and after the recording, and with rests beside.
    let mut lines = "time [s],qw,qx,qy,qz\n-3,1,0,0,0\n".to_owned();
    for pair in recorded().truth.windows(2).skip(1).step_by(1000) {
        let between = pair[0].attitude.slerp(pair[1].attitude, 0.5);
        let sample = recorded()
            .truth
            .iter()
            .position(|i| i == &pair[0])
            .expect("it is there");
        let time_s = (sample as f64 + 0.5) / RATE_HZ;
        lines += &format!(
            "{time_s},{},{},{},{}\n",
            between.w, between.x, between.y, between.z
        );
    }
    lines += "1000,1,0,0,0\n";
    std::fs::write(&fixes, lines).expect("writes");
    let aid = format!("attitude={},0.1", text(&fixes));
    let more = ["--uncertainty", "--aid", &aid, "--aid", "rest"];
    let (both, said) = decoupled("both.parquet", &more);
    let Held { rows, worst } = held_against_truth(&both);
    assert!(worst < NEVER, "attitudes and rests: {worst}");
    assert_eq!(rows, recorded().truth.len() - 2, "every row is given");
    assert_eq!(said["attitude"]["attitude"]["unused"], 2);
}

/// Largest error of the attitude over its deviation, and the mean of that, rad.
fn attitudes_against_truth(path: &Path) -> (f64, f64) {
    let (found, _) = columns(path, &["qw", "qx", "qy", "qz", "sd_attitude"]);
    let (mut worst, mut sum) = (0.0_f64, 0.0);
    let rows = found[0].len();
    for (row, instant) in recorded().truth[1..].iter().take(rows).enumerate() {
        let [w, x, y, z, sd] = core::array::from_fn(|k| found[k][row]);
        let off = DQuat::from_xyzw(x, y, z, w) * instant.attitude.inverse();
        worst = worst.max(off.normalize().to_scaled_axis().length() / sd);
        sum += sd;
    }
    (worst, sum / rows as f64)
}

#[test]
fn ref_a_second_pass_knows_what_came_later() {
    let (fixes, _) = camera("often.csv", 200, 2e-3);
    let aid = format!("attitude={},0.2", text(&fixes));
    let aids = ["--uncertainty", "--aid", &aid];
    let (filtered, once) = decoupled("filtered.parquet", &aids);
    let (_, sd_filtered) = attitudes_against_truth(&filtered);
    let (smoothed, said) = decoupled("smoothed.parquet", &[&aids[..], &["--smooth"]].concat());
    let (worst_attitude, sd_smoothed) = attitudes_against_truth(&smoothed);
    let Held { rows, worst } = held_against_truth(&smoothed);
    println!(
        "{sd_filtered:.2e} and {sd_smoothed:.2e} rad, {worst_attitude:.2} and {worst:.2} deviations"
    );
    assert!(
        worst < NEVER && worst_attitude < NEVER,
        "{worst} {worst_attitude}"
    );
    assert_eq!(rows, recorded().truth.len() - 2, "every row is given");
    assert!(
        SMOOTHED_AT_LEAST * sd_smoothed < sd_filtered,
        "{sd_smoothed} after {sd_filtered} rad"
    );
    // Attitudes are counted once, of the first pass.
    assert_eq!(said["attitude"]["attitude"], once["attitude"]["attitude"]);
    let with_rests = [&aids[..], &["--aid", "rest", "--smooth"]].concat();
    let (rested, _) = decoupled("rested.parquet", &with_rests);
    let (worst_attitude, sd_rested) = attitudes_against_truth(&rested);
    let worst = held_against_truth(&rested).worst;
    println!("{sd_rested:.2e} rad with rests, {worst_attitude:.2} and {worst:.2} deviations");
    assert!(worst < NEVER && worst_attitude < NEVER);
    assert!(
        sd_rested <= sd_smoothed,
        "{sd_rested} after {sd_smoothed} rad"
    );
}

#[test]
fn ref_aids_hold_without_the_channels_of_lost_limbs() {
    let (mut volts, rate_hz) = columns(&recorded().path(), &LIMBS);
    // One says nothing, one what is not so.
    volts[4].fill(f64::NAN);
    volts[8].iter_mut().step_by(2).for_each(|u| *u = 1.0);
    let lost = recorded().folder.join("lost.npz");
    write(&lost, &LIMBS, "V", &volts, rate_hz.unwrap_or(RATE_HZ));
    let without = ["--excluded", "5,9", "--uncertainty"];
    let (open, said) = decoupled_from(&lost, "lost-open.parquet", &without);
    let Held {
        rows: open_rows,
        worst,
    } = held_against_truth(&open);
    assert!(worst < NEVER, "open loop: {worst}");
    let warned = said["warnings"].to_string();
    assert!(
        warned.contains("--aid tells what else is known"),
        "{warned}"
    );
    // A rest without noise is no recorder that hung.
    assert!(!warned.contains("stand still"), "{warned}");
    let rest = [&without[..], &["--aid", "rest"]].concat();
    let (rests, said) = decoupled_from(&lost, "lost-rests.parquet", &rest);
    let Held { rows, worst } = held_against_truth(&rests);
    assert!(worst < NEVER, "rests: {worst}");
    assert!(rows > 4 * open_rows, "{rows} rows after {open_rows}");
    let used = |said: &Value| said["attitude"]["rest"]["taken"].as_u64();
    assert!(used(&said) > Some(20), "{said}");
    let smooth = [&rest[..], &["--smooth"]].concat();
    let (smoothed, _) = decoupled_from(&lost, "lost-smoothed.parquet", &smooth);
    let Held {
        rows: smoothed_rows,
        worst,
    } = held_against_truth(&smoothed);
    assert!(worst < NEVER, "smoothed: {worst}");
    assert!(smoothed_rows >= rows, "{smoothed_rows} rows after {rows}");
    // With all nine it is known better, as long as neither has used a rest; not along each axis, where those two are the noisiest.
    let (nine, _) = decoupled("nine.parquet", &["--uncertainty", "--aid", "rest"]);
    let variance = |path: &Path| -> Vec<f64> {
        let (axes, _) = columns(path, &["sd_ax", "sd_ay", "sd_az"]);
        let of = |row: usize| axes.iter().map(|axis| axis[row].powi(2)).sum();
        (0..100).map(of).collect()
    };
    let pairs = variance(&nine).into_iter().zip(variance(&rests));
    assert!(
        pairs
            .into_iter()
            .all(|(nine, seven): (f64, f64)| nine < seven)
    );
}

/// From the sample on at which it dies, of which the monitor learns later.
#[test]
fn ref_aids_hold_when_a_limb_dies() {
    let (mut volts, rate_hz) = columns(&recorded().path(), &LIMBS);
    let dies_at = volts[4].len() / 3;
    volts[4][dies_at..].fill(0.7);
    let dying = recorded().folder.join("dying.npz");
    write(&dying, &LIMBS, "V", &volts, rate_hz.unwrap_or(RATE_HZ));
    let rest = ["--aid", "rest", "--uncertainty"];
    let watched = [&rest[..], &["--watch"]].concat();
    let (path, said) = decoupled_from(&dying, "dying.parquet", &watched);
    let Held { rows, worst } = held_against_truth(&path);
    assert!(worst < NEVER, "{worst}");
    assert!(
        said["warnings"]
            .to_string()
            .contains("decoded without limb 5")
    );
    let (flags, _) = columns(&path, &["excluded_limbs", "suspected_limbs"]);
    // Rows begin with the second sample.
    let excluded_from = flags[0].iter().position(|limbs| *limbs == 5.0);
    assert!(
        excluded_from.is_some_and(|row| row < dies_at && row + 500 > dies_at),
        "{excluded_from:?}, {dies_at}"
    );
    assert!(flags[0][dies_at - 1..].iter().all(|limbs| *limbs == 5.0));
    // As if it had been known that the limb would die: but for what was known of it before.
    let without = [&rest[..], &["--excluded", "5"]].concat();
    let (known, _) = decoupled_from(&dying, "dying-known.parquet", &without);
    let known_rows = held_against_truth(&known).rows;
    assert!(10 * rows > 9 * known_rows, "{rows} rows of {known_rows}");
    // The attitude's errors hide a dead limb in ground axes, the forces of one sample do not.
    let forces = |path: &Path| columns(path, &["fx", "fy", "fz"]).0;
    for (found, known) in forces(&path).iter().zip(&forces(&known)) {
        let peak = known.iter().fold(0.0_f64, |peak, f| peak.max(f.abs()));
        let pairs = found.iter().zip(known).skip(dies_at);
        let off = pairs.fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
        assert!(off < 1e-3 * peak, "{off} of {peak} m/s^2");
    }
    // A healthy recording is what it is without the monitor.
    let (healthy, _) = decoupled("healthy-watched.parquet", &watched);
    let (plain, _) = decoupled("healthy-rests.parquet", &rest);
    let all = [
        &SENSOR_AXES[..],
        &["ax", "ay", "az", "sd_ax", "sd_attitude"],
    ]
    .concat();
    let bits = |path: &Path| -> Vec<u64> {
        let (found, _) = columns(path, &all);
        found.into_iter().flatten().map(f64::to_bits).collect()
    };
    assert!(bits(&healthy) == bits(&plain));
}

#[test]
fn regress_a_rate_that_runs_away_keeps_what_came_before() {
    let recorded = recorded();
    let (calibration, path) = (calibration(), recorded.path());
    let out = recorded.folder.join("away.parquet");
    let with = |until_deg: &str| {
        let of_another_range = ["--gain", "20", "--down", "0,0,-1", "--json"];
        let first = ["decouple", &calibration, text(&path), "--out", text(&out)];
        let last = ["--until-sd", until_deg];
        run(&[&first[..], &of_another_range, &last].concat())
    };
    // The attitude is given up long before.
    let output = with("0.15");
    assert!(output.status.success(), "{}", stderr(&output));
    let said: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    let warned = said["warnings"].to_string();
    assert!(warned.contains("has run away"), "{warned}");
    let (found, _) = columns(&out, &["wx", "fx"]);
    let given = found[0].iter().filter(|w| w.is_finite()).count();
    assert_eq!(found[0].len(), recorded.truth.len() - 2);
    assert!(given > 0 && given < found[0].len(), "{given}");
    for column in &found {
        assert!(column[..given].iter().all(|v| v.is_finite()));
        assert!(column[given..].iter().all(|v| v.is_nan()));
    }
    // While the attitude counts as known, a wrong gain is an error.
    let output = with("1e9");
    assert!(!output.status.success());
    assert!(stderr(&output).contains("has run away"), "{output:?}");
}

#[test]
fn prop_aids_that_say_nothing_are_refused() {
    let recorded = recorded();
    let (calibration, path) = (calibration(), recorded.path());
    let bad = recorded.folder.join("bad.csv");
    let with = |more: &[&str]| {
        let first = [
            "decouple",
            &calibration,
            text(&path),
            "--gain",
            &recorded.gains,
        ];
        run(&[&first[..], more].concat())
    };
    for (more, cause) in [
        (&["--aid", "gravity"][..], "velocity=SECONDS,M_PER_S"),
        (&["--aid", "velocity=0,1"], "no positive time"),
        (&["--aid", "rest", "--rest-to-rest"], "cannot be used with"),
        (&["--aid", "rest"], "where down is"),
        (
            &["--down", "0,0,-1", "--aid", "rest", "--aid", "rest"],
            "twice",
        ),
        (&["--smooth"], "--aid"),
        (
            &["--until-sd", "5", "--rest-to-rest"],
            "cannot be used with",
        ),
        (&["--until-sd", "0"], "must be positive"),
        (&["--frame", "sensor", "--picture", "p.html"], "leaves out"),
    ] {
        let output = with(more);
        assert!(
            !output.status.success() && stderr(&output).contains(cause),
            "{more:?}: {output:?}"
        );
    }
    let aid = format!("attitude={},1", text(&bad));
    for (content, cause) in [
        ("time [s],qw,qx,qy\n0,1,0,0\n", "qz"),
        ("time [s],qw,qx,qy,qz\n0,2,0,0,0\n", "length 2.000"),
        ("time [s],qw,qx,qy,qz\n1,1,0,0,0\n1,1,0,0,0\n", "not after"),
        ("qw,qx,qy,qz\n1,0,0,0\n", "no column of times"),
    ] {
        std::fs::write(&bad, content).expect("writes");
        let output = with(&["--aid", &aid]);
        assert!(
            !output.status.success() && stderr(&output).contains(cause),
            "{content}: {output:?}"
        );
        assert!(stderr(&output).contains("bad.csv"), "{output:?}");
    }
}

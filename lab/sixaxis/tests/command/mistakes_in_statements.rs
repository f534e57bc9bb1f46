//! What a session states and is not so, and recordings that are told by what the others agree on.

use std::fs;
use std::sync::OnceLock;

use crate::mistakes::{calibrated_in, rewritten_in, with_entry};
use crate::program::{Folder, done, run, simulated, stderr, text};

/// A day of few samples: each mistake is a whole calibration, and what is wrong takes longer to tell than what is right.
fn day() -> &'static Folder {
    static DAY: OnceLock<Folder> = OnceLock::new();
    DAY.get_or_init(|| {
        let (folder, _) = simulated("statements", "--rate 500 --trials 6 --seed 5");
        let calibrated = run(&["calibrate", text(&folder.join("session.toml")), "--quiet"]);
        assert!(calibrated.status.success(), "{calibrated:?}");
        folder
    })
}

fn calibrated(name: &str, change: impl Fn(&str) -> String) -> (i32, String) {
    calibrated_in(day(), name, change)
}

fn rewritten(recording: &str, name: &str, change: impl Fn(&mut [f64])) {
    rewritten_in(day(), recording, name, change);
}

/// The session with every line of a key written anew from its numbers.
fn with_numbers(session: &str, key: &str, change: impl Fn(&[f64]) -> Vec<f64>) -> String {
    let lines = session.lines().map(|line| {
        let numbers = line
            .strip_prefix(key)
            .and_then(|line| line.strip_prefix(" = ["));
        match numbers.and_then(|numbers| numbers.strip_suffix(']')) {
            Some(numbers) => {
                let numbers: Result<Vec<f64>, _> =
                    numbers.split(',').map(|x| x.trim().parse()).collect();
                let changed = change(&numbers.expect("numbers"));
                let changed: Vec<String> = changed.iter().map(f64::to_string).collect();
                format!("{key} = [{}]\n", changed.join(", "))
            }
            None => format!("{line}\n"),
        }
    });
    lines.collect()
}

fn without_role(session: &str, role: &str) -> String {
    let role = format!("role = \"{role}\"");
    let entries = session.split("[[recording]]");
    let kept: Vec<&str> = entries.filter(|entry| !entry.contains(&role)).collect();
    kept.join("[[recording]]")
}

/// The recordings that move.
fn recordings() -> Vec<String> {
    let session = fs::read_to_string(day().join("session.toml")).expect("reads");
    let files = session
        .lines()
        .filter_map(|line| line.strip_prefix("file = \"")?.strip_suffix('"'));
    let moving = files.filter(|name| !name.starts_with("static"));
    moving.map(str::to_owned).collect()
}

/// The session with what stands for them.
fn renamed(session: &str, by: &str) -> String {
    let renamed = session.replace("file = \"", &format!("file = \"{by}-"));
    renamed.replace(&format!("{by}-static"), "static")
}

/// A name, what is done to the session, and what is said of it.
type Case<'a> = (&'a str, &'a dyn Fn(&str) -> String, &'a str);

/// Calibrates the day with each change; it is not good, and says these words.
fn told(cases: &[Case<'_>]) {
    for (name, change, words) in cases {
        let (code, said) = calibrated(name, change);
        assert!(code == 4 || code == 1, "{name}: {said}");
        assert!(said.starts_with("Not good:"), "{name}: {said}");
        assert!(said.contains(words), "{name}: {said}");
        assert!(!said.contains("cause unknown"), "{name}: {said}");
    }
}

#[test]
fn neg_statements_that_are_not_so_are_named() {
    told(&[
        (
            "high-pass-not-there",
            &|s| {
                s.replace(
                    "[preprocessing]\n",
                    "[preprocessing]\namplifier_high_pass_hz = 0.1\n",
                )
            },
            "without the stated high-pass of 0.1 Hz all trials agree",
        ),
        (
            "radians",
            &|s| {
                let lines = s
                    .lines()
                    .map(|line| match line.strip_prefix("frequency_hz = ") {
                        Some(hz) => {
                            let hz: f64 = hz.parse().expect("a number");
                            format!("frequency_hz = {}\n", core::f64::consts::TAU * hz)
                        }
                        None => format!("{line}\n"),
                    });
                lines.collect()
            },
            "frequency_hz is in radians a second",
        ),
        (
            "one-wedge",
            &|s| {
                let linear = |entry: &&str| entry.contains("role = \"linear\"");
                let first = s.split("[[recording]]").find(linear).map(str::to_owned);
                let kept = s.split("[[recording]]");
                let kept = kept.filter(|e| !linear(e) || Some(*e) == first.as_deref());
                kept.collect::<Vec<_>>().join("[[recording]]")
            },
            "axis not excited",
        ),
        (
            "no-rests",
            &|s| s.replace("detrend = false", "detrend = { rest_s = 0.5 }"),
            "the first and the last 0.5 s as rests, and the standards move there",
        ),
        (
            "no-motion-left",
            &|s| {
                s.replace("times_drive = 4.0", "times_drive = 0.4")
                    .replace("plus_hz = 8.0", "plus_hz = 0.0")
            },
            "preprocessing.low_pass takes off the motion itself",
        ),
        (
            "no-acceleration-left",
            &|s| s.replace("half_width = 3", "half_width = 200"),
            "of an angular acceleration at the drive's",
        ),
        (
            "bandwidth-100",
            &|s| s.replace("bandwidth_hz = 10.0", "bandwidth_hz = 100.0"),
            "correct the gyroscope's bandwidth_hz",
        ),
        (
            "bandwidth-5",
            &|s| s.replace("bandwidth_hz = 10.0", "bandwidth_hz = 5.0"),
            "correct the gyroscope's bandwidth_hz",
        ),
        (
            "accelerometer-bandwidth",
            &|s| {
                s.replace(
                    "[accelerometer]\n",
                    "[accelerometer]\nbandwidth_hz = 10.0\n",
                )
            },
            "an accelerometer that follows at once",
        ),
        (
            "gyroscope-delay-not-there",
            &|s| s.replace("[gyroscope]\n", "[gyroscope]\ndelay_ms = 5.0\n"),
            "take delay_ms of the gyroscope out",
        ),
        (
            "accelerometer-delay-not-there",
            &|s| s.replace("[accelerometer]\n", "[accelerometer]\ndelay_ms = 5.0\n"),
            "take delay_ms of the accelerometer out",
        ),
        (
            "delay-not-there",
            &|s| s.replace("[channels]\n", "[channels]\nlimbs_lag_us = 100.0\n"),
            "[channels] limbs_lag_us",
        ),
        (
            "axes-exchanged",
            &|s| with_numbers(s, "direction", |d| vec![d[1], d[0], d[2]]),
            "each direction (x, y, z) read as (y, x, z)",
        ),
        (
            "axes-left-handed",
            &|s| with_numbers(s, "direction", |d| vec![-d[0], d[1], d[2]]),
            "each direction (x, y, z) read as (-x, y, z)",
        ),
        (
            "axes-reversed",
            &|s| with_numbers(s, "direction", |d| d.iter().map(|x| -x).collect()),
            "each direction (x, y, z) read as (-x, -y, -z)",
        ),
        (
            "mounted-otherwise-on-the-pinion",
            &|s| {
                let turned = |d: &[f64]| vec![d[1], -d[0], d[2]];
                let entries = s.split("[[recording]]").map(|entry| {
                    match entry.contains("role = \"angular\"") {
                        true => {
                            let entry = with_numbers(entry, "direction", turned);
                            with_numbers(&entry, "down", turned)
                        }
                        false => entry.to_owned(),
                    }
                });
                entries.collect::<Vec<_>>().join("[[recording]]")
            },
            "each direction (x, y, z) of the angular trials read as (-y, x, z)",
        ),
        (
            "gains-in-volts-per-newton",
            &|s| {
                with_numbers(s, "gain_n_per_v", |gains| {
                    gains.iter().map(|c| 1.0 / c).collect()
                })
            },
            "state all gains in N/V",
        ),
        (
            "gains-of-one-trial-in-volts-per-newton",
            &|s| {
                with_entry(s, "linear-05", |entry| {
                    with_numbers(entry, "gain_n_per_v", |gains| {
                        gains.iter().map(|c| 1.0 / c).collect()
                    })
                })
            },
            "linear-05.csv with one over each of its gain_n_per_v",
        ),
        (
            "gains-all-alike",
            &|s| with_numbers(s, "gain_n_per_v", |_| vec![0.05; 9]),
            "state the gains of each recording, by the amplifiers' panel",
        ),
        (
            "no-linear",
            &|s| without_role(s, "linear"),
            "the session has no linear trial",
        ),
        (
            "no-angular",
            &|s| without_role(s, "angular"),
            "the session has no angular trial",
        ),
    ]);
}

/// In a room with unequal limbs some trials depart from the others; without zeros no fit can say that they do for nothing of their own.
#[test]
fn neg_without_a_static_record_no_trial_is_accused() {
    let [folder, plans] = ["no-static", "no-static-plan"].map(Folder::new);
    let plan = plans.write("plan.toml", "[chain]\nstiffness_spread = 0.02\n");
    let how = ["--rate", "500", "--trials", "6", "--seed", "3"];
    let first = ["simulate", "--engine", "rigid", "--plan", &plan];
    done(&[&first[..], &how, &["--out", text(&folder)]].concat());
    let (code, said) = calibrated_in(&folder, "no-static", |s| without_role(s, "static"));
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("the session has no static record"), "{said}");
    assert!(
        !said.contains("from what the other trials agree on"),
        "{said}"
    );
}

/// A third of a turn about the diagonal takes the limbs' layout to itself: directions so turned are told beside channels in another order.
#[test]
fn neg_directions_that_look_like_another_order_are_told_as_either() {
    let (code, said) = calibrated("axes-turned", |s| {
        with_numbers(s, "direction", |d| vec![d[1], d[2], d[0]])
    });
    assert!(matches!(code, 1 | 4), "{said}");
    let or = "; or state the directions in the sensor's axes: (z, x, y) of what is written";
    assert!(
        said.contains("either put the present entries of [channels] limbs into the order"),
        "{said}"
    );
    assert!(said.contains(or), "{said}");
}

#[test]
fn neg_an_odd_recording_is_told_by_what_the_others_agree_on() {
    rewritten("angular-04.csv", "exchanged-3-9.csv", |row| row.swap(2, 8));
    rewritten("linear-04.csv", "moved-on.csv", |row| {
        row[..9].rotate_left(1)
    });
    rewritten("linear-06.csv", "centimetres.csv", |row| row[9] *= 100.0);
    for name in recordings() {
        rewritten(&name, &format!("reversed-{name}"), |row| row[9] = -row[9]);
    }
    told(&[
        (
            "exchanged-3-9",
            &|s| s.replace("angular-04.csv", "exchanged-3-9.csv"),
            "exchanged-3-9.csv; channels 3 and 9",
        ),
        (
            "moved-on",
            &|s| s.replace("linear-04.csv", "moved-on.csv"),
            "with all nine names moved on they agree",
        ),
        (
            "centimetres",
            &|s| s.replace("linear-06.csv", "centimetres.csv"),
            "centimetres.csv the standard accelerometer shows 100.",
        ),
        (
            "accelerometer-reversed",
            &|s| renamed(s, "reversed"),
            "with the standard accelerometer reversed all trials agree",
        ),
        (
            "channels-inverted",
            &|s| {
                with_numbers(s, "gain_n_per_v", |gains| {
                    gains.iter().map(|g| -g).collect()
                })
            },
            "and the inertias have not: all channels are inverted",
        ),
    ]);
}

/// The day with a copy of a recording, of this name, in whose sample 498 a column reads something else.
fn with_wild(recording: &str, name: &str, (column, reading): (usize, f64)) -> (i32, String) {
    let (at, file) = (std::cell::Cell::new(0), format!("{name}.csv"));
    rewritten(recording, &file, |row| {
        if at.replace(at.get() + 1) == 498 {
            row[column] = reading;
        }
    });
    calibrated(name, |s| s.replace(recording, &file))
}

/// However large: one that dwarfs the motion hides where it begins and ends, and the trial is whole all the same.
#[test]
fn neg_a_wild_cell_is_told_by_its_sample() {
    for (name, volts, in_words) in [("wild", 3125.0, "3125.0"), ("wilder", 1e30, "1e30")] {
        let file = format!("{name}.csv");
        let (code, said) = with_wild("linear-04.csv", name, (3, volts));
        assert_eq!(code, 4, "{said}");
        let words = format!(
            "recording cannot be used: {file}; channel 4 voltages up to {in_words} V from a converter that ends at 10 V, in 1 of all samples, the first of them sample 498 of {file}"
        );
        assert!(said.contains(&words), "{said}");
        assert!(!said.contains("not whole"), "{said}");
    }
}

#[test]
fn neg_a_wild_reading_of_a_standard_is_told_by_its_sample() {
    for (recording, column, standard) in [
        ("linear-04.csv", 9, "accelerometer"),
        ("angular-03.csv", 10, "gyroscope"),
        ("compound-01.csv", 10, "gyroscope"),
    ] {
        let name = format!("wild-{standard}-{}", &recording[..6]);
        let file = format!("{name}.csv");
        let (code, said) = with_wild(recording, &name, (column, -1e30));
        assert_eq!(code, 4, "{said}");
        let words = format!(
            "recording cannot be used: {file} the {standard}'s reading of -1.0e30 at sample 498 is more than a hundred times"
        );
        assert!(said.contains(&words), "{said}");
        assert!(!said.contains("not excited"), "{said}");
    }
}

#[test]
fn neg_hum_is_told_by_a_misfit_that_is_too_small() {
    let at = std::cell::Cell::new(0.0);
    let hum = |row: &mut [f64]| {
        let turns = 50.0 * at.replace(at.get() + 1.0) / 500.0;
        let u = 0.1 * (core::f64::consts::TAU * turns).sin();
        row[..9].iter_mut().for_each(|channel| *channel += u);
    };
    for name in recordings() {
        rewritten(&name, &format!("hum-{name}"), hum);
    }
    let (_, said) = calibrated("hum", |s| renamed(s, "hum"));
    assert!(
        said.contains("times the noise that is among them, as with mains hum"),
        "{said}"
    );
}

#[test]
fn neg_a_low_pass_that_takes_the_motion_is_told() {
    let folder = day();
    let of = |name: &str| folder.join(name);
    let decoupled = |corner: &str| {
        run(&[
            "decouple",
            text(&of("calibration.json")),
            text(&of("compound-03.csv")),
            "--session",
            text(&of("session.toml")),
            "--rest-to-rest",
            "--low-pass",
            corner,
            "--out",
            text(&of(&format!("low-passed-{corner}.csv"))),
        ])
    };
    let few = decoupled("2");
    assert!(
        stderr(&few).contains("takes 100 % of the motion itself"),
        "{few:?}"
    );
    let usual = decoupled("22");
    assert!(
        !stderr(&usual).contains("of the motion itself"),
        "{usual:?}"
    );
}

/// Hundredths of a second of a run-up hardly move, and the gyroscope of a linear trial shows its noise in rest and motion alike.
#[test]
fn inv_rests_that_are_there_are_not_accused() {
    let at = std::cell::Cell::new(0_u32);
    for name in recordings()
        .iter()
        .filter(|name| name.starts_with("linear"))
    {
        rewritten(name, &format!("noisy-{name}"), |row| {
            let n = at.replace(at.get().wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
            row[10] = 1e-4 * (f64::from(n) / f64::from(u32::MAX) - 0.5);
        });
    }
    let (_, said) = calibrated("rests", |s| {
        s.replace("detrend = false", "detrend = { rest_s = 0.02 }")
            .replace("\"linear-", "\"noisy-linear-")
    });
    assert!(!said.contains("the standards move there"), "{said}");
}

/// Of every two rows the standards of the first and the limbs of the second: a converter whose channels come half a sample later, as the
/// session then says. Read between its samples, noise is smaller than it is, which must not count.
#[test]
fn inv_delays_that_are_stated_and_there_leave_a_good_day() {
    let folder = day();
    for name in recordings() {
        let record = fs::read_to_string(folder.join(&name)).expect("reads");
        let lines: Vec<&str> = record.lines().collect();
        let (heading, rows) = lines.split_at(2);
        let mut half = heading.join("\n").replace("= 500", "= 250") + "\n";
        for pair in rows.chunks_exact(2) {
            let [standards, limbs] =
                [pair[0], pair[1]].map(|row| row.split(',').collect::<Vec<_>>());
            half += &([&limbs[..9], &standards[9..]].concat().join(",") + "\n");
        }
        folder.write(&format!("half-{name}"), half);
    }
    let (code, said) = calibrated("half", |s| {
        renamed(s, "half").replace("[channels]\n", "[channels]\nlimbs_lag_us = -2000.0\n")
    });
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("by the joint fit"), "{said}");
}

/// No trial shows how long limbs are but in second order: the day was called good.
#[test]
fn neg_a_lost_decimal_point_in_a_length_is_a_reservation() {
    for (name, key, slipped) in [
        (
            "short-limbs",
            "limb_length_mm = 25.5",
            "limb_length_mm = 2.55",
        ),
        (
            "long-limbs",
            "limb_length_mm = 25.5",
            "limb_length_mm = 255.0",
        ),
    ] {
        let (code, said) = calibrated(name, |s| s.replace(key, slipped));
        assert_eq!(code, 3, "{name}: {said}");
        assert!(said.contains("check both against the drawing"), "{said}");
    }
    let (code, said) = calibrated("other-limbs", |s| {
        s.replace("limb_length_mm = 25.5", "limb_length_mm = 20.0")
    });
    assert_eq!(code, 0, "{said}");
    assert!(!said.contains("against the drawing"), "{said}");
}

/// What the runs are judged by needs their own low-pass, whatever that of the trials is.
#[test]
fn inv_validation_runs_keep_their_low_pass() {
    let (code, said) = calibrated("first-order", |s| s.replacen("order = 4", "order = 1", 1));
    assert!(matches!(code, 0 | 3), "{said}");
    assert!(!said.contains("compound-0"), "{said}");
}

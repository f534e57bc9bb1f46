//! Days of which one thing is wrong and much looks wrong: the one is named, and no other is accused of it.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::fs;
use std::process::Output;

use crate::mistakes::{calibrated, calibrated_in, reversed, rewritten, rewritten_in, with_entry};
use crate::program::{Folder, code, fed, gains, run, simulated, stderr, stdout, text};
use crate::self_calibrate::day;
use sixaxis_core::LIMBS;

/// Columns of the day's trials.
const ACCELEROMETER: usize = 9;
const GYROSCOPE: usize = 10;

/// The day's recordings whose names begin so.
fn of_kind(kind: &str) -> Vec<String> {
    let session = fs::read_to_string(day().0.join("session.toml")).expect("reads");
    let files = session.lines().filter_map(|line| {
        let name = line.strip_prefix("file = \"")?.strip_suffix('"')?;
        name.starts_with(kind).then(|| name.to_owned())
    });
    files.collect()
}

/// The session with these files' rewritten ones, of this name, in their place.
fn in_place(session: &str, files: impl Iterator<Item = impl AsRef<str>>, name: &str) -> String {
    files.fold(session.to_owned(), |session, file| {
        let file = file.as_ref();
        let rewritten = format!("file = \"{name}-{file}");
        session.replace(&format!("file = \"{file}"), &rewritten)
    })
}

#[test]
fn inv_a_sensitivity_that_steps_is_named_with_its_trial() {
    for kind in ["angular", "fast", "compound"] {
        for file in of_kind(kind) {
            rewritten(&file, &format!("stepped-{file}"), |row| row[3] *= 1.03);
        }
    }
    let (code, said) = calibrated("stepped", |s| {
        let kinds = ["angular", "fast", "compound"].into_iter();
        kinds.fold(s.to_owned(), |s, kind| {
            s.replace(
                &format!("file = \"{kind}"),
                &format!("file = \"stepped-{kind}"),
            )
        })
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("sensitivity changes over the day: all recordings; channel 4")
            && said.contains("steps by +2.")
            && said.contains("before stepped-angular-01.csv"),
        "{said}"
    );
    assert!(!said.contains("gyroscope against"), "{said}");
}

/// Inverted in the first trials and in all others but these fit alike: the sign of the design tells. One inverted trial among few spoils what the
/// four steps make of the others.
#[test]
fn inv_a_channel_that_is_inverted_in_some_trials_is_named_there() {
    let (linear, angular) = (of_kind("linear"), of_kind("angular"));
    for (name, files, channel) in [
        // It shows little there, and nothing else about the trial is odd.
        ("upside-alone", &angular[..1], 9),
        ("upside-first", &linear[..1], 3),
        ("upside-second", &linear[..2], 3),
        ("upside-last", &linear[linear.len() - 1..], 1),
    ] {
        for file in files {
            rewritten(file, &format!("{name}-{file}"), |row| {
                row[channel - 1] *= -1.0;
            });
        }
        let (code, said) = calibrated(name, |s| in_place(s, files.iter(), name));
        assert_eq!(code, 4, "{said}");
        let named = said.split("Found - ").nth(1).expect("a finding");
        let place = named.split_once(&format!("; channel {channel}"));
        let (named, _) = place.unwrap_or_else(|| panic!("{said}"));
        assert!(named.starts_with("channel inverted: upside-"), "{said}");
        assert_eq!(named.matches(".csv").count(), files.len(), "{said}");
        assert!(files.iter().all(|file| named.contains(file)), "{said}");
    }
}

/// A gain of all channels in one kind of trials is taken for the sensor's: only a run that was not fitted and does both tells.
#[test]
fn inv_a_gain_of_all_channels_that_is_another_in_one_kind_of_trials_is_named() {
    for (name, kinds, by, said_of) in [
        (
            "turned-up",
            &["angular"][..],
            1.02,
            "the angular trials were scaled otherwise than all others",
        ),
        (
            "both-turned-up",
            &["angular", "compound"],
            1.02,
            "the linear trials were scaled otherwise than all others",
        ),
        (
            "compound-turned-up",
            &["compound"],
            0.98,
            "scaled otherwise there than in the trials",
        ),
    ] {
        let files: Vec<String> = kinds.iter().flat_map(|kind| of_kind(kind)).collect();
        for file in &files {
            rewritten(file, &format!("{name}-{file}"), |row| {
                row[..LIMBS].iter_mut().for_each(|u| *u *= by);
            });
        }
        let (code, said) = calibrated(name, |s| in_place(s, files.iter(), name));
        assert_eq!(code, 4, "{said}");
        assert!(said.contains(said_of), "{said_of}: {said}");
    }
}

#[test]
fn inv_a_sensitivity_that_is_another_in_the_angular_trials_is_named() {
    let angular = of_kind("angular");
    for (name, channels) in [
        ("knocked", &[(5, 1.02)][..]),
        ("two-knocked", &[(2, 1.03), (7, 0.97)]),
    ] {
        for file in &angular {
            rewritten(file, &format!("{name}-{file}"), |row| {
                channels
                    .iter()
                    .for_each(|(channel, by)| row[*channel] *= by);
            });
        }
        let (code, said) = calibrated(name, |s| {
            s.replace("file = \"angular", &format!("file = \"{name}-angular"))
        });
        assert_eq!(code, 4, "{said}");
        assert!(
            said.contains(&format!(
                "sensitivity changes over the day: {name}-angular-01.csv"
            )),
            "{said}"
        );
        for (channel, by) in channels {
            let wanted = format!("channel {} {by:.2}", channel + 1);
            assert!(said.contains(&wanted), "{wanted}: {said}");
        }
    }
}

#[test]
fn neg_a_standard_that_is_off_in_trials_of_one_kind_is_told_by_the_rig() {
    let fast = of_kind("fast");
    for file in &fast {
        rewritten(file, &format!("off-{file}"), |row| {
            row[ACCELEROMETER] *= 1.02
        });
    }
    let (code, said) = calibrated("off-fast", |s| {
        s.replace("file = \"fast", "file = \"off-fast")
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("wrong unit or scaling: off-fast-01.csv")
            && said.contains("the standard accelerometer shows 1.0")
            && !said.contains("amplifier's range or not at all"),
        "{said}"
    );
}

#[test]
fn inv_a_tumble_that_begins_gently_begins_at_rest() {
    let (folder, said) = simulated("gentle", "--seed 31 --tumble 5 --trials 3");
    let gains = gains(&said);
    let session = folder.file("session.toml");
    let output = run(&["calibrate", &session, "--quiet"]);
    assert!(matches!(code(&output), 0 | 3), "{}", stderr(&output));
    let (calibration, tumble, out) = (
        folder.file("calibration.json"),
        folder.file("tumble.csv"),
        folder.file("o.csv"),
    );
    let output = run(&[
        "decouple",
        &calibration,
        &tumble,
        "--gain",
        &gains,
        "--down",
        "0,0,-1",
        "--out",
        &out,
    ]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let in_motion = |output: &Output| stderr(output).contains("begins in motion");
    assert!(!in_motion(&output), "{}", stderr(&output));
    // Nor as a stream of rows; one that begins in mid-motion mostly is told.
    let table = fs::read_to_string(&tumble).expect("reads");
    let rows = table
        .lines()
        .filter(|line| line.starts_with(|c: char| !c.is_alphabetic() && c != '#'));
    let limbs = |row: &str| row.split(',').take(9).collect::<Vec<_>>().join(",") + "\n";
    let rows: Vec<String> = rows.map(limbs).collect();
    let stream = [
        "decouple",
        &calibration,
        "-",
        "--rate",
        "10000",
        "--gain",
        &gains,
    ];
    let stream = [&stream[..], &["--down", "0,0,-1"]].concat();
    let output = fed(&stream, &rows.concat());
    assert!(
        code(&output) == 0 && !in_motion(&output),
        "{}",
        stderr(&output)
    );
    let from = |tenth: usize| fed(&stream, &rows[tenth * rows.len() / 10..].concat());
    assert!((3..8).any(|tenth| in_motion(&from(tenth))));
}

#[test]
fn neg_a_run_that_is_not_whole_is_told_from_one_that_fails() {
    let record = fs::read_to_string(day().0.join("compound-01.csv")).expect("reads");
    let rows: Vec<&str> = record.lines().collect();
    let two_thirds = rows[..rows.len() * 2 / 3].join("\n");
    let turns = |row: &str| -> f64 {
        let cell = row.split(',').nth(GYROSCOPE).expect("a gyroscope");
        cell.trim().parse().expect("a number")
    };
    let middle = rows.len() / 2..rows.len() * 2 / 3;
    let mut passes_zero = middle.filter(|i| turns(rows[*i]) * turns(rows[*i + 1]) <= 0.0);
    let turning_back = rows[..passes_zero.next().expect("swings")].join("\n");
    let mut gap = rows.clone();
    gap.drain(rows.len() / 3..rows.len() / 3 + 200);
    for (name, text, words) in [
        ("gap", gap.join("\n") + "\n", "jump at once after sample"),
        (
            "turns-back",
            turning_back + "\n",
            "it ends in motion, where the gyroscope reads",
        ),
        (
            "ends-early",
            two_thirds.clone() + "\n",
            "it ends in motion, where the gyroscope reads",
        ),
        (
            "breaks-off",
            two_thirds + "\n3.1,-4.4,-3.",
            "its last line breaks off after 3 of",
        ),
    ] {
        day().0.write(&format!("{name}.csv"), text);
        let (code, said) = calibrated(name, |s| s.replace("compound-01", name));
        assert_eq!(code, 4, "{said}");
        let wanted = format!("recording cannot be used: {name}.csv decoupled, it departs");
        assert!(said.contains(&wanted) && said.contains(words), "{said}");
        let advice = [
            "record the run whole",
            "record the run again, without a gap",
        ];
        assert!(advice.iter().any(|advice| said.contains(advice)), "{said}");
    }
}

/// Of the trials that are fitted, too: all others are fitted without it, and none is accused.
#[test]
fn neg_a_trial_that_is_cut_off_is_named() {
    for file in ["linear-03.csv", "angular-02.csv"] {
        let record = fs::read_to_string(day().0.join(file)).expect("reads");
        let rows: Vec<&str> = record.lines().collect();
        let cut = format!("cut-{file}");
        day()
            .0
            .write(&cut, rows[..rows.len() * 3 / 5].join("\n") + "\n");
        let (code, said) = calibrated(&format!("cut-{file}"), |s| s.replace(file, &cut));
        assert_eq!(code, 4, "{said}");
        let wanted = format!("recording cannot be used: {cut} not whole: from its last sample");
        assert!(
            said.contains(&wanted)
                && said.contains("determined by the joint fit")
                && !said.contains("also:"),
            "{said}"
        );
    }
}

#[test]
fn neg_standards_of_another_run_are_told_by_their_frequency() {
    let read = |file: &str| fs::read_to_string(day().0.join(file)).expect("reads");
    let files = ["linear-03.csv", "linear-04.csv"];
    for [own, other] in [files, [files[1], files[0]]] {
        let (own_rows, other_rows) = (read(own), read(other));
        let rows = own_rows
            .lines()
            .zip(other_rows.lines())
            .map(|(own, other)| {
                let own = own.split(',').take(ACCELEROMETER);
                let cells: Vec<&str> = own.chain(other.split(',').skip(ACCELEROMETER)).collect();
                cells.join(",")
            });
        let rows: Vec<String> = rows.collect();
        day()
            .0
            .write(&format!("crossed-{own}"), rows.join("\n") + "\n");
    }
    let (code, said) = calibrated("crossed", |s| in_place(s, files.iter(), "crossed"));
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("each turns as another of them should")
            && said.contains("determined by the joint fit")
            && !said.contains("also:"),
        "{said}"
    );
}

#[test]
fn neg_standards_that_are_held_are_not_cut_off() {
    for file in of_kind("linear") {
        let (count, held) = (Cell::new(0_usize), Cell::new(0.0));
        rewritten(&file, &format!("held-{file}"), |row| {
            if count.get().is_multiple_of(20) {
                held.set(row[ACCELEROMETER]);
            }
            count.set(count.get() + 1);
            row[ACCELEROMETER] = held.get();
        });
    }
    let (code, said) = calibrated("held", |s| {
        s.replace("file = \"linear", "file = \"held-linear")
    });
    assert_ne!(code, 0, "{said}");
    assert!(
        said.contains("each reading of the standard accelerometer stands there 20 times")
            && !said.contains("cut off"),
        "{said}"
    );
}

#[test]
fn neg_trials_of_the_other_kind_are_told_by_their_standards() {
    let (code, said) = calibrated("other-kind", |s| {
        s.replace("role = \"linear\"", "role = \"~\"")
            .replace("role = \"angular\"", "role = \"linear\"")
            .replace("role = \"~\"", "role = \"angular\"")
    });
    assert_ne!(code, 0, "{said}");
    assert!(
        said.contains("files or roles of linear and angular trials are"),
        "{said}"
    );
    // A standard that is not needed may show a hum, which is no motion of the drive's.
    let count = Cell::new(0_usize);
    rewritten("linear-01.csv", "humming.csv", |row| {
        count.set(count.get() + 1);
        row[GYROSCOPE] = if count.get() % 9 < 4 { 0.2 } else { -0.2 };
    });
    let (code, said) = calibrated("humming", |s| {
        with_entry(s, "linear-01", |entry| {
            entry
                .replace("linear-01.csv", "humming.csv")
                .replace("role = \"linear\"", "role = \"angular\"")
        })
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("humming.csv the nine channels move as stated, and of the standards only"),
        "{said}"
    );
}

#[test]
fn neg_a_clipped_gyroscope_accuses_no_other_recording() {
    // A sensor whose compound runs depart by a quarter from what its one whole angular trial makes one expect.
    let (folder, _) = simulated("clipped-gyroscope", "--sensor random --seed 88005");
    let angular: Vec<String> = (2..=10).map(|k| format!("angular-{k:02}.csv")).collect();
    for file in &angular {
        rewritten_in(&folder, file, &format!("clipped-{file}"), |row| {
            row[GYROSCOPE] = row[GYROSCOPE].clamp(-11.0, 11.0);
        });
    }
    let (code, said) = calibrated_in(&folder, "clipped-gyroscope", |s| {
        let files = angular.iter();
        files.fold(s.to_owned(), |s, file| {
            s.replace(file, &format!("clipped-{file}"))
        })
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("the standard gyroscope is cut off") && !said.contains("also:"),
        "{said}"
    );
}

#[test]
fn neg_a_static_record_in_millivolts_is_told_from_the_zeros() {
    rewritten("static.csv", "static-mv.csv", |row| {
        row.iter_mut().for_each(|x| *x *= 1000.0);
    });
    let (code, said) = calibrated("static-mv", |s| s.replace("static.csv", "static-mv.csv"));
    assert_eq!(code, 1, "{said}");
    assert!(
        said.contains("volts and millivolts mixed up: static-mv.csv")
            && said.contains("times the zeros of the linear trials"),
        "{said}"
    );
}

#[test]
fn neg_another_zero_at_rest_is_no_drift_of_the_runs() {
    rewritten("static.csv", "static-elsewhere.csv", |row| {
        row.iter_mut().for_each(|x| *x += 0.05);
    });
    let (code, said) = calibrated("static-elsewhere", |s| {
        s.replace("static.csv", "static-elsewhere.csv")
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("recording cannot be used in static-elsewhere.csv.")
            && !said.contains("zero drifts"),
        "{said}"
    );
}

#[test]
fn neg_down_that_is_up_is_told() {
    let folder = Folder::new("level");
    let plan = folder.write(
        "plan.toml",
        "seed = 640111\nsensor = \"random\"\nengine = \"rigid\"\n[rig]\nmounting = \"axis_level\"\n",
    );
    let level = Folder::new("level-day");
    let simulated = run(&["simulate", "--plan", &plan, "--out", text(&level)]);
    assert_eq!(code(&simulated), 0, "{}", stderr(&simulated));
    let (code, said) = calibrated_in(&level, "upside-down", |s| reversed(s, "down"));
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("Not good: gravity not handled.")
            && said.contains("with every `down` the other way round all trials agree"),
        "{said}"
    );
    let (code, said) = calibrated_in(&level, "without-down", |s| {
        let lines = s.lines().filter(|line| !line.starts_with("down = ["));
        lines.map(|line| format!("{line}\n")).collect()
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("Not good: gravity not handled in angular-01.csv and")
            && said.contains("state where down was with `down`"),
        "{said}"
    );
    // A weight that turns is not reversed with a standard.
    for (name, role, standard) in [
        (
            "gyroscope-reversed",
            "\"angular\"",
            "the standard gyroscope",
        ),
        (
            "all-reversed",
            "",
            "both standards, or all directions but `down`,",
        ),
    ] {
        let (code, said) = calibrated_in(&level, name, |s| {
            with_entry(s, role, |entry| reversed(entry, "direction"))
        });
        assert!(matches!(code, 1 | 4), "{said}");
        let words = format!("with {standard} reversed all trials agree");
        assert!(said.contains(&words), "{said}");
    }
}

#[test]
fn neg_an_integrated_gyroscope_is_no_clock() {
    rewritten("angular-03.csv", "integrated.csv", |row| {
        row[GYROSCOPE] /= 9.8
    });
    let (code, said) = calibrated("integrated", |s| s.replace("angular-03", "integrated"));
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("wrong unit or scaling: integrated.csv") && !said.contains("g and m/s²"),
        "{said}"
    );
}

#[test]
fn neg_what_the_session_says_of_files_is_told_by_its_key() {
    let (code, said) = calibrated("contradicted", |s| {
        s.replace("[channels]", "[channels]\nlimbs_unit = \"mV\"")
    });
    assert_eq!(code, 1, "{said}");
    assert!(
        said.contains("the file says \"V\", and stated is \"mV\"")
            && said.contains("take the unit out of the session's [channels]"),
        "{said}"
    );
    // Where nothing was read, it is no news that nothing moves.
    assert!(!said.contains("axis not excited"), "{said}");
    let (_, said) = calibrated("no-reference", |s| {
        with_entry(s, "linear-01", |entry| {
            format!("{entry}\nreference_file = \"none.csv\"\nreference_sample_rate_hz = 1000.0\n")
        })
    });
    assert!(said.contains("correct `reference_file`"), "{said}");
    let (code, said) = calibrated("range-in-mv", |s| {
        let lines = s
            .lines()
            .map(|line| match line.starts_with("full_scale_v") {
                true => "full_scale_v = 10000.0\n".to_owned(),
                false => format!("{line}\n"),
            });
        lines.collect()
    });
    assert_eq!(code, 1, "{said}");
    assert!(
        said.contains("sensor.full_scale_v") && said.contains("in volts"),
        "{said}"
    );
}

#[test]
fn neg_a_limb_that_is_missing_is_not_looked_for_among_others() {
    let record = fs::read_to_string(day().0.join("linear-01.csv")).expect("reads");
    let named = record.replacen("u2", "u1", 1);
    assert_ne!(named, record);
    let path = day().0.write("no-u2.csv", named);
    let said = stdout(&run(&["inspect", &path]));
    assert!(!said.contains("nine limbs (u1"), "{said}");
    // Which of two columns is u1 nobody says.
    assert!(said.contains("are in this file and u1, u2 not"), "{said}");
    let output = run(&["inspect", &path, "--strict"]);
    assert_ne!(code(&output), 0, "{}", stdout(&output));
}

#[test]
fn neg_motions_of_unequal_length_are_told() {
    let truth = day().0.join("truth").join("linear-01.csv");
    let record = fs::read_to_string(&truth).expect("reads");
    let rows: Vec<&str> = record.lines().collect();
    let half = day()
        .0
        .write("half.csv", rows[..rows.len() / 2].join("\n") + "\n");
    let page = day().0.file("half.html");
    let compared = |a: &str, b: &str| stderr(&run(&["compare", a, b, "--out", &page]));
    let whole = text(&truth);
    for (a, b) in [(half.as_str(), whole), (whole, half.as_str())] {
        let said = compared(a, b);
        assert!(
            said.contains("more instants after the other's end"),
            "{said}"
        );
    }
    let said = compared(whole, whole);
    assert!(!said.contains("instants after"), "{said}");
}

/// All recordings of the day with voltages in whole steps, V, calibrated.
fn rounded(step_v: f64) -> (i32, String) {
    let name = format!("in-steps-of-{step_v}");
    let kinds = ["static", "linear", "angular", "fast", "compound"];
    for file in kinds.iter().flat_map(|kind| of_kind(kind)) {
        rewritten(&file, &format!("{name}-{file}"), |row| {
            for u in &mut row[..ACCELEROMETER] {
                *u = (*u / step_v).round() * step_v;
            }
        });
    }
    calibrated(&name, |s| {
        s.replace("file = \"", &format!("file = \"{name}-"))
    })
}

#[test]
fn neg_a_coarse_converter_does_not_clip() {
    // 8 bits: the broad tops of a crank with a short rod stay within a step for many samples.
    let (_, said) = rounded(10.0 / 128.0);
    assert!(!said.contains("converter clips"), "{said}");
    // Rounding drowns what is left of two runs.
    let (code, said) = rounded(10.0 / 160.0);
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("Not good: noise or rounding too large in ")
            && said.contains("in steps of 0.062 V"),
        "{said}"
    );
}

#[test]
fn inv_a_channel_that_is_late_in_one_trial_is_named_with_it() {
    const LATE: usize = 10;
    let queue = RefCell::new(VecDeque::new());
    rewritten("linear-04.csv", "late-linear-04.csv", |row| {
        let mut queue = queue.borrow_mut();
        queue.push_back(row[6]);
        row[6] = queue[0];
        if queue.len() > LATE {
            queue.pop_front();
        }
    });
    let (code, said) = calibrated("late", |s| {
        s.replace("\"linear-04.csv", "\"late-linear-04.csv")
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("Not good: clocks disagree in late-linear-04.csv.")
            && said.contains("late-linear-04.csv; channel 7")
            && said.contains("behind the other channels, in this trial alone"),
        "{said}"
    );
}

#[test]
fn neg_a_filtered_run_that_ends_at_rest_does_not_end_in_motion() {
    let [calibration, session, run_csv, out] = [
        "calibration.json",
        "session.toml",
        "compound-01.csv",
        "filtered.csv",
    ]
    .map(|name| day().0.file(name));
    let output = run(&[
        "decouple",
        &calibration,
        &run_csv,
        "--session",
        &session,
        "--low-pass",
        "30",
        "--rest-to-rest",
        "--out",
        &out,
    ]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(
        !stderr(&output).contains("in motion"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn neg_a_drive_that_never_started_is_told() {
    const RESTS: usize = 50;
    let [record, rest] = ["linear-03.csv", "static.csv"]
        .map(|name| fs::read_to_string(day().0.join(name)).expect("reads"));
    let is_row = |line: &&str| line.split(',').all(|cell| cell.parse::<f64>().is_ok());
    let head = record.lines().filter(|line| !is_row(line));
    let standards: Vec<&str> = record
        .lines()
        .filter(is_row)
        .map(|row| {
            row.splitn(ACCELEROMETER + 1, ',')
                .last()
                .expect("standards")
        })
        .collect();
    let rows = rest
        .lines()
        .filter(is_row)
        .zip(standards[..RESTS].iter().cycle())
        .take(standards.len())
        .map(|(limbs, standards)| format!("{limbs},{standards}"));
    let text: Vec<String> = head.map(str::to_owned).chain(rows).collect();
    day().0.write("never-started.csv", text.join("\n") + "\n");
    let (code, said) = calibrated("never-started", |s| s.replace("linear-03", "never-started"));
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("recording cannot be used: never-started.csv nothing moves")
            && !said.contains("clocks disagree"),
        "{said}"
    );
}

#[test]
fn neg_a_standard_that_is_off_in_few_trials_is_told_by_rig_and_limbs() {
    let (folder, _) = simulated("few-trials", "--seed 734512 --trials 6");
    let fast: Vec<String> = (1..=6).map(|k| format!("fast-{k:02}.csv")).collect();
    for file in &fast {
        rewritten_in(&folder, file, &format!("off-{file}"), |row| {
            row[ACCELEROMETER] *= 1.03;
        });
    }
    let (code, said) = calibrated_in(&folder, "off-fast", |s| {
        s.replace("file = \"fast", "file = \"off-fast")
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("wrong unit or scaling: off-fast-01.csv")
            && said.contains("the standard accelerometer shows 1.0"),
        "{said}"
    );
}

/// Rows of the day's recording of that name, with channel 3 half a sample late, as a recorder's interpolation leaves it.
fn half_a_sample_late(file: &str, name: &str) {
    let before = Cell::new(None);
    rewritten(file, name, |row| {
        let now = row[2];
        row[2] = 0.5 * (now + before.replace(Some(now)).unwrap_or(now));
    });
}

#[test]
fn inv_a_late_channel_is_named_although_its_noise_is_not_white() {
    let kinds = ["linear", "angular", "fast", "compound"];
    for file in kinds.iter().flat_map(|kind| of_kind(kind)) {
        half_a_sample_late(&file, &format!("late-{file}"));
    }
    let (code, said) = calibrated("half-late", |s| {
        kinds.iter().fold(s.to_owned(), |s, kind| {
            s.replace(
                &format!("file = \"{kind}"),
                &format!("file = \"late-{kind}"),
            )
        })
    });
    assert_eq!(code, 4, "{said}");
    assert!(
        said.contains("clocks disagree: all recordings; channel 3")
            && said.contains("noise that is not white"),
        "{said}"
    );
}

/// The day's recordings with something added to the channels, calibrated; `noise` is white.
fn with_added(name: &str, add: impl Fn(&mut [f64], &mut dyn FnMut() -> f64)) -> (i32, String) {
    let mut state = 7_u64;
    let mut noise = || {
        let twelve = (0..12).map(|_| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        });
        twelve.sum::<f64>()
    };
    let kinds = ["static", "linear", "angular", "fast", "compound"];
    for file in kinds.iter().flat_map(|kind| of_kind(kind)) {
        let noise = RefCell::new(&mut noise);
        rewritten(&file, &format!("{name}-{file}"), |row| {
            add(row, &mut || noise.borrow_mut()());
        });
    }
    calibrated(name, |s| {
        s.replace("file = \"", &format!("file = \"{name}-"))
    })
}

/// As a converter that oversamples leaves it, or an amplifier's filter: less at high frequencies, from which noise is told.
#[test]
fn neg_noise_that_is_not_white_is_no_contradiction() {
    let held = RefCell::new([0.0; LIMBS]);
    let (code, said) = with_added("coloured", |row, noise| {
        for (u, held) in row.iter_mut().zip(held.borrow_mut().iter_mut()) {
            *held += 0.5 * (noise() - *held);
            *u += 0.02 * *held;
        }
    });
    assert_eq!(code, 0, "{said}");
}

/// A cable that gives a little voltage as it turns along is in no model, and hardly matters: that is a reservation.
#[test]
fn inv_a_contradiction_that_hardly_matters_is_a_reservation() {
    let (code, said) = with_added("cable", |row, _| {
        if let Some(rate) = row.get(GYROSCOPE).copied() {
            for (limb, u) in row[..ACCELEROMETER].iter_mut().enumerate() {
                *u += 3e-5 * rate * (limb as f64 - 4.0);
            }
        }
    });
    assert_eq!(code, 3, "{said}");
    assert!(
        said.contains("have been made") && !said.contains("those of the four steps"),
        "{said}"
    );
}

#[test]
fn inv_a_clock_that_the_rig_contradicts_is_no_other_frequency() {
    let original = day().0.join("linear-05.csv");
    let original = fs::read_to_string(original).expect("reads");
    let fast = original.replacen("sample_rate_hz = 2000", "sample_rate_hz = 2500", 1);
    assert_ne!(original, fast);
    fs::write(day().0.join("fast-clock.csv"), fast).expect("writes");
    let (code, said) = calibrated("fast-clock", |s| {
        s.replace("file = \"linear-05", "file = \"fast-clock")
    });
    assert_eq!(code, 3, "{said}");
    assert!(
        said.contains("fast-clock.csv: the standards move at")
            && said.contains("at the stated frequency: correct sample_rate_hz")
            && !said.contains("correct frequency_hz"),
        "{said}"
    );
}

//! Where the command writes: never over what it reads, and in words where it cannot.

use std::fs::{self, File};
use std::process::{Command, Stdio};

use crate::program::{Folder, code, done, run, sixaxis, stderr, stdout};

/// A decoupled recording of a few samples.
const DECOUPLED: &str = "time,ax,ay,az,alpha_x,alpha_y,alpha_z\ns,m/s^2,m/s^2,m/s^2,rad/s^2,rad/s^2,rad/s^2\n\
    0.000,0,1,2,3,4,5\n0.001,1,2,3,4,5,6\n0.002,2,3,4,5,6,7\n0.003,1,2,3,4,5,6\n";

#[test]
fn neg_a_comparison_writes_over_nothing_that_it_reads() {
    let folder = Folder::new("compare_outputs");
    let (a, b) = (folder.file("a.csv"), folder.file("b.csv"));
    for file in [&a, &b] {
        fs::write(file, DECOUPLED).expect("writes");
    }
    let page = folder.file("page.html");
    done(&["compare", &a, &b, "--out", &page]);
    for outputs in [
        &["--out", &a][..],
        &["--out", &b],
        &["--out", &page, "--json", &a],
        &["--out", &page, "--json", &page],
    ] {
        let said = run(&[&["compare", &a, &b][..], outputs].concat());
        assert_eq!(code(&said), 1, "{outputs:?}");
        for file in [&a, &b] {
            assert_eq!(fs::read_to_string(file).expect("reads"), DECOUPLED);
        }
    }
}

/// A shell's list of files gives an option the first of them, and another recording of a day is not to be had again.
#[test]
fn neg_no_page_and_no_result_is_written_over_a_recording_or_a_calibration() {
    let (folder, gains) = crate::self_calibrate::day();
    let at = |name: &str| folder.file(name);
    let (calibration, tumble) = (at("calibration.json"), at("tumble.csv"));
    let (first, second) = (at("linear-01.csv"), at("linear-02.csv"));
    let session = at("session.toml");
    let before = fs::read(&first).expect("reads");
    let decouple = [
        "decouple",
        &calibration,
        &tumble,
        "--gain",
        gains,
        "--down",
        "0,0,-1",
    ];
    let check = ["self-calibrate", &calibration, &tumble, "--gain", gains];
    let other = at("other.json");
    fs::copy(&calibration, &other).expect("copies");
    for arguments in [
        [&["inspect", "--picture", &first, &second][..], &[]],
        [&decouple, &["--picture", &first, "--out", &at("o.csv")]],
        [&decouple, &["--out", &first]],
        [&["calibrate", &session][..], &["--report", &first]],
        [&["calibrate", &session][..], &["--out", &first]],
        [&["compare", &second, &second][..], &["--json", &first]],
        [&check, &["--out", &first]],
        [&check, &["--out", &other]],
    ] {
        let said = run(&arguments.concat());
        assert_eq!(code(&said), 1, "{arguments:?}: {}", stderr(&said));
        assert_eq!(fs::read(&first).expect("reads"), before, "{arguments:?}");
    }
    assert_eq!(
        fs::read(&other).expect("reads"),
        fs::read(&calibration).expect("reads")
    );
    // A result may be replaced.
    for _ in 0..2 {
        done(&[&decouple[..], &["--out", &at("replaced.csv")]].concat());
    }
}

/// What a file is called, and what it holds, moves no cursor and rings no bell.
#[test]
fn neg_no_name_commands_the_terminal() {
    let folder = Folder::new("terminal");
    let hostile = ["\u{1b}[2J", "\u{7}", "\u{9b}2J", "\u{202e}"];
    for (at, hostile) in hostile.iter().enumerate() {
        let file = folder.file(&format!("{at}{hostile}.csv"));
        fs::write(
            &file,
            format!("time,u{hostile}1\ns,V{hostile}\n0,1\n1,x\n2,3\n"),
        )
        .expect("writes");
        for arguments in [
            &["inspect", &file][..],
            &["inspect", "--json", &file],
            &["compare", &file, &file],
            &["decouple", &file, &file],
            &["calibrate", &file],
        ] {
            let said = run(arguments);
            let words = stdout(&said) + &stderr(&said);
            assert!(
                !words.is_empty() && !words.contains(hostile),
                "{arguments:?}: {words:?}"
            );
        }
    }
    // Nor do words of the command line that are not understood, nor are they repeated at any length.
    for hostile in hostile {
        for word in [
            hostile.to_owned(),
            format!("--{hostile}"),
            hostile.repeat(20_000),
        ] {
            for said in [
                run(&[&word]),
                run(&["decouple", &word]),
                run(&["simulate", "--seed", &word]),
            ] {
                let words = stderr(&said);
                assert!(
                    (1..=2).contains(&code(&said)) && words.len() < 20_000,
                    "{word:.20?}"
                );
                assert!(!words.contains(hostile), "{words:.300?}");
            }
        }
    }
    // Twenty thousand columns are not all listed in an error.
    let wide = folder.file("wide.csv");
    let names: Vec<String> = (0..20_000).map(|n| format!("column{n}")).collect();
    fs::write(&wide, names.join(",") + "\n").expect("writes");
    let said = run(&["compare", &wide, &wide]);
    assert_eq!(code(&said), 1);
    assert!(stderr(&said).len() < 20_000, "{}", stderr(&said).len());
}

/// `compare --help` says how to come by what is compared.
#[test]
fn inv_the_example_of_compare_runs() {
    let folder = Folder::new("compare_example");
    let help = stdout(&done(&["compare", "--help"]));
    let example = help.split("Example:\n").nth(1).expect("an example");
    // The same day in a closed form takes a hundredth of the time.
    let lines = example.replace("simulate", "simulate --engine rigid");
    let output = Command::new("bash")
        .args([
            "-ec",
            &format!("sixaxis() {{ \"$SIXAXIS\" \"$@\"; }}\n{lines}"),
        ])
        .env("SIXAXIS", env!("CARGO_BIN_EXE_sixaxis"))
        .current_dir(&*folder)
        .output()
        .expect("bash starts");
    assert!(output.status.success(), "{}", stderr(&output));
}

#[cfg(target_os = "linux")]
#[test]
fn neg_standard_output_that_takes_nothing_is_an_error_in_words() {
    let folder = Folder::new("full_output");
    let a = folder.file("a.csv");
    fs::write(&a, DECOUPLED).expect("writes");
    let page = folder.file("page.html");
    let mut asked = vec![
        vec!["simulate", "--print-plan"],
        vec!["compare", &a, &a, "--out", &page],
        vec!["man"],
        vec![],
        vec!["--help"],
        vec!["campaign", "run", "--help"],
        vec!["--version"],
    ];
    let model = folder.file("model.xml");
    if cfg!(feature = "harness") {
        asked.push(vec!["model", "--out", &model]);
    }
    for arguments in asked {
        let full = File::create("/dev/full").expect("opens");
        let said = sixaxis().args(&arguments).stdout(full).output();
        let said = said.expect("the program starts");
        assert_eq!(code(&said), 1, "{arguments:?}");
        let words = stderr(&said);
        assert!(
            words.starts_with("error: cannot write to standard output"),
            "{arguments:?}: {words}"
        );
        // A reader that has gone away is no error.
        let mut gone = sixaxis();
        gone.args(&arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut gone = gone.spawn().expect("the program starts");
        drop(gone.stdout.take());
        let said = gone.wait_with_output().expect("it ends");
        assert_eq!(code(&said), 0, "{arguments:?}: {}", stderr(&said));
    }
}

/// Standard error that cannot be written, or that nobody reads, costs no result and no exit code.
#[test]
fn regress_messages_that_cannot_be_printed_cost_nothing() {
    let folder = Folder::new("mute");
    let (a, out) = (folder.file("a.csv"), folder.file("page.html"));
    fs::write(&a, DECOUPLED).expect("writes");
    let missing = folder.file("missing.csv");
    let done = ["compare", &a, &a, "--out", &out];
    let failed = ["inspect", &a, &missing];
    for (arguments, expected) in [(&done[..], 0), (&failed[..], 1)] {
        let full = File::create("/dev/full").expect("opens");
        let said = sixaxis().args(arguments).stderr(full).output();
        assert_eq!(
            code(&said.expect("the program starts")),
            expected,
            "{arguments:?}"
        );
        let mut gone = sixaxis();
        gone.args(arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut gone = gone.spawn().expect("the program starts");
        drop(gone.stderr.take());
        let ended = gone.wait().expect("it ends");
        assert_eq!(ended.code(), Some(expected), "{arguments:?}");
    }
    assert!(fs::exists(&out).expect("looks"));
}

/// Numbers whose squares are none are no motion, and no table of `inf` with exit code 0.
#[test]
fn neg_what_is_no_motion_is_not_compared() {
    let folder = Folder::new("no_motion");
    let (a, b) = (folder.file("a.csv"), folder.file("b.csv"));
    fs::write(&a, DECOUPLED).expect("writes");
    fs::write(&b, DECOUPLED.replace("0.002,2,", "0.002,1e307,")).expect("writes");
    for asked in [["compare", &a, &b], ["compare", &b, &a]] {
        let said = run(&[&asked[..], &["--out", &folder.file("page.html")]].concat());
        assert_eq!(code(&said), 1, "{}", stdout(&said));
        assert!(
            stderr(&said).contains("1e307 in SI units is no motion's"),
            "{}",
            stderr(&said)
        );
    }
}

/// A folder that is made for an output is named, one that is there is not.
#[test]
fn inv_folders_are_not_made_in_silence() {
    let folder = Folder::new("made_folders");
    let a = folder.file("a.csv");
    fs::write(&a, DECOUPLED).expect("writes");
    let page = folder.file("new/deep/page.html");
    let asked = ["compare", &a, &a, "--out", &page];
    let words = stderr(&done(&asked));
    let line = format!(
        "note: --out: the folder {} is not there and will be made\n",
        folder.file("new/deep")
    );
    assert!(words.contains(&line), "{words}");
    assert!(!stderr(&done(&asked)).contains("will be made"));
    let quick = ["--engine", "rigid", "--trials", "3", "--rate", "200"];
    let simulate = |out: &str| {
        let out = folder.file(out);
        stderr(&done(&[&["simulate", "--out", &out][..], &quick].concat()))
    };
    assert!(simulate("days/first").contains("days is not there and will be made"));
    assert!(!simulate("days/second").contains("will be made"));
}

/// Of two that would write into one folder the second is refused, and the first wins as a whole.
#[cfg(target_os = "linux")]
#[test]
fn neg_two_do_not_write_into_one_folder() {
    let folder = Folder::new("two_in_one");
    let day = folder.join("day");
    fs::create_dir(&day).expect("a folder");
    let quick = [
        "simulate", "--engine", "rigid", "--trials", "3", "--rate", "200", "--force",
    ];
    let second = || run(&[&quick[..], &["--out", &folder.file("day")]].concat());
    let first = File::open(&day).expect("opens");
    first.lock().expect("locks");
    let said = second();
    assert_eq!(code(&said), 1);
    let words = stderr(&said);
    assert!(
        words.contains("another run is writing into this folder"),
        "{words}"
    );
    assert_eq!(fs::read_dir(&day).expect("lists").count(), 0);
    // However the first one ends, its lock ends with it.
    drop(first);
    assert_eq!(code(&second()), 0);
    // At once, in earnest: each file is of one and the same run.
    let mut begun: Vec<_> = ["8", "9"]
        .iter()
        .map(|seed| {
            let mut command = sixaxis();
            command
                .args(quick)
                .args(["--out", &folder.file("day"), "--seed", seed]);
            (
                seed,
                command
                    .stderr(Stdio::null())
                    .stdout(Stdio::null())
                    .spawn()
                    .expect("starts"),
            )
        })
        .collect();
    let won: Vec<_> = begun
        .iter_mut()
        .filter_map(|(seed, child)| child.wait().expect("ends").success().then_some(**seed))
        .collect();
    let last = won.last().expect("one of them wins");
    let alone = folder.file("alone");
    done(&[&quick[..], &["--out", &alone, "--seed", last]].concat());
    // Where both were done, one after the other, the files are the later one's: of one of the two seeds, all.
    let same = |seed_folder: &str| {
        fs::read_dir(seed_folder)
            .expect("lists")
            .flatten()
            .filter(|e| e.path().is_file())
            .all(|entry| fs::read(entry.path()).ok() == fs::read(day.join(entry.file_name())).ok())
    };
    let other = folder.file("other");
    if won.len() == 2 {
        done(&[&quick[..], &["--out", &other, "--seed", won[0]]].concat());
    }
    assert!(same(&alone) || (won.len() == 2 && same(&other)));
}

/// Firmware would take in JSON, or `decouple` a Rust source.
#[test]
fn neg_no_calibration_is_named_as_what_it_is_not() {
    let session = crate::self_calibrate::day().0.file("session.toml");
    let folder = Folder::new("named_otherwise");
    for (name, format, words) in [
        (
            "x.json",
            "rust",
            "a Rust source is written; leave --format out",
        ),
        ("x.rs", "json", "written as JSON; add --format rust"),
        (
            "x.html",
            "json",
            "the name of a page and not of a calibration",
        ),
        (
            "x.htm",
            "rust",
            "the name of a page and not of a calibration",
        ),
    ] {
        let out = folder.file(name);
        let said = run(&["calibrate", &session, "--format", format, "--out", &out]);
        assert_eq!(code(&said), 2, "{name}: {}", stderr(&said));
        assert!(stderr(&said).contains(words), "{name}: {}", stderr(&said));
        assert!(!fs::exists(&out).expect("looks"), "{name}");
    }
}

//! `sixaxis decouple` and `sixaxis compare` as a user meets them: the program itself, from files to files.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use sixaxis_calibration::calibration::Calibration;
use sixaxis_calibration::verdict::Grade;
use sixaxis_recordings::{Block, Channel, Layout, create, open};

/// Names of the limbs in a simulated session.
const LIMBS: [&str; 9] = ["u1", "u2", "u3", "u4", "u5", "u6", "u7", "u8", "u9"];

fn sixaxis() -> Command {
    Command::new(env!("CARGO_BIN_EXE_sixaxis"))
}

fn run(arguments: &[&str]) -> Output {
    sixaxis().args(arguments).output().expect("starts")
}

fn done(arguments: &[&str]) -> Output {
    let output = run(arguments);
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        errors(&output)
    );
    output
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path of plain letters")
}

/// A simulated and calibrated session, made once.
fn session() -> &'static Path {
    static SESSION: OnceLock<PathBuf> = OnceLock::new();
    SESSION.get_or_init(|| {
        let folder = folder("session");
        done(&["simulate", "--out", text(&folder), "--seed", "3"]);
        let path = folder.join("calibration.json");
        let toml = folder.join("session.toml");
        let calibrated = run(&["calibrate", text(&toml), "--out", text(&path)]);
        assert!(
            matches!(calibrated.status.code(), Some(0 | 3)),
            "{}",
            errors(&calibrated)
        );
        // What the verdict does is tested by itself; here it is good.
        let mut calibration = Calibration::read(&path).expect("a calibration");
        calibration.verdict = Grade::Good;
        calibration.write(&path).expect("writes");
        folder
    })
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("decouple")
        .join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("makes a folder");
    folder
}

fn calibration() -> String {
    text(&session().join("calibration.json")).to_owned()
}

/// Recording of a compound run, whatever its format.
fn compound() -> PathBuf {
    let entries = std::fs::read_dir(session()).expect("lists");
    entries
        .map(|entry| entry.expect("an entry").path())
        .find(|path| path.file_stem().is_some_and(|stem| stem == "compound-03"))
        .expect("the session has it")
}

/// Columns of a file by their names, and its rate.
fn columns(path: &Path, names: &[&str]) -> (Vec<Vec<f64>>, Option<f64>) {
    let mut source = open(path).expect("opens");
    let layout = source.layout().clone();
    let indices: Vec<usize> = names
        .iter()
        .map(|name| {
            let by_group = |c: &Channel| c.name.rsplit('/').next() == Some(name);
            layout
                .channels
                .iter()
                .position(by_group)
                .expect("a channel")
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

fn write(path: &Path, names: &[&str], unit: &str, columns: &[Vec<f64>], rate_hz: f64) {
    let channels = names.iter().map(|name| Channel {
        sample_rate_hz: Some(rate_hz),
        ..Channel::new(*name, Some(unit))
    });
    let layout = Layout {
        channels: channels.collect(),
        ..Layout::default()
    };
    let mut sink = create(path, &layout).expect("creates");
    sink.write(&Block {
        columns: columns.to_vec(),
    })
    .expect("writes");
    sink.finish().expect("finishes");
}

/// Voltages of the compound run and its rate.
fn voltages() -> (Vec<Vec<f64>>, f64) {
    let (columns, rate) = columns(&compound(), &LIMBS);
    (columns, rate.expect("a rate"))
}

const ACCELERATIONS: [&str; 6] = ["ax", "ay", "az", "alpha_x", "alpha_y", "alpha_z"];

fn largest_errors(result: &Path, truth: &Path) -> Vec<f64> {
    let json = result.with_extension("json");
    let page = result.with_extension("html");
    done(&[
        "compare",
        text(result),
        text(truth),
        "--out",
        text(&page),
        "--json",
        text(&json),
    ]);
    let html = std::fs::read_to_string(page).expect("a page");
    assert!(html.contains("Decoupled motion against the truth"));
    let figures: serde_json::Value =
        serde_json::from_slice(&std::fs::read(json).expect("figures")).expect("is JSON");
    figures["axes"].as_array().expect("axes")[..6]
        .iter()
        .map(|axis| axis["largest_error_percent"].as_f64().expect("a figure"))
        .collect()
}

#[test]
fn ref_a_compound_run_comes_out_as_it_was() {
    let folder = folder("compound");
    let recording = compound();
    let truth = session()
        .join("truth")
        .join(recording.file_name().expect("a name"));
    let toml = session().join("session.toml");
    let out = folder.join("run.parquet");
    let picture = folder.join("picture.html");
    let mut arguments = vec![
        "decouple".to_owned(),
        calibration(),
        text(&recording).to_owned(),
    ];
    for argument in ["--close", "--low-pass", "60", "--out", text(&out)] {
        arguments.push(argument.to_owned());
    }
    let plain: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let with_session = [
        plain.as_slice(),
        &["--session", text(&toml), "--picture", text(&picture)],
    ]
    .concat();
    done(&with_session);
    // The class of the standards is 1 %, and the noise is a laboratory's.
    let errors_percent = largest_errors(&out, &truth);
    assert!(
        errors_percent.iter().all(|e| *e < 4.0),
        "{errors_percent:?}"
    );
    assert!(picture.is_file());
    // Other gains than those of the recording: the same comparison must fail.
    let output = run(&[plain.as_slice(), &["--gain", "0.4"]].concat());
    if output.status.success() {
        let errors_percent = largest_errors(&out, &truth);
        assert!(
            errors_percent.iter().any(|e| *e > 20.0),
            "{errors_percent:?}"
        );
    } else {
        assert!(
            errors(&output).contains("has run away"),
            "{}",
            errors(&output)
        );
    }
}

#[test]
fn inv_formats_streams_and_columns_agree() {
    let folder = folder("formats");
    let calibration = calibration();
    let (volts, rate_hz) = voltages();
    let recording = folder.join("run.csv");
    let millivolts: Vec<Vec<f64>> = volts
        .iter()
        .map(|c| c.iter().map(|u| 1e3 * u).collect())
        .collect();
    write(&recording, &LIMBS, "mV", &millivolts, rate_hz);
    let gain = ["--gain", "0.4"];
    let decouple = |out: &Path, more: &[&str]| {
        let first = [
            "decouple",
            &calibration,
            text(&recording),
            "--out",
            text(out),
        ];
        done(&[&first[..], &gain, more].concat())
    };
    let names = [
        "time", "ax", "ay", "az", "alpha_x", "alpha_y", "alpha_z", "wx", "qw",
    ];
    let csv = folder.join("a.csv");
    decouple(&csv, &[]);
    let (expected, rate) = columns(&csv, &names);
    assert_eq!(rate, Some(rate_hz));
    assert_eq!(expected[0].len(), volts[0].len() - 2);
    // The first row is that of sample 1.
    assert_eq!(expected[0][0], 1.0 / rate_hz);
    for extension in ["csv.gz", "parquet", "npz", "tdms"] {
        let out = folder.join(format!("a.{extension}"));
        decouple(&out, &[]);
        assert_eq!(columns(&out, &names).0, expected, "{extension}");
    }
    let six = folder.join("six.parquet");
    decouple(&six, &["--accelerations"]);
    let (found, _) = columns(&six, &ACCELERATIONS);
    for (found, expected) in found.iter().zip(&expected[1..7]) {
        let peak = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let apart = found
            .iter()
            .zip(expected)
            .fold(0.0_f64, |a, (x, y)| a.max((x - y).abs()));
        // The fast path fuses products and brackets turns otherwise: 1e-13 of full scale over 1e4 samples.
        assert!(apart <= 1e-10 * peak, "{apart:e} of {peak:e}");
    }
    // The default name, and the stream.
    done(&["decouple", &calibration, text(&recording), "--gain", "0.4"]);
    let file = std::fs::read_to_string(folder.join("run-decoupled.csv")).expect("the default name");
    let mut child = sixaxis()
        .args(["decouple", &calibration, "-", "--gain", "0.4", "--rate"])
        .arg(rate_hz.to_string())
        .stdin(std::fs::File::open(&recording).expect("opens"))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("starts");
    let mut streamed = String::new();
    let mut output = child.stdout.take().expect("a pipe");
    output.read_to_string(&mut streamed).expect("reads");
    assert!(child.wait().expect("ends").success());
    let numbers = |text: &str| -> Vec<Vec<f64>> {
        text.lines()
            .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
            .map(|line| {
                line.split(',')
                    .map(|x| x.parse().expect("a number"))
                    .collect()
            })
            .collect()
    };
    assert_eq!(numbers(&streamed), numbers(&file));
    assert_eq!(numbers(&streamed).len(), volts[0].len() - 2);
}

#[test]
fn inv_deviations_stand_beside_the_accelerations() {
    const SIX: [&str; 6] = ["ax", "ay", "az", "alpha_x", "alpha_y", "alpha_z"];
    const DEVIATIONS: [&str; 6] = [
        "sd_ax",
        "sd_ay",
        "sd_az",
        "sd_alpha_x",
        "sd_alpha_y",
        "sd_alpha_z",
    ];
    let folder = folder("deviations");
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
    assert_eq!(columns(&plain, &SIX).0, columns(&known, &SIX).0);
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
    assert!(errors(&old).contains("calibrate again"), "{}", errors(&old));
}

/// Rounding of a few thousand steps.
const TWICE: f64 = 1e-9;

#[test]
fn inv_a_stream_answers_at_once_and_names_a_broken_row() {
    let mut child = sixaxis()
        .args([
            "decouple",
            &calibration(),
            "-",
            "--rate",
            "1000",
            "--gain",
            "0.01",
        ])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let mut input = child.stdin.take().expect("a pipe");
    let mut output = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let mut next = || output.next().map(|line| line.expect("a line"));
    let headings = next().expect("headings");
    assert!(headings.starts_with("time [s],ax [m/s^2],ay"), "{headings}");
    let row = "0,0.1,0,0,0,0.1,0,0,0\n";
    input.write_all(row.as_bytes()).expect("takes it");
    input.write_all(b"# a remark\n\n").expect("takes it");
    input.write_all(row.as_bytes()).expect("takes it");
    for sample in 1..4 {
        input.write_all(row.as_bytes()).expect("takes it");
        // The answer is there while the input is still open.
        let answer = next().expect("an answer");
        assert!(answer.starts_with(&format!("0.00{sample},")), "{answer}");
    }
    input
        .write_all(b"0,0.1,0,0,zero,0,0,0,0\n")
        .expect("takes it");
    assert_eq!(next(), None);
    let ended = child.wait_with_output().expect("ends");
    assert_eq!(ended.status.code(), Some(1));
    let said = errors(&ended);
    assert!(
        said.contains("line 8") && said.contains("u5") && said.contains("zero"),
        "{said}"
    );
}

#[test]
fn inv_a_closed_pipe_ends_quietly() {
    let mut child = sixaxis()
        .args([
            "decouple",
            &calibration(),
            "-",
            "--rate",
            "1000",
            "--gain",
            "0.01",
        ])
        .args(["--down", "0,0,-1"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let mut input = child.stdin.take().expect("a pipe");
    drop(child.stdout.take());
    for _ in 0..1000 {
        // The program may have gone by now.
        if input.write_all(b"0,0,0,0,0,0,0,0,0\n").is_err() {
            break;
        }
    }
    drop(input);
    let ended = child.wait_with_output().expect("ends");
    assert_eq!(ended.status.code(), Some(0), "{}", errors(&ended));
    assert_eq!(errors(&ended), "");
}

#[test]
fn inv_what_is_wrong_is_named() {
    let folder = folder("wrong");
    let calibration = calibration();
    let (volts, rate_hz) = voltages();
    let recording = folder.join("run.npz");
    let out = folder.join("out.csv");
    let decouple = |more: &[&str]| {
        let first = [
            "decouple",
            &calibration,
            text(&recording),
            "--out",
            text(&out),
        ];
        run(&[&first[..], &["--gain", "0.1"], more].concat())
    };
    // Not a number.
    let mut broken = volts.clone();
    broken[4][321] = f64::NAN;
    write(&recording, &LIMBS, "V", &broken, rate_hz);
    let refused = decouple(&[]);
    assert_eq!(refused.status.code(), Some(1));
    let said = errors(&refused);
    for word in ["run.npz", "\"u5\"", "sample 321", "not a finite number"] {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert!(!out.exists());
    // At the limit of the converter: a warning.
    let mut clipped = volts.clone();
    clipped[2][100..107].fill(10.0);
    write(&recording, &LIMBS, "V", &clipped, rate_hz);
    let warned = decouple(&[]);
    assert!(warned.status.success());
    assert!(errors(&warned).contains("7 of u3"), "{}", errors(&warned));
    // Gains that nobody says: a note; and said: none.
    write(&recording, &LIMBS, "V", &volts, rate_hz);
    let noted = done(&[
        "decouple",
        &calibration,
        text(&recording),
        "--out",
        text(&out),
    ]);
    assert!(
        errors(&noted).contains("default gains"),
        "{}",
        errors(&noted)
    );
    assert!(!errors(&decouple(&[])).contains("default gains"));
    // The recording itself is no place for the result; --rate may not contradict the file.
    let itself = run(&[
        "decouple",
        &calibration,
        text(&recording),
        "--out",
        text(&recording),
    ]);
    assert_eq!(itself.status.code(), Some(1));
    assert_eq!(decouple(&["--rate", "123"]).status.code(), Some(1));
    // A bad calibration.
    let bad = folder.join("bad.json");
    let mut judged = Calibration::read(calibration.as_ref()).expect("reads");
    judged.verdict = Grade::Bad;
    judged.write(&bad).expect("writes");
    let arguments = [
        "decouple",
        text(&bad),
        text(&recording),
        "--out",
        text(&out),
    ];
    assert_eq!(run(&arguments).status.code(), Some(1));
    let forced = run(&[&arguments[..], &["--force"]].concat());
    assert!(forced.status.success() && errors(&forced).contains("do not trust"));
}

#[test]
fn inv_rates_and_clocks_are_aligned_or_refused() {
    let folder = folder("clocks");
    let motion = |path: &Path, rate_hz: f64, start_s: f64, samples: usize| {
        let times: Vec<f64> = (0..samples).map(|k| start_s + k as f64 / rate_hz).collect();
        let wave = |axis: usize| {
            times
                .iter()
                .map(|t| ((axis + 1) as f64 * t).sin())
                .collect()
        };
        let mut columns = vec![times.clone()];
        columns.extend((0..6).map(wave));
        let names = [&["time"], &ACCELERATIONS[..]].concat();
        let channels = names.iter().map(|name| Channel::new(*name, None)).collect();
        let mut sink = create(
            path,
            &Layout {
                channels,
                ..Layout::default()
            },
        )
        .expect("creates");
        sink.write(&Block { columns }).expect("writes");
        sink.finish().expect("finishes");
    };
    let truth = folder.join("truth.csv");
    motion(&truth, 1000.0, 0.0, 5000);
    let result = folder.join("result.csv");
    for (rate_hz, start_s) in [
        (1000.0, 0.001),
        (1000.0, -0.5),
        (500.0, 0.003),
        (4000.0, -0.00025),
    ] {
        motion(&result, rate_hz, start_s, 3000);
        let errors_percent = largest_errors(&result, &truth);
        assert!(
            errors_percent.iter().all(|e| *e < 1e-6),
            "{rate_hz}: {errors_percent:?}"
        );
    }
    for (rate_hz, start_s, why) in [
        (1500.0, 0.0, "whole multiple"),
        (1000.0, 0.0004, "beside those"),
        (1000.0, 100.0, "no instant in common"),
    ] {
        motion(&result, rate_hz, start_s, 3000);
        let page = folder.join("refused.html");
        let refused = run(&["compare", text(&result), text(&truth), "--out", text(&page)]);
        assert_eq!(refused.status.code(), Some(1));
        assert!(
            errors(&refused).contains(why),
            "{why}: {}",
            errors(&refused)
        );
        assert!(!page.exists());
    }
}

#[test]
fn inv_a_killed_run_leaves_the_old_result() {
    let folder = folder("killed");
    let calibration = calibration();
    let (volts, rate_hz) = voltages();
    let long: Vec<Vec<f64>> = volts
        .iter()
        .map(|c| c.iter().map(|u| 0.01 * u).cycle().take(150_000).collect())
        .collect();
    let recording = folder.join("long.npz");
    write(&recording, &LIMBS, "V", &long, rate_hz);
    let out = folder.join("out.parquet");
    let start = || {
        sixaxis()
            .args([
                "decouple",
                &calibration,
                text(&recording),
                "--gain",
                "0.01",
                "--out",
            ])
            .arg(&out)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("starts")
    };
    let started = Instant::now();
    assert!(start().wait().expect("ends").success());
    let whole = started.elapsed();
    let good = std::fs::read(&out).expect("a result");
    let old = b"the old result";
    let mut killed = 0;
    for round in 0..20_u32 {
        std::fs::write(&out, old).expect("writes");
        let mut child = start();
        // Spread over the whole run, in no order; the last ones may come too late.
        let share = f64::from(round * 7 % 20) / 19.0;
        std::thread::sleep(whole.mul_f64(share).max(Duration::from_millis(1)));
        let _ = child.kill();
        killed += u32::from(!child.wait().expect("ends").success());
        let found = std::fs::read(&out).expect("old or new");
        assert!(
            found == old || found == good,
            "round {round}: half a result"
        );
    }
    assert!(killed >= 10, "{killed} of 20 were killed in time");
}

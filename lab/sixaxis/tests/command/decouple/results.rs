//! What comes out: the motion that was, the same in every format.

use std::io::Read;
use std::path::Path;
use std::process::Stdio;

use super::clocks::largest_errors;
use super::session::{
    ACCELERATIONS, BLOCKS_AND_SAMPLES, LIMBS, apart, calibration, columns, compound, session,
    voltages, write,
};
use crate::program::{Folder, done, run, sixaxis, stderr, text};

#[test]
fn ref_a_compound_run_comes_out_as_it_was() {
    let folder = Folder::new("decouple-compound");
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
    for argument in ["--rest-to-rest", "--low-pass", "60", "--out", text(&out)] {
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
            stderr(&output).contains("has run away"),
            "{}",
            stderr(&output)
        );
    }
}

#[test]
fn inv_formats_streams_and_columns_agree() {
    let folder = Folder::new("decouple-formats");
    let calibration = calibration();
    let (volts, rate_hz) = voltages();
    let recording = folder.join("run.csv");
    let millivolts: Vec<Vec<f64>> = volts
        .iter()
        .map(|c| c.iter().map(|u| 1e3 * u).collect())
        .collect();
    write(&recording, &LIMBS, "mV", &millivolts, rate_hz);
    // Five times the forces that were: the attitude is soon lost, which is not asked here.
    let gain = ["--gain", "0.4", "--until-sd", "1e3"];
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
    assert_eq!(found, expected[1..7]);
    // The default name, and the stream.
    done(&[&["decouple", &calibration, text(&recording)], &gain[..]].concat());
    let file = std::fs::read_to_string(folder.join("run-decoupled.csv")).expect("the default name");
    let mut child = sixaxis()
        .args([
            "decouple",
            &calibration,
            "-",
            "--rate",
            &rate_hz.to_string(),
        ])
        .args(gain)
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
        let mut columns = vec![Vec::new(); 20];
        for line in text.lines() {
            if line.starts_with(|c: char| c.is_ascii_digit()) {
                let cells: Vec<&str> = line.split(',').collect();
                assert_eq!(cells.len(), columns.len(), "{line}");
                for (column, cell) in columns.iter_mut().zip(cells) {
                    column.push(cell.parse().expect("a number"));
                }
            }
        }
        columns
    };
    let (streamed, file) = (numbers(&streamed), numbers(&file));
    assert_eq!(streamed[0], file[0]);
    assert_eq!(streamed[0].len(), volts[0].len() - 2);
    let apart = apart(&streamed, &file);
    assert!(apart <= BLOCKS_AND_SAMPLES, "{apart:e}");
}

//! Rows in, rows out, while both pipes are open.

use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

use super::session::calibration;
use crate::program::{code, fed, sixaxis, stderr};

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
    let said = stderr(&ended);
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
    assert_eq!(ended.status.code(), Some(0), "{}", stderr(&ended));
    assert_eq!(stderr(&ended), "");
}

#[test]
fn neg_what_a_stream_is_written_in_is_told() {
    let calibration = calibration();
    let decouple = [
        "decouple",
        &calibration,
        "-",
        "--rate",
        "1000",
        "--gain",
        "0.1",
    ];
    let said = |row: &str| {
        let output = fed(&decouple, &row.repeat(5));
        (code(&output), stderr(&output))
    };
    let (code, refused) = said("0,1;0,2;0,3;0,4;0,5;0,6;0,7;0,8;0,9\n");
    assert!(
        code == 1 && refused.contains("decimal commas?"),
        "{refused}"
    );
    let (code, told) = said("10,-20,100,700,0,20,30,40,-50\n");
    assert!(
        code == 0 && told.contains("700.0 V, which a converter of 10 V does not give; are the numbers millivolts (--unit mV)?"),
        "{told}"
    );
    let (_, told) = said("1,-2,1,7,0,2,3,4,-10\n");
    assert!(told.contains("at the converter's limit of 10 V"), "{told}");
}

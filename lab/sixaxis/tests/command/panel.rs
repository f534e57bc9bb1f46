//! `sixaxis panel`: what was acknowledged survives the program's death, and what it refuses to begin with.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use sixaxis_recordings::{Block, open};
use tungstenite::{Message, WebSocket};

use crate::program::{Folder, code, run, sixaxis, stderr};
use crate::self_calibrate::day;

/// A panel that takes samples from a port, and is killed when dropped.
struct Running {
    child: Child,
    link: String,
    input: String,
}

impl Running {
    fn start(out: &str) -> Self {
        let arguments = [
            "panel",
            "--tcp",
            "0",
            "--port",
            "0",
            "--no-open",
            "--out",
            out,
        ];
        let mut child = sixaxis()
            .args(arguments)
            .stdout(Stdio::piped())
            .spawn()
            .expect("starts");
        let mut lines = BufReader::new(child.stdout.take().expect("piped")).lines();
        let mut after = |word: &str| {
            let line = lines.next().expect("a line").expect("text");
            line.strip_prefix(word).expect("its word").trim().to_owned()
        };
        let (link, input) = (after("panel:"), after("samples:"));
        Self { child, link, input }
    }

    fn browser(&self) -> WebSocket<TcpStream> {
        let (address, token) = self
            .link
            .strip_prefix("http://")
            .and_then(|l| l.split_once("/?token="))
            .expect("a link");
        let stream = TcpStream::connect(address).expect("connects");
        let request = format!("ws://{address}/socket?token={token}");
        let (socket, _) = tungstenite::client(request, stream).expect("is let in");
        let patience = Some(Duration::from_millis(200));
        socket
            .get_ref()
            .set_read_timeout(patience)
            .expect("a timeout");
        socket
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // On Unix this is SIGKILL: nothing is flushed, nothing is finished.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The next status.
fn status(socket: &mut WebSocket<TcpStream>) -> Value {
    let until = Instant::now() + Duration::from_secs(20);
    while Instant::now() < until {
        if let Ok(Message::Text(text)) = socket.read() {
            let mut value: Value = serde_json::from_str(&text).expect("JSON");
            if value["status"].is_object() {
                return value["status"].take();
            }
        }
    }
    panic!("no status");
}

fn voltage(row: u64, limb: usize) -> f64 {
    (row as f64 * 0.37 + limb as f64).sin()
}

#[test]
fn law_what_was_acknowledged_survives_the_programs_death() {
    let folder = Folder::new("panel-killed");
    let panel = Running::start(&folder.file("out"));
    let mut browser = panel.browser();
    let input = panel.input.clone();
    let _sender = std::thread::spawn(move || {
        let mut stream = TcpStream::connect(input).expect("connects");
        let mut row = 0_u64;
        let mut sent = stream.write_all(b"sixaxis rate=1000 format=f64\n");
        while sent.is_ok() {
            let rows = (row..row + 10).flat_map(|r| (0..9).map(move |limb| voltage(r, limb)));
            let bytes: Vec<u8> = rows.flat_map(f64::to_le_bytes).collect();
            sent = stream.write_all(&bytes);
            row += 10;
            std::thread::sleep(Duration::from_millis(10));
        }
    });
    while status(&mut browser)["samples"].as_u64() < Some(100) {}
    let record = Message::text(r#"{"do":"record","name":"run","format":"parquet"}"#);
    browser.send(record).expect("is listened to");
    let acknowledged = loop {
        let rows = status(&mut browser)["recording"]["on_disk"]
            .as_u64()
            .unwrap_or(0);
        if rows > 500 {
            break rows;
        }
    };
    drop(panel);
    let out = folder.join("out");
    assert!(out.join("run.journal").exists() && !out.join("run.parquet").exists());

    // The next panel makes a file of it.
    let again = Running::start(&folder.file("out"));
    let mut source = open(&out.join("run.parquet")).expect("opens");
    let (mut block, mut read) = (Block::default(), Vec::new());
    while source.read(&mut block, 100).expect("reads") > 0 {
        read.extend(
            (0..block.rows()).map(|row| block.columns.iter().map(|c| c[row]).collect::<Vec<f64>>()),
        );
    }
    assert!(
        read.len() as u64 >= acknowledged,
        "{} of {acknowledged}",
        read.len()
    );
    let first = (0..10_000)
        .find(|row| voltage(*row, 0) == read[0][0])
        .expect("a row that was sent");
    for (row, values) in read.iter().enumerate() {
        let sent: Vec<f64> = (0..9)
            .map(|limb| voltage(first + row as u64, limb))
            .collect();
        assert_eq!(values, &sent, "row {row}");
    }
    assert!(!out.join("run.journal").exists());
    drop(again);
}

#[test]
fn law_it_refuses_what_is_not_safe() {
    let folder = Folder::new("panel-refused");
    let out = folder.file("out");
    for (arguments, part) in [
        (&["--listen", "0.0.0.0"][..], "needs a --token"),
        (&["--token", "short"], "16 to 128"),
        (&["--token", "with blanks and / signs"], "16 to 128"),
        (&["--play", "nothing.tdms"], "nothing.tdms"),
    ] {
        let mut all = vec!["panel", "--no-open", "--port", "0", "--out", &out];
        all.extend(arguments);
        let output = run(&all);
        assert_eq!(code(&output), 1, "{arguments:?}");
        assert!(
            stderr(&output).contains(part),
            "{arguments:?}: {}",
            stderr(&output)
        );
    }
    assert_eq!(code(&run(&["panel", "--tcp", "1", "--stdin"])), 2);
    // What `decouple` refuses.
    let (day, _) = day();
    let calibration = fs::read_to_string(day.join("calibration.json")).expect("reads");
    let grade = |to: &str| {
        let graded = ["good", "reserved"]
            .iter()
            .fold(calibration.clone(), |text, from| {
                text.replace(
                    &format!("\"verdict\": \"{from}\""),
                    &format!("\"verdict\": \"{to}\""),
                )
            });
        folder.write(&format!("{to}.json"), graded)
    };
    let session = fs::read_to_string(day.join("session.toml")).expect("reads");
    let longer = session.replace("half_edge_mm = ", "half_edge_mm = 1");
    let (bad, good, longer) = (
        grade("bad"),
        grade("good"),
        folder.write("longer.toml", longer),
    );
    for (arguments, part) in [
        (&["--calibration", &bad][..], "its verdict is \"not good\""),
        (
            &["--calibration", &good, "--session", &longer],
            "half_edge_mm is",
        ),
    ] {
        let all = [
            "panel",
            "--no-open",
            "--port",
            "0",
            "--tcp",
            "0",
            "--out",
            &out,
        ];
        let output = run(&[&all[..], arguments].concat());
        assert_eq!(code(&output), 1, "{arguments:?}");
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
}

#[test]
fn neg_a_sender_is_told_why_it_is_hung_up_on() {
    let folder = Folder::new("panel-refuses-a-stream");
    let panel = Running::start(&folder.file("out"));
    let mut sender = TcpStream::connect(&panel.input).expect("connects");
    sender.write_all(b"hello\n").expect("writes");
    let mut told = String::new();
    sender.read_to_string(&mut told).expect("reads");
    assert!(told.starts_with("the first line: "), "{told}");
}

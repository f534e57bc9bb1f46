//! The panel over a real socket: samples in, pictures out, a calibration day, and everybody who must not be let in.

mod browser;

use std::io::Write;
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::time::Duration;

use browser::{Browser, ask, parts};
use sixaxis_calibration::apply::columns::Columns;
use sixaxis_calibration::apply::job::Job;
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::{LimbSet, Scheme};
use sixaxis_panel::control::Stages;
use sixaxis_panel::source::settings::Settings;
use sixaxis_panel::{Options, Panel, SourceChoice, start};
use sixaxis_recordings::session::{PerLimb, SessionFile};
use sixaxis_recordings::{Block, Layout, create, open};
use sixaxis_reference::laboratory::plan::Engine;

fn panel(source: SourceChoice, out: &std::path::Path) -> Panel {
    start(options(source, out)).expect("starts")
}

fn options(source: SourceChoice, out: &std::path::Path) -> Options {
    Options {
        source,
        rate_hz: None,
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        token: None,
        out: out.to_owned(),
        session: None,
        entry: None,
        calibration: None,
        tell: |_| (),
    }
}

fn laboratory(trials_per_step: usize) -> SourceChoice {
    SourceChoice::Laboratory(settings(trials_per_step))
}

const fn settings(trials_per_step: usize) -> Settings {
    Settings {
        seed: 7,
        sample_rate_hz: 1000.0,
        trials_per_step,
        engine: Engine::Rigid,
    }
}

fn port() -> SourceChoice {
    SourceChoice::Port(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)))
}

const VIEW: &str =
    r#"{"do":"view","columns":[0,1,2,3,4,5,6,7,8],"span_s":10,"end_s":null,"points":2000}"#;

#[test]
fn law_a_stalled_browser_loses_pictures_and_no_samples() {
    const ROWS: u64 = 30_000;
    let folder = tempfile::tempdir().expect("a folder");
    let panel = panel(port(), folder.path());
    let mut stalled = Browser::open(&panel.link);
    stalled.say(VIEW);
    let mut other = Browser::open(&panel.link);
    other.say(VIEW);
    let input = panel.input.expect("a port");
    let sender = std::thread::spawn(move || {
        let mut stream = TcpStream::connect(input).expect("connects");
        stream
            .write_all(b"sixaxis rate=10000 format=f64\n")
            .expect("writes");
        for row in 0..ROWS {
            let bytes: Vec<u8> = (0..9)
                .flat_map(|limb| (f64::from(limb) + row as f64 * 1e-6).to_le_bytes())
                .collect();
            stream.write_all(&bytes).expect("writes");
            if row % 100 == 0 {
                std::thread::sleep(Duration::from_millis(10));
            }
        }
    });
    other.wait("all samples", 60, |b| {
        b.status("samples").and_then(|v| v.as_u64()) == Some(ROWS)
    });
    sender.join().expect("sends");
    assert!(other.pictures > 20, "{}", other.pictures);
    // It has answered none, and so three were under way; all later ones were dropped.
    while stalled
        .texts
        .get("status")
        .is_none_or(|s| s["samples"] != ROWS)
    {
        stalled.listen(false);
    }
    assert!(stalled.pictures <= 3, "{}", stalled.pictures);
    stalled.say(r#"{"do":"seen","picture":3}"#);
    let shown = stalled.pictures;
    stalled.wait("a picture after the answer", 10, |b| b.pictures > shown);
    assert!(stalled.dropped > 20, "{}", stalled.dropped);
}

#[test]
fn law_nobody_without_the_token_or_from_elsewhere_is_let_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let panel = panel(laboratory(3), folder.path());
    let (address, token) = parts(&panel.link);
    let seen = "columns=0,20&span_s=1&end_s=null&points=50";
    let socket = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    let cases = [
        (
            format!("GET / HTTP/1.1\r\nHost: {address}\r\n\r\n"),
            "200 OK",
        ),
        (
            format!(
                "GET / HTTP/1.1\r\nHost: evil.example:{}\r\n\r\n",
                address.port()
            ),
            "403",
        ),
        ("GET / HTTP/1.1\r\n\r\n".to_owned(), "403"),
        (
            format!("GET /../../etc/passwd HTTP/1.1\r\nHost: {address}\r\n\r\n"),
            "404",
        ),
        (format!("POST / HTTP/1.1\r\nHost: {address}\r\n\r\n"), "400"),
        (
            format!("GET /seen.parquet?token={token}&{seen} HTTP/1.1\r\nHost: {address}\r\n\r\n"),
            "200 OK",
        ),
        (
            format!(
                "GET /seen.parquet?token={token}&{seen}0000 HTTP/1.1\r\nHost: {address}\r\n\r\n"
            ),
            "400",
        ),
        (
            format!("GET /seen.parquet?token={token} HTTP/1.1\r\nHost: {address}\r\n\r\n"),
            "400",
        ),
        (
            format!("GET /seen.parquet?{seen} HTTP/1.1\r\nHost: {address}\r\n\r\n"),
            "403",
        ),
        (
            format!(
                "GET /seen.parquet?token={token}&{seen} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://evil.example\r\n\r\n"
            ),
            "403",
        ),
        (
            format!("GET /socket HTTP/1.1\r\nHost: {address}\r\n{socket}\r\n"),
            "403",
        ),
        (
            format!("GET /socket?token={token}x HTTP/1.1\r\nHost: {address}\r\n{socket}\r\n"),
            "403",
        ),
        (
            format!(
                "GET /socket?token={token} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://evil.example\r\n{socket}\r\n"
            ),
            "403",
        ),
        (
            format!("GET /socket?token={token} HTTP/1.1\r\nHost: {address}\r\n\r\n"),
            "403",
        ),
        (
            format!(
                "GET /{} HTTP/1.1\r\nHost: {address}\r\n\r\n",
                "a".repeat(10_000)
            ),
            "431",
        ),
        ("\u{1}\u{2}\u{3} nonsense\r\n\r\n".to_owned(), "400"),
    ];
    for (request, expected) in cases {
        let answer = ask(address, &request);
        let first = answer.lines().next().unwrap_or_default();
        assert!(first.contains(expected), "{request:.80}: {first:?}");
        let file = request.contains("seen.parquet") && expected == "200 OK";
        assert_eq!(answer.contains("PAR1"), file, "{request:.80}");
        assert!(!answer.contains(&token), "{request:.80}");
    }
}

#[test]
fn law_one_browser_holds_the_controls_and_another_takes_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let panel = panel(laboratory(3), folder.path());
    let yours = |b: &Browser| b.texts.get("controls").map(|c| c["yours"] == true);
    let mut holder = Browser::open(&panel.link);
    holder.wait("the controls", 20, |b| yours(b) == Some(true));
    let mut other = Browser::open(&panel.link);
    other.say(r#"{"do":"restart"}"#);
    other.wait("a refusal", 20, |b| {
        b.texts
            .get("refused")
            .is_some_and(|r| r == "another browser holds the controls")
    });
    other.say(r#"{"do":"take"}"#);
    other.wait("the controls", 20, |b| yours(b) == Some(true));
    holder.wait("their loss", 20, |b| yours(b) == Some(false));
}

#[test]
fn law_a_broken_stream_is_told_and_the_next_one_taken() {
    let folder = tempfile::tempdir().expect("a folder");
    let panel = panel(port(), folder.path());
    let mut browser = Browser::open(&panel.link);
    let input = panel.input.expect("a port");
    let broken_off = [&b"sixaxis rate=1000\n"[..], &[0; 35]].concat();
    for (bytes, told) in [
        (&b"GET / HTTP/1.1\r\n\r\n"[..], "sixaxis"),
        (
            &b"sixaxis rate=1000 format=text\n1,2,3\n"[..],
            "3 numbers, 9 were expected",
        ),
        (&[0xff; 9000][..], "longer than"),
        (&broken_off[..], "the last 35 bytes are no whole row"),
    ] {
        TcpStream::connect(input)
            .expect("connects")
            .write_all(bytes)
            .expect("writes");
        browser.wait(told, 20, |b| {
            b.status("notes")
                .is_some_and(|notes| notes.to_string().contains(told))
        });
    }
    let mut text = "sixaxis rate=1000 format=text\n".to_owned();
    text += &"1,2,3,4,5,6,7,8,9\n".repeat(2_000);
    TcpStream::connect(input)
        .expect("connects")
        .write_all(text.as_bytes())
        .expect("writes");
    browser.wait("2000 samples", 20, |b| {
        b.status("samples").and_then(|v| v.as_u64()) == Some(2_000)
    });
}

/// A cell that is no number, while the sensor rests.
#[test]
fn law_a_cell_that_is_no_number_stops_decoding_until_the_next_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    let panel = panel(port(), folder.path());
    let mut browser = Browser::open(&panel.link);
    let mut text = "sixaxis rate=1000 format=text\n".to_owned();
    for row in 0..20_000 {
        let u = 1e-5 * f64::from(row % 7);
        let cell = if row == 9_000 {
            "NaN".to_owned()
        } else {
            u.to_string()
        };
        text += &format!("{u},{u},{u},{cell},{u},{u},{u},{u},{u}\n");
    }
    TcpStream::connect(panel.input.expect("a port"))
        .expect("connects")
        .write_all(text.as_bytes())
        .expect("writes");
    browser.wait("20000 samples", 20, |b| samples(b) == Some(20_000));
    let notes = browser.status("notes").expect("notes").to_string();
    assert_eq!(notes.matches("decoding has stopped").count(), 1, "{notes}");
}

#[test]
fn law_a_day_by_hand_ends_good_and_names_a_defect() {
    let folder = tempfile::tempdir().expect("a folder");
    let panel = panel(laboratory(6), folder.path());
    let mut browser = Browser::open(&panel.link);
    browser.say(VIEW);
    browser.wait("the list", 20, |b| b.texts.contains_key("day"));
    let trials = browser.texts["day"]["trials"]
        .as_array()
        .expect("a list")
        .len();
    assert_eq!(trials, 1 + 3 * 6 + 3);
    browser.say(r#"{"do":"speed","speed":50}"#);
    for trial in 0..trials {
        browser.say(&format!(
            r#"{{"do":"capture","trial":{trial},"done":false}}"#
        ));
        browser.wait("the trial", 60, |b| {
            let check = &b.texts["day"]["trials"][trial]["check"];
            !check.is_null()
        });
        let check = &browser.texts["day"]["trials"][trial]["check"];
        let good = check["lines"]
            .as_array()
            .expect("lines")
            .iter()
            .all(|line| line["ok"] == true);
        assert!(good, "trial {trial}: {check}");
    }
    let all = |b: &Browser| {
        let day = &b.texts["day"];
        day["calibrated"] == true && day["next"].is_null()
    };
    browser.wait("the verdict", 300, all);
    let day = browser.texts["day"].clone();
    assert_eq!(
        day["grade"], "good",
        "{} {}",
        day["sentence"], day["reservations"]
    );
    assert_eq!(day["parameters"].as_array().map(Vec::len), Some(25));
    let calibration = Calibration::read(&folder.path().join("day/calibration.json"));
    assert_eq!(calibration.expect("a calibration").intervals.len(), 25);

    // Decoded with it, the truth beside it: a validation run once more, whose samples are then in a file.
    let run = trials - 2;
    // In real time, so that the run is seen.
    browser.say(r#"{"do":"speed","speed":1}"#);
    browser.say(&format!(r#"{{"do":"capture","trial":{run},"done":false}}"#));
    browser.wait("the run", 60, |b| {
        b.status("run").is_some_and(|run| run.is_string())
    });
    browser.wait("its end", 60, |b| {
        b.status("run").is_some_and(serde_json::Value::is_null)
    });
    let errors = browser.status("errors").expect("six").clone();
    let name = browser.texts["day"]["trials"][run]["name"].clone();
    let stated = stated(&folder.path().join("day"), name.as_str().expect("a name"));
    for (axis, stated) in stated.iter().enumerate() {
        let departure = errors[0][axis]["departure"].as_f64().expect("a number");
        assert!(
            departure < DEVIATIONS * stated,
            "axis {axis}: {departure}, and {stated} is stated"
        );
        assert!(departure > 0.0);
    }
    // What the attitude has drifted by turns the accelerations in ground axes and not those in the sensor's.
    let linear = |axes: usize| -> f64 {
        let departures = (0..3).map(|axis| errors[axes][axis]["departure"].as_f64());
        departures.map(|d| d.expect("a number")).sum()
    };
    assert!(linear(1) < linear(0), "{errors}");

    browser.say(r#"{"do":"speed","speed":50}"#);
    // A limb dies; the trial that has it is found out.
    browser.say(r#"{"do":"defect","defect":{"kind":"dead","limb":5}}"#);
    let before = browser.texts["day"]["trials"][2].clone();
    browser.say(r#"{"do":"capture","trial":2,"done":false}"#);
    browser.wait("the trial again", 60, |b| {
        b.texts["day"]["trials"][2]["check"] != before["check"]
    });
    browser.wait("the verdict again", 300, |b| {
        b.texts["day"]["grade"] == "bad"
    });
    let findings = &browser.texts["day"]["findings"];
    let named = findings.as_array().expect("a list").iter().any(|finding| {
        let says =
            |key: &str, words: &str| finding[key].as_str().is_some_and(|s| s.contains(words));
        says("cause", "dead limb") && says("place", "linear-02") && says("place", "channel 5")
    });
    assert!(named, "{findings}");
}

/// Standard deviations, of which the largest of some thousand samples of six axes stays within so many: four leave a chance of 6e-5 for
/// one sample, and neighbours in an open loop depart together.
const DEVIATIONS: f64 = 4.0;

/// The largest standard deviation of each acceleration that `sixaxis decouple --uncertainty` states for a recording of the day, behind the
/// panel's low-pass.
fn stated(day: &std::path::Path, name: &str) -> [f64; 6] {
    let calibration = Calibration::read(&day.join("calibration.json")).expect("a calibration");
    let session = SessionFile::read(&day.join("session.toml")).expect("a session");
    let path = day.join(format!("{name}.tdms"));
    let mut setup = Setup::new(
        &calibration,
        Some(&session),
        Some(&path),
        &Overrides::default(),
    )
    .expect("is set up");
    setup.conditioning.low_pass_hz = Stages::default().low_pass_hz;
    let job = Job {
        calibration: &calibration,
        calibration_name: std::path::Path::new("calibration.json"),
        setup: &setup,
        columns: Columns::ACCELERATIONS,
        scheme: Scheme::Heun,
        rest_to_rest: false,
        uncertainty: true,
        false_alarms_per_hour: None,
        excluded: LimbSet::EMPTY,
        until_sd_deg: sixaxis_calibration::apply::attitude::UNTIL_SD_DEG,
        aids: &[],
        smooth: false,
        picture: false,
    };
    let out = day.join("motion.parquet");
    job.run(&path, &|layout| Ok(create(&out, layout)?), &|_, _| {})
        .expect("decouples");
    let mut source = open(&out).expect("opens");
    let (mut block, mut largest) = (Block::default(), [0.0_f64; 6]);
    while source.read(&mut block, 1000).expect("reads") > 0 {
        for (largest, column) in largest.iter_mut().zip(&block.columns[7..13]) {
            *largest = column.iter().copied().fold(*largest, f64::max);
        }
    }
    largest
}

/// A recording of so many rows in a file.
fn recorded(path: &std::path::Path, rows: u64) {
    let layout = Layout::of_a_sensor(Some(1000.0), false);
    let mut sink = create(path, &layout).expect("begins");
    let column: Vec<f64> = (0..rows).map(|k| (k as f64 * 0.01).sin()).collect();
    sink.write(&Block {
        columns: vec![column; 9],
    })
    .expect("writes");
    sink.finish().expect("finishes");
}

fn samples(browser: &Browser) -> Option<u64> {
    browser
        .status("samples")
        .and_then(serde_json::Value::as_u64)
}

#[test]
fn law_a_recording_is_played_to_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["run.tdms", "run.parquet", "run.csv"] {
        let path = folder.path().join(name);
        recorded(&path, 3_000);
        let panel = panel(SourceChoice::Play(path, 1e3), folder.path());
        let mut browser = Browser::open(&panel.link);
        browser.wait(name, 20, |b| samples(b) == Some(3_000));
    }
}

#[test]
fn law_a_file_has_the_gains_of_its_entry_or_the_panel_says_which() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.tdms");
    recorded(&path, 3_000);
    let gains = core::array::from_fn(|limb| 0.1 * (1 + limb) as f64);
    let mut entry = settings(3).day()[0].0.clone();
    entry.gain_n_per_v = Some(PerLimb::Each(gains));
    let (session, entry) = (Some(settings(3).session()), Some(entry));
    let has = |browser: &Browser, key: &str, text: &str| {
        let status = browser.status(key);
        status.is_some_and(|status| status.to_string().contains(text))
    };
    for (play, session, entry, told) in [
        (true, session.clone(), entry.clone(), None),
        (false, session.clone(), entry, None),
        (true, session, None, Some("has no such recording")),
        (true, None, None, Some("1 N/V is taken for all")),
    ] {
        let source = if play {
            SourceChoice::Play(path.clone(), 1e3)
        } else {
            SourceChoice::Follow(path.clone())
        };
        let stated = entry.is_some();
        let options = Options {
            session,
            entry,
            ..options(source, folder.path())
        };
        let panel = start(options).expect("starts");
        let mut browser = Browser::open(&panel.link);
        browser.wait("all samples", 20, |b| samples(b) == Some(3_000));
        let shown = serde_json::to_string(&gains).expect("numbers");
        assert_eq!(has(&browser, "gains_n_per_v", &shown), stated);
        if let Some(told) = told {
            assert!(has(&browser, "notes", told), "{told}");
        }
    }
}

#[test]
fn law_a_growing_file_is_followed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("growing.csv");
    recorded(&path, 500);
    let panel = panel(SourceChoice::Follow(path.clone()), folder.path());
    let mut browser = Browser::open(&panel.link);
    browser.wait("what is there", 20, |b| samples(b) == Some(500));
    let mut file = std::fs::OpenOptions::new()
        .append(true)
        .open(&path)
        .expect("opens");
    file.write_all(b"1,2,3,4,5,6,7,8,9\n1,2,3,4,5")
        .expect("writes");
    browser.wait("a row", 20, |b| samples(b) == Some(501));
    file.write_all(b",6,7,8,9\n").expect("writes");
    browser.wait("the row that was broken off", 20, |b| {
        samples(b) == Some(502)
    });
    // One that is no row of numbers costs that row, and is told by its line.
    let lines = std::fs::read_to_string(&path)
        .expect("text")
        .lines()
        .count();
    file.write_all(b"# a remark\n1,2,x,4,5,6,7,8,9\n1,2\n1,2,3,4,5,6,7,8,9\n")
        .expect("writes");
    browser.wait("the row behind broken ones", 20, |b| {
        samples(b) == Some(503)
    });
    for told in [
        format!("line {}: \"x\" is not a number", lines + 2),
        format!("line {}: 2 cells, 9 were expected", lines + 3),
    ] {
        let note = serde_json::to_string(&told).expect("text");
        let notes = browser.status("notes").expect("notes").to_string();
        assert!(notes.contains(note.trim_matches('"')), "{told}: {notes}");
    }

    // Longer TDMS files replace shorter ones: the rows that were seen are not taken again.
    let path = folder.path().join("growing.tdms");
    recorded(&path, 500);
    let panel = self::panel(SourceChoice::Follow(path.clone()), folder.path());
    let mut browser = Browser::open(&panel.link);
    browser.wait("what is there", 20, |b| samples(b) == Some(500));
    recorded(&path, 1_700);
    browser.wait("what has come", 20, |b| samples(b) == Some(1_700));
}

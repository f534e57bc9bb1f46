//! Broken and hostile clients over real sockets, by the thousand, while samples stream in: nothing panics, no sample is lost, and nobody
//! without the token or without the controls changes anything.

mod browser;

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use browser::{Browser, ask, parts};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use sixaxis_panel::{Options, Panel, SourceChoice, start};

const SEED: u128 = 19;
/// Of each kind: requests, WebSocket frames, control messages; with the streams of samples more than a thousand.
const EACH: usize = 330;
const STREAMS: usize = 40;
const BROWSERS: usize = 50;
const SLOW: usize = 40;
const VIEW: &str =
    r#"{"do":"view","columns":[0,1,2,3,4,5,6,7,8],"span_s":10,"end_s":null,"points":500}"#;
const COMMANDS: [&str; 8] = [
    r#"{"do":"restart"}"#,
    r#"{"do":"record","name":"run","format":"csv"}"#,
    r#"{"do":"stages","stages":{"low_pass_hz":10,"outliers":true,"high_pass_hz":0.2,"hold_at_rest":false}}"#,
    r#"{"do":"watch","on":true}"#,
    r#"{"do":"parameters","parameters":"day"}"#,
    r#"{"do":"capture","trial":0,"done":false}"#,
    r#"{"do":"discard","trial":1}"#,
    r#"{"do":"clear_counts"}"#,
];

/// Draws what is broken.
struct Dice(Pcg64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        (self.0.next_u64() % n as u64) as usize
    }

    fn bytes(&mut self, n: usize) -> Vec<u8> {
        (0..n).map(|_| self.0.next_u64() as u8).collect()
    }

    /// Some bytes changed, put in, taken out or cut off.
    fn broken(&mut self, text: &[u8]) -> Vec<u8> {
        let mut out = text.to_vec();
        for _ in 0..=self.below(4) {
            let at = self.below(out.len().max(1)).min(out.len());
            match self.below(5) {
                0 if at < out.len() => out[at] = self.0.next_u64() as u8,
                1 => out.insert(at, self.0.next_u64() as u8),
                2 if at < out.len() => drop(out.remove(at)),
                3 => out.truncate(at),
                _ => {
                    let again = out[at..].to_vec();
                    out.extend(again);
                }
            }
        }
        out
    }
}

/// Sends rows at 10 kHz until it is told to end.
struct Acquisition {
    over: Arc<AtomicBool>,
    rows: Arc<AtomicU64>,
    thread: std::thread::JoinHandle<()>,
}

impl Acquisition {
    fn start(input: SocketAddr) -> Self {
        let (over, rows) = (
            Arc::new(AtomicBool::new(false)),
            Arc::new(AtomicU64::new(0)),
        );
        let (until, sent) = (Arc::clone(&over), Arc::clone(&rows));
        let thread = std::thread::spawn(move || {
            let mut stream = TcpStream::connect(input).expect("connects");
            stream
                .write_all(b"sixaxis rate=10000 format=f64\n")
                .expect("writes");
            while !until.load(Ordering::Relaxed) {
                let bytes: Vec<u8> = (0..900)
                    .flat_map(|k: u32| (f64::from(k % 9) * 0.1).to_le_bytes())
                    .collect();
                stream.write_all(&bytes).expect("writes");
                sent.fetch_add(100, Ordering::Relaxed);
                std::thread::sleep(Duration::from_millis(10));
            }
        });
        Self { over, rows, thread }
    }

    fn end(self) -> u64 {
        self.over.store(true, Ordering::Relaxed);
        self.thread.join().expect("sends");
        self.rows.load(Ordering::Relaxed)
    }
}

/// Requests without the token, broken in any way.
fn requests(dice: &mut Dice, address: SocketAddr, token: &str) {
    let socket = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    let whole = [
        format!("GET / HTTP/1.1\r\nHost: {address}\r\n\r\n"),
        format!(
            "GET /socket?token=00112233445566778899aabbccddeeff HTTP/1.1\r\nHost: {address}\r\n{socket}\r\n"
        ),
        format!("GET /socket HTTP/1.1\r\nHost: {address}\r\n{socket}\r\n"),
    ];
    for k in 0..EACH {
        // One in three has the right token and comes from another page, or from a name that somebody points here.
        let request = match k % 6 {
            0 => format!("GET /socket?token={token} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{:x}.example\r\n{socket}\r\n", dice.below(1 << 20)).into_bytes(),
            1 => format!("GET /socket?token={token} HTTP/1.1\r\nHost: {:x}.example:{}\r\n{socket}\r\n", dice.below(1 << 20), address.port()).into_bytes(),
            2 => { let n = 1 + dice.below(12_000); dice.bytes(n) }
            _ => { let which = dice.below(whole.len()); dice.broken(whole[which].as_bytes()) }
        };
        let mut stream = TcpStream::connect(address).expect("connects");
        // It may have been hung up on before all is written.
        let _ = stream.write_all(&request);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        stream
            .set_read_timeout(Some(Duration::from_secs(5)))
            .expect("a timeout");
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8_lossy(&answer);
        let first = answer.lines().next().unwrap_or_default();
        assert!(!first.contains(" 101 "), "request {k}: {first}");
        assert!(!answer.contains(token), "request {k}");
        if k % 6 < 2 {
            assert!(first.contains("403"), "request {k}: {first}");
        }
    }
}

/// Frames that are none, from a client that has been let in.
fn frames(dice: &mut Dice, address: SocketAddr, token: &str) {
    let opening = format!(
        "GET /socket?token={token} HTTP/1.1\r\nHost: {address}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    );
    for k in 0..EACH {
        let frame = match k % 5 {
            // Not masked; a length beyond all memory; a reserved kind; text that is no UTF-8; anything.
            0 => [&[0x81, 0x10][..], br#"{"do":"restart"}"#].concat(),
            1 => [&[0x82, 0xff][..], &[0x7f; 8], &dice.bytes(200)].concat(),
            2 => [0x83 + dice.below(5) as u8, 0x80, 0, 0, 0, 0].to_vec(),
            3 => vec![0x81, 0x84, 0, 0, 0, 0, 0xff, 0xfe, 0xc0, 0x80],
            _ => {
                let n = 1 + dice.below(400);
                dice.bytes(n)
            }
        };
        let mut stream = TcpStream::connect(address).expect("connects");
        let _ = stream.write_all(opening.as_bytes());
        let mut answer = [0; 12];
        let _ = stream.read_exact(&mut answer);
        assert_eq!(&answer, b"HTTP/1.1 101", "frame {k}");
        let _ = stream.write_all(&frame);
    }
}

/// Messages of browsers that look and do not hold the controls: broken ones, and whole ones that they may not say.
fn messages(dice: &mut Dice, browsers: &mut [Browser]) {
    for k in 0..EACH {
        let which = dice.below(COMMANDS.len());
        let broken = dice.broken(COMMANDS[which].as_bytes());
        let browser = &mut browsers[k % BROWSERS];
        // A browser says bytes that are no text as frames of their own.
        browser.say(&String::from_utf8_lossy(&broken));
        browser.say(COMMANDS[which]);
    }
    for browser in browsers {
        browser.texts.remove("refused");
        browser.say(COMMANDS[0]);
        browser.wait("a refusal", 20, |b| {
            b.texts
                .get("refused")
                .is_some_and(|r| r == "another browser holds the controls")
        });
    }
}

/// Streams of samples that are none, one after the other.
fn streams(dice: &mut Dice, input: SocketAddr) {
    let head = b"sixaxis rate=1000 format=text columns=u1,u2,u3,u4,u5,u6,u7,u8,u9\n";
    for k in 0..STREAMS {
        let bytes = match k % 4 {
            0 => dice.bytes(6_000),
            1 => [&b"sixaxis rate="[..], &dice.bytes(40)].concat(),
            2 => b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n".to_vec(),
            _ => [&head[..], &dice.bytes(3_000)].concat(),
        };
        let _ = TcpStream::connect(input)
            .expect("connects")
            .write_all(&bytes);
    }
    // And one that says nothing at all: it is hung up on.
    let silent = TcpStream::connect(input).expect("connects");
    let mut text = String::from_utf8(head.to_vec()).expect("text");
    text += &"1,2,3,4,5,6,7,8,9\n".repeat(2_000);
    TcpStream::connect(input)
        .expect("connects")
        .write_all(text.as_bytes())
        .expect("writes");
    std::mem::forget(silent);
}

fn panel(out: &std::path::Path) -> Panel {
    start(Options {
        source: SourceChoice::Port(SocketAddr::from((Ipv4Addr::LOCALHOST, 0))),
        rate_hz: None,
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)),
        token: None,
        out: out.to_owned(),
        entry: None,
        session: None,
        calibration: None,
        tell: |_| (),
    })
    .expect("starts")
}

#[test]
fn law_a_thousand_broken_clients_lose_no_sample_and_control_nothing() {
    static PANICS: AtomicUsize = AtomicUsize::new(0);
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        PANICS.fetch_add(1, Ordering::Relaxed);
        usual(info);
    }));
    let mut dice = Dice(Pcg64::new(SEED, 1));
    let folder = tempfile::tempdir().expect("a folder");
    let panel = panel(folder.path());
    let (address, token) = parts(&panel.link);
    let input = panel.input.expect("a port");
    let acquisition = Acquisition::start(input);

    let mut holder = Browser::open(&panel.link);
    holder.say(VIEW);
    holder.wait("samples", 20, |b| count(b) > Some(0));
    let stages = holder.status("stages").cloned();
    let mut browsers: Vec<Browser> = (0..BROWSERS).map(|_| Browser::open(&panel.link)).collect();
    browsers.iter_mut().for_each(|b| b.say(VIEW));

    // Heads that come byte by byte, all the while.
    let slow_over = Arc::new(AtomicBool::new(false));
    let until = Arc::clone(&slow_over);
    let slow = std::thread::spawn(move || {
        let connect = |_| TcpStream::connect(address).expect("connects");
        let mut slow: Vec<TcpStream> = (0..SLOW).map(connect).collect();
        while !until.load(Ordering::Relaxed) {
            for stream in &mut slow {
                if stream.write_all(b"G").is_err() {
                    *stream = connect(0);
                }
            }
            std::thread::sleep(Duration::from_millis(300));
        }
    });
    requests(&mut dice, address, &token);
    frames(&mut dice, address, &token);
    messages(&mut dice, &mut browsers);

    // Every sample is there, and the instrument is as it was.
    holder.wait("samples for a second", 20, |b| count(b) > Some(10_000));
    let rows = acquisition.end();
    holder.wait("every sample", 20, |b| count(b) == Some(rows));
    holder.wait("its controls", 20, |b| {
        b.texts.get("controls").is_some_and(|c| c["yours"] == true)
    });
    assert_eq!(holder.status("stages").cloned(), stages);
    assert_eq!(holder.status("watch"), Some(&false.into()));
    assert!(holder.status("recording").is_some_and(|r| r.is_null()));
    assert!(holder.status("run").is_some_and(|r| r.is_null()));
    let written = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(written, 0, "files in the output folder");
    assert!(
        ask(
            address,
            &format!("GET / HTTP/1.1\r\nHost: {address}\r\n\r\n")
        )
        .contains("200 OK")
    );

    streams(&mut dice, input);
    holder.wait("the sender after the broken ones", 30, |b| {
        count(b) == Some(2_000)
    });
    slow_over.store(true, Ordering::Relaxed);
    slow.join().expect("is slow");
    assert_eq!(PANICS.load(Ordering::Relaxed), 0, "panics");
}

fn count(browser: &Browser) -> Option<u64> {
    browser.status("samples").and_then(|s| s.as_u64())
}

//! Samples from a TCP port or from standard input.

use std::io::{ErrorKind, Read, Write as _};
use std::net::TcpListener;
use std::time::{Duration, Instant};

use sixaxis_recordings::session::Channels;

use super::wire::Wire;
use super::{Event, Sender, Start, TOLD};
use crate::columns::Batch;

/// Time that a sender on a port has for its first line.
const PATIENCE: Duration = Duration::from_secs(5);
/// Bytes read at a time.
const PIECE: usize = 1 << 16;

/// Takes one connection after the other; a sender that breaks the rules is hung up on.
pub fn listen(listener: &TcpListener, channels: &Channels, sender: &Sender) {
    for connection in listener.incoming() {
        let Ok(mut connection) = connection else {
            continue;
        };
        let from = connection
            .peer_addr()
            .map_or_else(|_| "a sender".to_owned(), |a| a.to_string());
        // A sender that says nothing keeps no other waiting.
        let _ = connection.set_read_timeout(Some(Duration::from_secs(1)));
        let Some(over) = read(&mut connection, &from, Some(PATIENCE), channels, sender) else {
            return;
        };
        // A sender that has gone does not read it.
        let _ = writeln!(connection, "{over}");
    }
}

/// Reads to the end, or until `patience` is over and no first line has come. Says why it is over; nothing when the instrument is shut down.
pub fn read(
    input: &mut dyn Read,
    from: &str,
    patience: Option<Duration>,
    channels: &Channels,
    sender: &Sender,
) -> Option<String> {
    let began = Instant::now();
    let mut wire = Wire::new(channels);
    let mut batch = Batch::default();
    let mut bytes = vec![0; PIECE];
    let mut started = false;
    let over = loop {
        if !started && patience.is_some_and(|patience| began.elapsed() > patience) {
            break "no first line has come".to_owned();
        }
        let got = match input.read(&mut bytes) {
            Ok(0) => break "ended".to_owned(),
            Ok(got) => got,
            Err(error)
                if matches!(
                    error.kind(),
                    ErrorKind::Interrupted | ErrorKind::WouldBlock | ErrorKind::TimedOut
                ) =>
            {
                continue;
            }
            Err(error) => break error.to_string(),
        };
        let mut told = Vec::new();
        let before = wire.refused;
        let taken_in = wire.take(&bytes[..got], &mut batch, &mut |error| {
            if before + (told.len() as u64) < TOLD {
                told.push(error.to_string());
            }
        });
        if !started && let Some(head) = wire.head() {
            started = true;
            let start = Start {
                title: format!("stream from {from}"),
                sample_rate_hz: head.sample_rate_hz,
                standards: head.has_standards(),
                truth: false,
            };
            sender.send(Event::Start(start)).ok()?;
        }
        for told in told {
            let told = format!("{from}, {told}; the row is passed over");
            sender.send(Event::Note(told)).ok()?;
        }
        if batch.samples() > 0 {
            let samples = Event::Samples(Box::new(std::mem::take(&mut batch)));
            sender.send(samples).ok()?;
        }
        if let Err(error) = taken_in {
            break error.to_string();
        }
    };
    let refused = match wire.refused {
        0 => String::new(),
        rows => format!("; {rows} rows were refused"),
    };
    let rest = match wire.unfinished() {
        bytes if bytes > 0 && started && over == "ended" => format!(
            "; the last {bytes} bytes are no whole row: are format and columns those of the sender?"
        ),
        _ => String::new(),
    };
    let over = format!("{over}{refused}{rest}");
    sender.send(Event::Note(format!("{from}: {over}"))).ok()?;
    Some(over)
}

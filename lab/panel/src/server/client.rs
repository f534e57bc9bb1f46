//! One browser: pictures and texts out, messages in, on a thread of its own.
//!
//! Pictures are drawn when they are due and the browser has answered the earlier ones; at most [`IN_FLIGHT`] are under way, so
//! that a slow line does not fill up with old ones. A picture that is due while they are is dropped and counted. Samples are
//! never waited for here: the history keeps them.

use std::collections::VecDeque;
use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::{Duration, Instant};

use tungstenite::{Error, Message as Frame, WebSocket};

use super::{Server, text};
use crate::board::POSTS;
use crate::control::{Message, View};
use crate::picture::{Pace, draw};
use crate::source::Event;

/// Pictures that may be under way.
pub const IN_FLIGHT: usize = 3;
/// Time between two pictures.
const FRAME: Duration = Duration::from_millis(40);
/// A browser that answers nothing for so long is gone.
const GONE: Duration = Duration::from_secs(60);
/// Messages a second that a browser may send.
const MESSAGES_PER_S: u32 = 200;
/// Latencies that the median is of.
const REMEMBERED: usize = 64;

/// A picture under way: its number and when its newest sample came.
struct Sent {
    number: u32,
    arrived: Option<Instant>,
}

/// A connected browser.
pub struct Client<'a> {
    server: &'a Server,
    socket: WebSocket<TcpStream>,
    number: u64,
    view: Option<View>,
    seen: [u64; POSTS],
    sent: VecDeque<Sent>,
    newest: Option<Instant>,
    pace: Pace,
    latencies_ms: VecDeque<f32>,
    drawn: VecDeque<Instant>,
    heard: Instant,
    messages: (Instant, u32),
    told: Option<(bool, bool)>,
}

/// Why it is over.
enum Over {
    Closed,
}

impl<'a> Client<'a> {
    /// A browser that has just come.
    pub fn new(server: &'a Server, socket: WebSocket<TcpStream>) -> Self {
        Self {
            server,
            socket,
            number: server.controls.arrive(),
            view: None,
            seen: [0; POSTS],
            sent: VecDeque::new(),
            newest: None,
            pace: Pace::default(),
            latencies_ms: VecDeque::new(),
            drawn: VecDeque::new(),
            heard: Instant::now(),
            messages: (Instant::now(), 0),
            told: None,
        }
    }

    /// Works until the browser goes.
    pub fn run(mut self) {
        let mut due = Instant::now();
        while self.turn(&mut due).is_ok() {}
        self.server.controls.release(self.number);
        let _ = self.socket.close(None);
    }

    fn turn(&mut self, due: &mut Instant) -> Result<(), Over> {
        self.listen(due.saturating_duration_since(Instant::now()))?;
        let now = Instant::now();
        if now < *due {
            return Ok(());
        }
        // Pictures that were due while a message was being sent are dropped, too.
        let late = now.duration_since(*due).as_millis() / FRAME.as_millis();
        *due = now + FRAME;
        if self.view.is_some() {
            self.pace.dropped += late as u32;
        }
        if self.server.board.is_over() || self.heard.elapsed() > GONE {
            return Err(Over::Closed);
        }
        self.tell()?;
        self.picture(now)
    }

    fn send(&mut self, frame: Frame) -> Result<(), Over> {
        match self.socket.send(frame) {
            Ok(()) => Ok(()),
            Err(Error::Io(error)) if is_slow(error.kind()) => Ok(()),
            Err(_) => Err(Over::Closed),
        }
    }

    /// Texts that are new, and whether this browser holds the controls.
    fn tell(&mut self) -> Result<(), Over> {
        for news in self.server.board.news(&mut self.seen) {
            self.send(text(&news))?;
        }
        let controls = &self.server.controls;
        let state = (controls.held_by(self.number), controls.held());
        if self.told != Some(state) {
            self.told = Some(state);
            let said = serde_json::json!({ "controls": { "yours": state.0, "held": state.1 } });
            self.send(text(&said.to_string()))?;
        }
        Ok(())
    }

    fn picture(&mut self, now: Instant) -> Result<(), Over> {
        let Some(view) = &self.view else {
            return Ok(());
        };
        if self.sent.len() >= IN_FLIGHT {
            self.pace.dropped += 1;
            return Ok(());
        }
        self.pace.number = self.pace.number.wrapping_add(1);
        while self
            .drawn
            .front()
            .is_some_and(|at| now.duration_since(*at) > Duration::from_secs(1))
        {
            self.drawn.pop_front();
        }
        self.pace.per_second = self.drawn.len() as f32;
        let (bytes, live) = draw(&self.server.board, view, &self.pace);
        // A picture without a new sample says nothing of the latency.
        let arrived = live.arrived.filter(|at| self.newest != Some(*at));
        self.newest = live.arrived;
        self.sent.push_back(Sent {
            number: self.pace.number,
            arrived,
        });
        self.send(Frame::binary(bytes))
    }

    /// Takes messages until the time is over.
    fn listen(&mut self, wait: Duration) -> Result<(), Over> {
        let until = Instant::now() + wait;
        loop {
            let left = until
                .saturating_duration_since(Instant::now())
                .max(Duration::from_millis(1));
            let stream = self.socket.get_ref();
            stream
                .set_read_timeout(Some(left))
                .map_err(|_| Over::Closed)?;
            match self.socket.read() {
                Ok(Frame::Text(message)) => self.message(&message)?,
                Ok(Frame::Close(_)) => return Err(Over::Closed),
                Ok(Frame::Ping(_) | Frame::Pong(_)) => self.heard = Instant::now(),
                Ok(_) => self.refuse("only text is understood")?,
                Err(Error::Io(error)) if is_slow(error.kind()) => return Ok(()),
                Err(_) => return Err(Over::Closed),
            }
            if Instant::now() >= until {
                return Ok(());
            }
        }
    }

    fn refuse(&mut self, cause: &str) -> Result<(), Over> {
        self.send(text(&serde_json::json!({ "refused": cause }).to_string()))
    }

    fn message(&mut self, message: &str) -> Result<(), Over> {
        self.heard = Instant::now();
        let (since, count) = &mut self.messages;
        if since.elapsed() > Duration::from_secs(1) {
            (*since, *count) = (Instant::now(), 0);
        }
        *count += 1;
        if *count > MESSAGES_PER_S {
            return Err(Over::Closed);
        }
        match Message::parse(message) {
            Err(refusal) => self.refuse(&refusal.to_string()),
            Ok(Message::View(view)) => {
                self.view = Some(view);
                Ok(())
            }
            Ok(Message::Seen { picture }) => {
                self.answered(picture);
                Ok(())
            }
            Ok(Message::Take {}) => {
                self.server.controls.take(self.number);
                Ok(())
            }
            Ok(Message::Release {}) => {
                self.server.controls.release(self.number);
                Ok(())
            }
            Ok(_) if !self.server.controls.held_by(self.number) => {
                self.refuse("another browser holds the controls")
            }
            Ok(control) => match self.server.sender.send(Event::Control(control)) {
                Ok(()) => Ok(()),
                Err(_) => Err(Over::Closed),
            },
        }
    }

    /// A picture has been drawn, and with it all before.
    fn answered(&mut self, number: u32) {
        while let Some(sent) = self.sent.front() {
            if number.wrapping_sub(sent.number) > u32::MAX / 2 {
                return;
            }
            let arrived = sent.arrived;
            self.sent.pop_front();
            self.drawn.push_back(Instant::now());
            if let Some(arrived) = arrived {
                self.latencies_ms
                    .push_back(arrived.elapsed().as_secs_f32() * 1e3);
                if self.latencies_ms.len() > REMEMBERED {
                    self.latencies_ms.pop_front();
                }
            }
        }
        let mut sorted: Vec<f32> = self.latencies_ms.iter().copied().collect();
        sorted.sort_by(f32::total_cmp);
        self.pace.latency_ms = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    }
}

/// The time of waiting is over, and nothing is lost.
fn is_slow(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

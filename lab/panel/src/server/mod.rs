//! The page and its WebSocket, over plain threads: one for each connection, at most [`MOST`].
//!
//! | file | holds |
//! |---|---|
//! | [`guard`] | Host, Origin and token: whose requests are answered |
//! | [`request`] | the head of a request, bounded in size and time |
//! | [`assets`] | the page's files |
//! | [`seen`] | what a browser sees as a file |
//! | [`controls`] | which browser holds the controls |
//! | [`client`] | one browser: pictures out, messages in |

pub mod assets;
pub mod client;
pub mod controls;
pub mod guard;
pub mod request;
pub mod seen;

use std::fmt::Display;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use tungstenite::handshake::derive_accept_key;
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Message, WebSocket};

use crate::board::Board;
use crate::control::LONGEST_MESSAGE;
use crate::source::Sender;
use controls::Controls;
use guard::{Guard, Refused};
use request::Request;

/// Connections at a time; more are closed at once.
pub const MOST: usize = 160;
/// Statuses that are said more than once.
const OK: &str = "200 OK";
const FORBIDDEN: &str = "403 Forbidden";
/// Time that a browser may take to take a message in.
const PATIENCE: Duration = Duration::from_secs(2);
/// Time that a connection is kept after an answer.
const FAREWELL: Duration = Duration::from_millis(200);

/// What all connections share.
pub struct Server {
    /// Whose requests are answered.
    pub guard: Guard,
    /// What browsers are shown.
    pub board: Arc<Board>,
    /// The way to the acquisition.
    pub sender: Sender,
    /// Who holds the controls.
    pub controls: Controls,
    open: AtomicUsize,
}

impl Server {
    /// Nobody is connected.
    pub fn new(guard: Guard, board: Arc<Board>, sender: Sender) -> Self {
        Self {
            guard,
            board,
            sender,
            controls: Controls::default(),
            open: AtomicUsize::new(0),
        }
    }

    /// Answers until the process ends.
    pub fn serve(self: Arc<Self>, listener: &TcpListener) {
        for connection in listener.incoming() {
            let Ok(connection) = connection else {
                // Out of file handles, for one: others will be given back.
                std::thread::sleep(Duration::from_millis(20));
                continue;
            };
            if self.board.is_over() {
                return;
            }
            if self.open.fetch_add(1, Ordering::Relaxed) >= MOST {
                self.open.fetch_sub(1, Ordering::Relaxed);
                continue;
            }
            let server = Arc::clone(&self);
            let spawned = std::thread::Builder::new()
                .name("browser".to_owned())
                .stack_size(256 << 10)
                .spawn(move || {
                    // A browser that has gone gets no answer.
                    let _ = server.answer(connection);
                    server.open.fetch_sub(1, Ordering::Relaxed);
                });
            if spawned.is_err() {
                self.open.fetch_sub(1, Ordering::Relaxed);
            }
        }
    }

    fn answer(&self, mut connection: TcpStream) -> std::io::Result<()> {
        let _ = connection.set_nodelay(true);
        let _ = connection.set_write_timeout(Some(PATIENCE));
        let request = match request::read(&mut connection) {
            Ok(request) => request,
            Err(error) => return refuse(&mut connection, error.status(), &error),
        };
        if let Err(refused) = self.guard.host(&request) {
            return refuse(&mut connection, FORBIDDEN, &refused);
        }
        if request.path == "/socket" {
            return self.socket(connection, &request);
        }
        if request.path == "/seen.parquet" {
            if let Err(refused) = self.admitted(&request) {
                return refuse(&mut connection, FORBIDDEN, &refused);
            }
            return match seen::parquet(&self.board, &request) {
                Ok(file) => respond(&mut connection, OK, "application/vnd.apache.parquet", &file),
                Err(error) => refuse(&mut connection, "400 Bad Request", &error),
            };
        }
        match assets::find(&request.path) {
            Some((kind, body)) => respond(&mut connection, OK, kind, body.as_bytes()),
            None => refuse(&mut connection, "404 Not Found", &"no such page"),
        }
    }

    /// Whether a request comes from the page and knows the token.
    fn admitted(&self, request: &Request) -> Result<(), Refused> {
        self.guard.origin(request)?;
        self.guard.token(request)
    }

    fn socket(&self, mut connection: TcpStream, request: &Request) -> std::io::Result<()> {
        let key = request.header("sec-websocket-key").ok_or(Refused::NoSocket);
        match self.admitted(request).and(key) {
            Err(refused) => refuse(&mut connection, FORBIDDEN, &refused),
            Ok(key) => {
                let accept = derive_accept_key(key.as_bytes());
                let head = format!(
                    "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: {accept}\r\n\r\n"
                );
                connection.write_all(head.as_bytes())?;
                let config = WebSocketConfig::default()
                    .max_message_size(Some(2 * LONGEST_MESSAGE))
                    .max_frame_size(Some(2 * LONGEST_MESSAGE))
                    .max_write_buffer_size(8 << 20);
                let socket = WebSocket::from_raw_socket(connection, Role::Server, Some(config));
                client::Client::new(self, socket).run();
                Ok(())
            }
        }
    }
}

/// An answer that says why there is no other.
fn refuse(connection: &mut TcpStream, status: &str, why: &dyn Display) -> std::io::Result<()> {
    respond(connection, status, "text/plain", why.to_string().as_bytes())
}

/// A whole answer. The page may load nothing that is not served here, and nobody may show it in a frame.
fn respond(
    connection: &mut TcpStream,
    status: &str,
    kind: &str,
    body: &[u8],
) -> std::io::Result<()> {
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {}\r\nConnection: close\r\n\
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
         Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
         connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'\r\n\r\n",
        body.len()
    );
    connection.write_all(head.as_bytes())?;
    connection.write_all(body)?;
    connection.shutdown(Shutdown::Write)?;
    // What is left of an over-long request is read and thrown away for a moment: a connection that is closed before takes the
    // answer along.
    connection.set_read_timeout(Some(FAREWELL))?;
    let mut left = [0; 1 << 14];
    let _ = connection.read(&mut left)?;
    Ok(())
}

/// A text as a message.
fn text(text: &str) -> Message {
    Message::text(text)
}

//! A browser without a screen: a WebSocket, messages out, texts and pictures in.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use serde_json::Value;
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// A connected browser.
pub struct Browser {
    socket: WebSocket<TcpStream>,
    /// The last text of each kind: `hello`, `status`, `day`, `controls`, `refused`.
    pub texts: std::collections::BTreeMap<String, Value>,
    /// Pictures seen, and dropped as the last one says.
    pub pictures: u32,
    pub dropped: u32,
}

/// Address and token of a link.
pub fn parts(link: &str) -> (SocketAddr, String) {
    let rest = link.strip_prefix("http://").expect("a link");
    let (address, token) = rest.split_once("/?token=").expect("a token");
    (address.parse().expect("an address"), token.to_owned())
}

/// One request of plain text; the answer whole.
pub fn ask(address: SocketAddr, request: &str) -> String {
    let mut stream = TcpStream::connect(address).expect("connects");
    stream.write_all(request.as_bytes()).expect("writes");
    stream
        .set_read_timeout(Some(Duration::from_secs(8)))
        .expect("a timeout");
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

impl Browser {
    /// Opens the link.
    pub fn open(link: &str) -> Self {
        let (address, token) = parts(link);
        let stream = TcpStream::connect(address).expect("connects");
        let mut request = format!("ws://{address}/socket?token={token}")
            .into_client_request()
            .expect("a request");
        let origin = format!("http://{address}").parse().expect("an origin");
        request.headers_mut().insert("Origin", origin);
        let (socket, _) = tungstenite::client(request, stream).expect("is let in");
        Self {
            socket,
            texts: Default::default(),
            pictures: 0,
            dropped: 0,
        }
    }

    /// Says something.
    pub fn say(&mut self, text: &str) {
        self.socket
            .send(Message::text(text))
            .expect("is listened to");
    }

    /// Takes one message, if one comes.
    pub fn listen(&mut self, answer: bool) {
        self.socket
            .get_ref()
            .set_read_timeout(Some(Duration::from_millis(100)))
            .expect("a timeout");
        match self.socket.read() {
            Ok(Message::Text(text)) => {
                let value: Value = serde_json::from_str(&text).expect("JSON");
                for (kind, value) in value.as_object().expect("an object") {
                    self.texts.insert(kind.clone(), value.clone());
                }
            }
            Ok(Message::Binary(bytes)) => {
                let word =
                    |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"));
                self.pictures += 1;
                self.dropped = word(12);
                if answer {
                    self.say(&format!(r#"{{"do":"seen","picture":{}}}"#, word(0)));
                }
            }
            _ => {}
        }
    }

    /// Listens until something holds.
    pub fn wait(&mut self, what: &str, seconds: u64, done: impl Fn(&Self) -> bool) {
        let until = Instant::now() + Duration::from_secs(seconds);
        while !done(self) {
            assert!(Instant::now() < until, "{what}: {:?}", self.status("notes"));
            self.listen(true);
        }
    }

    /// A number of the last status.
    pub fn status(&self, key: &str) -> Option<&Value> {
        self.texts.get("status")?.get(key)
    }
}

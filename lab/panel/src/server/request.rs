//! The head of a request, bounded in size and time: a client that sends a byte a second is not waited for.

use std::io::Read;
use std::net::TcpStream;
use std::time::{Duration, Instant};

use thiserror::Error;

/// Longest head, bytes, and most header lines.
const LONGEST: usize = 8192;
const MOST_HEADERS: usize = 64;
/// Time for the whole head.
const PATIENCE: Duration = Duration::from_secs(5);

/// A request that is no request.
#[derive(Debug, Error)]
pub enum RequestError {
    /// Not HTTP/1.1, or not a GET.
    #[error("not a request that is served here")]
    Syntax,
    /// Too long.
    #[error("the request's head is longer than {LONGEST} bytes")]
    Long,
    /// Too slow, or the connection broke.
    #[error("the request did not come")]
    Gone,
}

impl RequestError {
    /// The status line.
    pub const fn status(&self) -> &'static str {
        match self {
            Self::Syntax => "400 Bad Request",
            Self::Long => "431 Request Header Fields Too Large",
            Self::Gone => "408 Request Timeout",
        }
    }
}

/// A request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    /// Path without the query.
    pub path: String,
    query: String,
    headers: Vec<(String, String)>,
}

impl Request {
    /// Reads a head; none if it is not complete.
    ///
    /// # Errors
    /// [`RequestError::Syntax`].
    pub fn parse(bytes: &[u8]) -> Result<Option<Self>, RequestError> {
        let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
        let mut parsed = httparse::Request::new(&mut headers);
        let status = parsed.parse(bytes).map_err(|_| RequestError::Syntax)?;
        if status.is_partial() {
            return Ok(None);
        }
        let (Some("GET"), Some(target)) = (parsed.method, parsed.path) else {
            return Err(RequestError::Syntax);
        };
        let (path, query) = target.split_once('?').unwrap_or((target, ""));
        let header = |header: &httparse::Header<'_>| {
            let value = std::str::from_utf8(header.value).map_err(|_| RequestError::Syntax)?;
            Ok((header.name.to_ascii_lowercase(), value.to_owned()))
        };
        Ok(Some(Self {
            path: path.to_owned(),
            query: query.to_owned(),
            headers: parsed
                .headers
                .iter()
                .map(header)
                .collect::<Result<_, _>>()?,
        }))
    }

    /// A header by its name in small letters; none if it is there twice, which no browser sends.
    pub fn header(&self, name: &str) -> Option<&str> {
        let mut found = self.headers.iter().filter(|(own, _)| own == name);
        let first = found.next()?;
        found.next().is_none().then_some(first.1.as_str())
    }

    /// A value of the query.
    pub fn query(&self, name: &str) -> Option<&str> {
        let mut pairs = self
            .query
            .split('&')
            .filter_map(|pair| pair.split_once('='));
        pairs.find(|(key, _)| *key == name).map(|(_, value)| value)
    }
}

/// Reads a request.
///
/// # Errors
/// [`RequestError`].
pub fn read(connection: &mut TcpStream) -> Result<Request, RequestError> {
    let began = Instant::now();
    let mut bytes = Vec::new();
    let mut piece = [0; 2048];
    loop {
        let left = PATIENCE.saturating_sub(began.elapsed());
        if left.is_zero() || connection.set_read_timeout(Some(left)).is_err() {
            return Err(RequestError::Gone);
        }
        match connection.read(&mut piece) {
            Ok(0) | Err(_) => return Err(RequestError::Gone),
            Ok(got) => bytes.extend_from_slice(&piece[..got]),
        }
        if bytes.len() > LONGEST {
            return Err(RequestError::Long);
        }
        if let Some(request) = Request::parse(&bytes)? {
            return Ok(request);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_what_is_no_get_is_refused() {
        for text in [
            "POST / HTTP/1.1\r\nHost: a\r\n\r\n",
            "hello\r\n\r\n",
            "GET / SPDY/9\r\n\r\n",
            "\0\0\0\0",
        ] {
            assert!(Request::parse(text.as_bytes()).is_err(), "{text:?}");
        }
        assert_eq!(
            Request::parse(b"GET / HTTP/1.1\r\nHost: a").expect("so far"),
            None
        );
        let twice = Request::parse(b"GET /a?x=1&y=2 HTTP/1.1\r\nHost: a\r\nhost: b\r\n\r\n");
        let twice = twice.expect("a request").expect("whole");
        assert_eq!(
            (twice.header("host"), twice.query("y"), twice.path.as_str()),
            (None, Some("2"), "/a")
        );
    }

    #[test]
    fn prop_no_bytes_make_it_panic() {
        let mut state = 5_u64;
        for _ in 0..1_000 {
            let mut bytes = b"GET / HTTP/1.1\r\n".to_vec();
            for _ in 0..40 {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                bytes.push((state >> 33) as u8);
            }
            let _ = Request::parse(&bytes);
        }
    }
}

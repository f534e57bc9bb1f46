//! Whose requests are answered.
//!
//! A page of another origin can make a browser send requests here, and a name that its owner points at the loopback address
//! (DNS rebinding) makes them look like this origin's own. Therefore the Host must be an address or `localhost`, the Origin of a
//! WebSocket must be that same Host, and nothing is shown or controlled without the token of the link.

use thiserror::Error;

use super::request::Request;

/// Why a request is refused.
#[derive(Debug, Error, Clone, Copy, PartialEq, Eq)]
pub enum Refused {
    /// The Host is missing or a name that could be anybody's.
    #[error("this Host is not served: use the address or localhost")]
    Host,
    /// Another page's script.
    #[error("this Origin is not served")]
    Origin,
    /// No token, or another.
    #[error("the token is missing or wrong: use the link that sixaxis panel has printed")]
    Token,
    /// No WebSocket.
    #[error("a WebSocket was expected")]
    NoSocket,
}

/// What is asked of a request.
pub struct Guard {
    token: String,
    /// Whether only the loopback address is listened on.
    loopback: bool,
}

impl Guard {
    /// With a token.
    pub const fn new(token: String, loopback: bool) -> Self {
        Self { token, loopback }
    }

    /// A token that nobody guesses: 128 bits from the system.
    ///
    /// # Errors
    /// A system without random numbers.
    pub fn random_token() -> std::io::Result<String> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|error| std::io::Error::other(error.to_string()))?;
        Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
    }

    /// Checks the Host. Any port is good: behind an ssh tunnel it is another one.
    ///
    /// # Errors
    /// [`Refused::Host`].
    pub fn host(&self, request: &Request) -> Result<(), Refused> {
        let host = request.header("host").ok_or(Refused::Host)?;
        let name = without_port(host);
        let address = name.trim_matches(['[', ']']).parse::<std::net::IpAddr>();
        let good = match address {
            Ok(address) => !self.loopback || address.is_loopback(),
            Err(_) => name.eq_ignore_ascii_case("localhost"),
        };
        if good { Ok(()) } else { Err(Refused::Host) }
    }

    /// Checks the Origin: that of the page that is served here. A program that is no browser sends none and needs the token like
    /// everybody.
    ///
    /// # Errors
    /// [`Refused::Origin`].
    pub fn origin(&self, request: &Request) -> Result<(), Refused> {
        let host = request.header("host").ok_or(Refused::Host)?;
        match request.header("origin") {
            None => Ok(()),
            Some(origin) if origin.strip_prefix("http://") == Some(host) => Ok(()),
            Some(_) => Err(Refused::Origin),
        }
    }

    /// Checks the token, in a time that does not tell how much of it was right.
    ///
    /// # Errors
    /// [`Refused::Token`].
    pub fn token(&self, request: &Request) -> Result<(), Refused> {
        let given = request.query("token").unwrap_or_default().as_bytes();
        let own = self.token.as_bytes();
        let differences = own.iter().zip(given).fold(0, |all, (a, b)| all | (a ^ b));
        if given.len() == own.len() && differences == 0 {
            Ok(())
        } else {
            Err(Refused::Token)
        }
    }
}

/// The Host without its port; an IPv6 address keeps its brackets.
fn without_port(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port))
            if port.bytes().all(|b| b.is_ascii_digit())
                && (!name.contains(':') || name.ends_with(']')) =>
        {
            name
        }
        _ => host,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(host: &str, origin: Option<&str>, path: &str) -> Request {
        let mut text = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n");
        if let Some(origin) = origin {
            text += &format!("Origin: {origin}\r\n");
        }
        Request::parse((text + "\r\n").as_bytes())
            .expect("a request")
            .expect("whole")
    }

    #[test]
    fn law_names_of_others_are_no_hosts() {
        let guard = Guard::new("t".to_owned(), true);
        for host in [
            "127.0.0.1:8080",
            "localhost",
            "LOCALHOST:1",
            "[::1]:8080",
            "127.0.0.1",
        ] {
            assert_eq!(guard.host(&request(host, None, "/")), Ok(()), "{host}");
        }
        for host in [
            "evil.example:8080",
            "localhost.evil.example",
            "10.0.0.1",
            "127.0.0.1.evil",
            "",
            "[::2]",
        ] {
            assert_eq!(
                guard.host(&request(host, None, "/")),
                Err(Refused::Host),
                "{host}"
            );
        }
        let open = Guard::new("t".to_owned(), false);
        assert_eq!(open.host(&request("10.0.0.1:80", None, "/")), Ok(()));
        assert_eq!(
            open.host(&request("evil.example", None, "/")),
            Err(Refused::Host)
        );
    }

    #[test]
    fn law_scripts_of_other_pages_are_refused() {
        let guard = Guard::new("t".to_owned(), true);
        let of = |origin| guard.origin(&request("localhost:9000", origin, "/"));
        assert_eq!(of(None), Ok(()));
        assert_eq!(of(Some("http://localhost:9000")), Ok(()));
        for origin in [
            "http://evil.example",
            "http://localhost:9001",
            "null",
            "https://localhost:9000",
            "http://localhost:9000.evil",
        ] {
            assert_eq!(of(Some(origin)), Err(Refused::Origin), "{origin}");
        }
    }

    #[test]
    fn law_without_the_token_nothing() {
        let guard = Guard::new("abc123".to_owned(), true);
        let of = |path| guard.token(&request("localhost", None, path));
        assert_eq!(of("/socket?token=abc123"), Ok(()));
        for path in [
            "/socket",
            "/socket?token=",
            "/socket?token=abc12",
            "/socket?token=abc1234",
            "/socket?token=xbc123",
            "/socket?t=abc123",
        ] {
            assert_eq!(of(path), Err(Refused::Token), "{path}");
        }
        let (a, b) = (Guard::random_token(), Guard::random_token());
        assert_ne!(a.expect("random"), b.expect("random"));
    }
}

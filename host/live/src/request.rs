//! Requests of viewers, and who may connect.
//!
//! A page of another site that the user happens to visit can reach this machine's ports. It must not read the run nor
//! command the joint: `Host` has to be an IP address or `localhost`, which defeats names that a foreign server resolves
//! to this machine, and `Origin` has to be the page's own.

use std::io::{ErrorKind, Read};
use std::net::{IpAddr, Ipv6Addr, TcpStream};
use std::time::{Duration, Instant};

use httparse::Status;

/// Longest head of a request [bytes].
const MAX_HEAD: usize = 8192;
/// Largest number of header lines.
const MAX_HEADERS: usize = 64;
/// Time in which a head has to arrive.
const HEAD_TIME: Duration = Duration::from_secs(3);
/// WebSocket protocols of Foxglove: of its applications, and of the older package `ws-protocol`.
const FOXGLOVE: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
/// Origin of Foxglove in a browser. It may read, and has no way to command.
const FOXGLOVE_ORIGIN: &str = "https://app.foxglove.dev";

/// Answer to a request that is refused: status and reason.
#[derive(Debug, PartialEq, Eq)]
pub struct Refusal(pub &'static str, pub &'static str);

/// Request that is granted.
#[derive(Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The page itself; without its body for the method HEAD.
    Page {
        /// True with the body.
        body: bool,
    },
    /// WebSocket of the page, with its key.
    PageSocket(String),
    /// WebSocket of Foxglove, with its key and protocol.
    Foxglove(String, &'static str),
}

/// Reads the head of a request; returns the request and the bytes behind its head.
pub fn read(stream: &mut TcpStream) -> Result<(Wanted, Vec<u8>), Refusal> {
    let malformed = Refusal("400 Bad Request", "the request is malformed");
    let end = Instant::now() + HEAD_TIME;
    let (mut head, mut buffer) = (Vec::new(), [0; 2048]);
    loop {
        let late = Refusal("408 Request Timeout", "the request did not arrive in time");
        let rest = end.saturating_duration_since(Instant::now());
        if rest.is_zero() || stream.set_read_timeout(Some(rest)).is_err() {
            return Err(late);
        }
        let count = match stream.read(&mut buffer) {
            Ok(count) if count > 0 => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => return Err(late),
            _ => return Err(malformed),
        };
        head.extend(&buffer[..count]);
        let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(&head) {
            Ok(Status::Complete(length)) => return Ok((judge(&request)?, head[length..].to_vec())),
            Ok(Status::Partial) if head.len() < MAX_HEAD => {}
            Ok(Status::Partial) | Err(httparse::Error::TooManyHeaders) => {
                return Err(Refusal("431 Request Header Fields Too Large", "the request is too long"));
            }
            Err(_) => return Err(malformed),
        }
    }
}

fn judge(request: &httparse::Request<'_, '_>) -> Result<Wanted, Refusal> {
    let header = |name: &str| {
        let found = request.headers.iter().find(|header| header.name.eq_ignore_ascii_case(name));
        found.and_then(|header| std::str::from_utf8(header.value).ok()).map(str::trim)
    };
    let host = header("host")
        .filter(|host| is_local_name(host))
        .ok_or(Refusal("403 Forbidden", "the request names this machine neither by its IP address nor as localhost"))?;
    let method = request.method.unwrap_or_default();
    if !matches!(method, "GET" | "HEAD") {
        return Err(Refusal("405 Method Not Allowed", "the live view answers GET and HEAD"));
    }
    let path = request.path.unwrap_or_default();
    let key = header("sec-websocket-key").filter(|_| {
        let has = |name, word: &str| {
            header(name).is_some_and(|value| value.split(',').any(|part| part.trim().eq_ignore_ascii_case(word)))
        };
        method == "GET" && has("upgrade", "websocket") && has("connection", "upgrade")
    });
    let Some(key) = key else {
        return match path {
            "/" => Ok(Wanted::Page { body: method == "GET" }),
            _ => Err(Refusal("404 Not Found", "the live view is at /")),
        };
    };
    let is_own = |origin: &str| origin.eq_ignore_ascii_case(&format!("http://{host}"));
    let offered = header("sec-websocket-protocol").unwrap_or_default();
    let protocol = FOXGLOVE.into_iter().find(|known| offered.split(',').any(|one| one.trim() == *known));
    let foreign = Refusal("403 Forbidden", "the request comes from a page of another site");
    match (protocol, header("origin")) {
        (Some(protocol), origin) if origin.is_none_or(|origin| is_own(origin) || may_read(origin)) => {
            Ok(Wanted::Foxglove(key.to_owned(), protocol))
        }
        (None, origin) if origin.is_none_or(is_own) && path == "/live" => Ok(Wanted::PageSocket(key.to_owned())),
        (None, origin) if origin.is_none_or(is_own) => {
            Err(Refusal("404 Not Found", "the socket of the page is at /live"))
        }
        _ => Err(foreign),
    }
}

/// True for an IP address or `localhost`, with or without a port.
fn is_local_name(host: &str) -> bool {
    if let Some(rest) = host.strip_prefix('[') {
        let (address, port) = rest.split_once(']').unwrap_or_default();
        return address.parse::<Ipv6Addr>().is_ok() && (port.is_empty() || is_port(port.trim_start_matches(':')));
    }
    let (name, port) = host.split_once(':').unwrap_or((host, "0"));
    (name.eq_ignore_ascii_case("localhost") || name.parse::<IpAddr>().is_ok()) && is_port(port)
}

fn is_port(text: &str) -> bool {
    text.parse::<u16>().is_ok()
}

/// True for the origins of Foxglove: its site, its desktop application, and a copy that runs on this machine.
fn may_read(origin: &str) -> bool {
    match origin.split_once("://") {
        Some(("http" | "https", host)) => {
            let name = host.split_once(':').map_or(host, |(name, _)| name);
            let is_here = name == "localhost" || name.parse::<IpAddr>().is_ok_and(|address| address.is_loopback());
            is_here || origin == FOXGLOVE_ORIGIN
        }
        // Applications on this machine; a page of a site cannot have such an origin.
        Some(_) => true,
        None => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(text: &str) -> Result<Wanted, Refusal> {
        let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        let text = text.replace('\n', "\r\n");
        assert!(request.parse(text.as_bytes()).expect("it parses").is_complete(), "{text}");
        judge(&request)
    }

    fn socket(path: &str, lines: &str) -> Result<Wanted, Refusal> {
        let upgrade = "Upgrade: websocket\nConnection: keep-alive, Upgrade\nSec-WebSocket-Key: k\n";
        judged(&format!("GET {path} HTTP/1.1\n{upgrade}{lines}\n"))
    }

    fn status(result: Result<Wanted, Refusal>) -> &'static str {
        result.expect_err("it is refused").0
    }

    #[test]
    fn page_needs_local_host_name() {
        for host in ["127.0.0.1:8765", "localhost:8765", "LOCALHOST", "[::1]:8765", "192.168.1.2:80"] {
            let page = judged(&format!("GET / HTTP/1.1\nHost: {host}\n\n"));
            assert_eq!(page, Ok(Wanted::Page { body: true }), "{host}");
        }
        for host in ["evil.example:8765", "127.0.0.1.evil.example", "localhost:x", "[::1", "", "127.0.0.1:8765/"] {
            assert_eq!(status(judged(&format!("GET / HTTP/1.1\nHost: {host}\n\n"))), "403 Forbidden", "{host}");
        }
        assert_eq!(status(judged("GET / HTTP/1.1\n\n")), "403 Forbidden");
    }

    #[test]
    fn other_requests_are_refused() {
        assert_eq!(status(judged("POST / HTTP/1.1\nHost: localhost\n\n")), "405 Method Not Allowed");
        assert_eq!(status(judged("GET /etc HTTP/1.1\nHost: localhost\n\n")), "404 Not Found");
        assert_eq!(status(socket("/other", "Host: localhost\n")), "404 Not Found");
    }

    #[test]
    fn page_socket_needs_own_origin() {
        let granted = Ok(Wanted::PageSocket("k".to_owned()));
        assert_eq!(socket("/live", "Host: 127.0.0.1:8765\nOrigin: http://127.0.0.1:8765\n"), granted);
        assert_eq!(socket("/live", "Host: 127.0.0.1:8765\n"), granted);
        let foreign = ["http://evil.example", "http://127.0.0.1:3000", "http://localhost:8765", "null", "file://"];
        for origin in foreign {
            let refused = socket("/live", &format!("Host: 127.0.0.1:8765\nOrigin: {origin}\n"));
            assert_eq!(status(refused), "403 Forbidden", "{origin}");
        }
    }

    #[test]
    fn foxglove_reads_from_its_applications() {
        let of = |origin: &str| {
            let protocols = "Sec-WebSocket-Protocol: other, foxglove.websocket.v1\n";
            socket("/", &format!("Host: localhost:8765\n{protocols}{origin}\n"))
        };
        for origin in ["", "Origin: https://app.foxglove.dev\n", "Origin: file://\n", "Origin: http://localhost:8080\n"]
        {
            assert_eq!(of(origin), Ok(Wanted::Foxglove("k".to_owned(), "foxglove.websocket.v1")), "{origin}");
        }
        for origin in ["https://evil.example", "null", "https://app.foxglove.dev.evil.example", "http://localhost.x"] {
            assert_eq!(status(of(&format!("Origin: {origin}\n"))), "403 Forbidden", "{origin}");
        }
    }
}

//! The server: accepts viewers, answers their requests, and gives each a thread of its own.

use std::io::{self, Write};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::sync_channel;
use std::thread;
use std::time::{Duration, Instant};

use report::failure::{Failure, Outcome};
use tungstenite::handshake::derive_accept_key;

use crate::request::{self, Refusal, Wanted};
use crate::shared::{Commands, Outlet, Shared};
use crate::viewer::{Foxglove, Page, View, serve};

/// Connections at a time; further ones are closed at once.
const MAX_CONNECTIONS: usize = 16;
/// Items in the queue of a viewer: six seconds of batches.
const QUEUE: usize = 256;
/// Time that a viewer has to take an answer.
const WRITE_TIME: Duration = Duration::from_secs(3);
/// Pause after an error of the system, such as too many open files.
const PAUSE: Duration = Duration::from_millis(50);
/// The page.
const PAGE: &str = include_str!("page.html");
/// Headers of the page: no other site may frame it, and it loads nothing from elsewhere.
const PAGE_HEADERS: &str = "Content-Type: text/html; charset=utf-8\r\nCache-Control: no-store\r\n\
    X-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\nReferrer-Policy: no-referrer\r\n";

/// Server of the page and of Foxglove.
pub struct Server {
    address: SocketAddr,
    shared: Arc<Shared>,
}

/// State that all connections share.
struct Context {
    shared: Arc<Shared>,
    title: String,
    commands: Option<Commands>,
}

impl Server {
    /// Listens at an address.
    pub fn listen(address: SocketAddr, title: &str, shared: &Arc<Shared>, commands: Option<Commands>) -> Outcome<Self> {
        let open = || -> io::Result<(TcpListener, SocketAddr)> {
            let listener = TcpListener::bind(address)?;
            let address = listener.local_addr()?;
            Ok((listener, address))
        };
        let (listener, address) = open().map_err(|error| {
            Failure::new(format!("cannot listen at {address} for the live view: {error}"))
                .with_help("name another --live=ADDRESS; port 0 lets the system choose")
        })?;
        let context = Arc::new(Context { shared: shared.clone(), title: title.to_owned(), commands });
        thread::Builder::new()
            .name("live-server".to_owned())
            .spawn(move || accept(&listener, &context))
            .map_err(|error| Failure::new(format!("cannot start the live view: {error}")))?;
        Ok(Self { address, shared: shared.clone() })
    }

    /// Address for a browser on this machine.
    pub fn url(&self, scheme: &str) -> String {
        let slash = if scheme == "http" { "/" } else { "" };
        format!("{scheme}://{}{slash}", self.near_address())
    }

    /// Address by which this machine reaches the server.
    fn near_address(&self) -> SocketAddr {
        let near = match self.address.ip() {
            IpAddr::V4(ip) if ip.is_unspecified() => Ipv4Addr::LOCALHOST.into(),
            IpAddr::V6(ip) if ip.is_unspecified() => Ipv6Addr::LOCALHOST.into(),
            ip => ip,
        };
        SocketAddr::new(near, self.address.port())
    }

    /// Ends the server; waits for its viewers until a time.
    pub fn end(&self, until: Instant) {
        self.shared.is_ending.store(true, Ordering::Release);
        // Wakes the thread that waits for viewers.
        let _ = TcpStream::connect_timeout(&self.near_address(), WRITE_TIME);
        while self.shared.connections.load(Ordering::Acquire) > 0 && Instant::now() < until {
            thread::sleep(PAUSE / 10);
        }
    }
}

/// Counts a connection for as long as it lives.
struct Connection(Arc<Shared>);

impl Connection {
    /// Counts one more; `None` if there are too many.
    fn begin(shared: &Arc<Shared>) -> Option<Self> {
        let connection = Self(shared.clone());
        (shared.connections.fetch_add(1, Ordering::AcqRel) < MAX_CONNECTIONS).then_some(connection)
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.0.connections.fetch_sub(1, Ordering::AcqRel);
    }
}

fn accept(listener: &TcpListener, context: &Arc<Context>) {
    for stream in listener.incoming() {
        if context.shared.is_ending.load(Ordering::Acquire) {
            return;
        }
        let Ok(stream) = stream else {
            thread::sleep(PAUSE);
            continue;
        };
        let Some(connection) = Connection::begin(&context.shared) else { continue };
        let context = context.clone();
        let handle = move || {
            let _connection = connection;
            // A connection that breaks concerns its viewer only.
            let _ = answer(stream, &context);
        };
        // Without a thread the connection closes.
        let _ = thread::Builder::new().name("live-viewer".to_owned()).spawn(handle);
    }
}

fn answer(mut stream: TcpStream, context: &Context) -> io::Result<()> {
    stream.set_write_timeout(Some(WRITE_TIME))?;
    stream.set_nodelay(true)?;
    let (view, rest): (Box<dyn View>, Vec<u8>) = match request::read(&mut stream) {
        Err(Refusal(status, why)) => return respond(&mut stream, status, "", why, true),
        Ok((Wanted::Page { body }, _)) => return send_page(&mut stream, body),
        Ok((Wanted::PageSocket(key), rest)) => {
            upgrade(&mut stream, &key, None)?;
            let is_near = stream.peer_addr()?.ip().to_canonical().is_loopback();
            (Box::new(Page::new(&context.title, context.commands.clone(), is_near)), rest)
        }
        Ok((Wanted::Foxglove(key, protocol), rest)) => {
            upgrade(&mut stream, &key, Some(protocol))?;
            (Box::new(Foxglove::new(&context.title)), rest)
        }
    };
    let (items, queue) = sync_channel(QUEUE);
    let lost = Arc::new(AtomicU64::new(0));
    context.shared.add(Outlet { items, known: Vec::new(), lost: lost.clone() });
    let all_lost = || lost.load(Ordering::Relaxed) + context.shared.lost.load(Ordering::Relaxed);
    serve(stream, rest, view, &queue, &all_lost)
}

fn send_page(stream: &mut TcpStream, body: bool) -> io::Result<()> {
    let policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; \
        connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
    let headers = format!("{PAGE_HEADERS}Content-Security-Policy: {policy}\r\n");
    respond(stream, "200 OK", &headers, PAGE, body)
}

fn respond(stream: &mut TcpStream, status: &str, headers: &str, body: &str, with_body: bool) -> io::Result<()> {
    let length = body.len();
    let head = format!("HTTP/1.1 {status}\r\nConnection: close\r\nContent-Length: {length}\r\n{headers}\r\n");
    stream.write_all(head.as_bytes())?;
    stream.write_all(if with_body { body.as_bytes() } else { &[] })
}

fn upgrade(stream: &mut TcpStream, key: &str, protocol: Option<&str>) -> io::Result<()> {
    let accepted = derive_accept_key(key.as_bytes());
    let protocol = protocol.map_or_else(String::new, |protocol| format!("Sec-WebSocket-Protocol: {protocol}\r\n"));
    let head = format!(
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Accept: {accepted}\r\n{protocol}\r\n"
    );
    stream.write_all(head.as_bytes())
}

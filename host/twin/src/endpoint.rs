//! Line to the clients: a pseudo-terminal, or a TCP port on 127.0.0.1 for any number of clients. Threads read and send
//! events; writes never block: what a client does not read is dropped and counted.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::os::fd::AsFd;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::thread;

use report::failure::{Failure, Outcome};
use rustix::event::{PollFd, PollFlags, poll};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use crate::event::{ClientId, Event};
use crate::gate::Gate;
use crate::terminal;
use wires::{Packet, Received, Wire, WireName, wire};

/// Bytes that wait for a client whose line is full. The line itself holds 4 kB more.
const MAX_BACKLOG: usize = 16 << 10;

/// Line of one client.
pub struct Client {
    /// Number of the client.
    pub id: ClientId,
    wire: Box<dyn Wire>,
    writer: Writer,
    backlog: Vec<u8>,
    /// Packets that the client did not read in time.
    pub dropped: u64,
    /// Packets and lines that made no sense.
    pub malformed: u64,
}

/// Writing half of a line.
enum Writer {
    Terminal(File),
    Tcp(TcpStream),
}

impl Client {
    fn new(id: ClientId, name: WireName, writer: Writer) -> Self {
        let mut client = Self { id, wire: wire(name), writer, backlog: Vec::new(), dropped: 0, malformed: 0 };
        let greeting = client.wire.greeting();
        client.write(greeting);
        client
    }

    /// Client on a TCP connection.
    pub fn connected(id: ClientId, name: WireName, stream: TcpStream) -> Self {
        Self::new(id, name, Writer::Tcp(stream))
    }

    /// Takes bytes of the client, and answers for the adapter; returns its packets, and whether each is complete.
    pub fn receive(&mut self, bytes: &[u8]) -> Vec<(Packet, bool)> {
        let mut packets = Vec::new();
        for received in self.wire.receive(bytes) {
            match received {
                Received::Packet(packet) => packets.push((packet, true)),
                Received::Part(bytes) => packets.push((Packet::Bytes(bytes), false)),
                Received::Answer(answer) => self.write(&answer),
                Received::Malformed => self.malformed += 1,
            }
        }
        packets
    }

    /// Sends a packet of the bus to the client.
    pub fn send(&mut self, packet: &Packet) {
        if let Some(bytes) = self.wire.encode(packet) {
            self.write(&bytes);
        }
    }

    /// Writes bytes as a whole or not at all, so that a line is never cut.
    fn write(&mut self, bytes: &[u8]) {
        self.flush();
        if self.backlog.len() + bytes.len() > MAX_BACKLOG {
            self.dropped += 1;
            return;
        }
        self.backlog.extend(bytes);
        self.flush();
    }

    /// Writes as much of the backlog as the line takes.
    pub fn flush(&mut self) {
        while !self.backlog.is_empty() {
            let written = match &mut self.writer {
                Writer::Terminal(file) => file.write(&self.backlog),
                Writer::Tcp(stream) => stream.write(&self.backlog),
            };
            match written {
                Ok(count) if count > 0 => drop(self.backlog.drain(..count)),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                // The line is full; a line that is gone reports that to its reader.
                _ => return,
            }
        }
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        if let Writer::Tcp(stream) = &self.writer {
            let _ = stream.shutdown(Shutdown::Both);
        }
    }
}

/// Line that clients open.
pub struct Endpoint {
    /// Path of the pseudo-terminal, or number of the TCP port.
    pub name: String,
    /// Near end, kept open so that a client that leaves does not hang up the line.
    _near_end: Option<File>,
    link: Option<PathBuf>,
}

impl Endpoint {
    /// Opens the line of a wire. A pseudo-terminal has its only client at once.
    pub fn open(
        name: WireName,
        port: u16,
        link: Option<&Path>,
        events: &Sender<Event>,
        gate: &Gate,
    ) -> Outcome<(Self, Option<Client>)> {
        if name == WireName::Socketcand {
            return listen(port, events, gate).map(|endpoint| (endpoint, None));
        }
        let (far, near, path) =
            raw_terminal().map_err(|error| Failure::new(format!("cannot open a pseudo-terminal: {error}")))?;
        if let Some(link) = link {
            link_to(&path, link)?;
        }
        let reader = far.try_clone().map_err(|error| Failure::new(format!("cannot read {path}: {error}")))?;
        let (events, gate) = (events.clone(), gate.clone());
        thread::spawn(move || read_line(reader, 0, &events, &gate));
        let client = Client::new(0, name, Writer::Terminal(far));
        let name = link.map_or(path, |link| link.display().to_string());
        Ok((Self { name, _near_end: Some(near), link: link.map(Path::to_owned) }, Some(client)))
    }
}

impl Drop for Endpoint {
    fn drop(&mut self) {
        if let Some(link) = &self.link {
            let _ = fs::remove_file(link);
        }
    }
}

/// Pseudo-terminal without echo and line editing, which would change frames.
fn raw_terminal() -> io::Result<(File, File, String)> {
    let (far, near, path) = terminal::pair()?;
    let mut attributes = tcgetattr(&near)?;
    attributes.make_raw();
    tcsetattr(&near, OptionalActions::Now, &attributes)?;
    Ok((far, near, path))
}

/// Makes the symbolic link, in place of one that a run left whose terminal is gone; anything else is kept.
fn link_to(path: &str, link: &Path) -> Outcome<()> {
    let name = link.display();
    match fs::symlink_metadata(link) {
        Ok(found) if found.file_type().is_symlink() && !link.exists() => {
            let _ = fs::remove_file(link);
        }
        Ok(found) if found.file_type().is_symlink() => {
            return Err(Failure::new(format!("the link {name} is in use"))
                .with_help("end the twin that made it, remove the link, or name another --link"));
        }
        Ok(_) => {
            return Err(Failure::new(format!("{name} is there and is no link")).with_help("name another --link"));
        }
        Err(_) => {}
    }
    symlink(path, link).map_err(|error| {
        Failure::new(format!("cannot make the link {name}: {error}")).with_help("name a --link in a folder of yours")
    })
}

fn listen(port: u16, events: &Sender<Event>, gate: &Gate) -> Outcome<Endpoint> {
    let cannot = |error: io::Error| {
        Failure::new(format!("cannot listen on 127.0.0.1:{port}: {error}"))
            .with_help("name another --port; 0 lets the system choose")
    };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(cannot)?;
    let name = listener.local_addr().map_err(cannot)?.port().to_string();
    let (events, gate) = (events.clone(), gate.clone());
    thread::spawn(move || {
        for (id, stream) in (1..).zip(listener.incoming().flatten()) {
            let Ok(reader) = stream.try_clone() else { continue };
            let _ = stream.set_nodelay(true);
            if stream.set_nonblocking(true).is_err() || events.send(Event::Connected(id, stream)).is_err() {
                return;
            }
            let (events, gate) = (events.clone(), gate.clone());
            thread::spawn(move || read_line(reader, id, &events, &gate));
        }
    });
    Ok(Endpoint { name, _near_end: None, link: None })
}

/// Hands the bytes of a client to the run until its line ends.
fn read_line(mut line: impl Read + AsFd, id: ClientId, events: &Sender<Event>, gate: &Gate) {
    let mut buffer = [0_u8; 4096];
    loop {
        gate.wait();
        // The descriptor does not block, since it is the one that is written to.
        let _ = poll(&mut [PollFd::new(&line.as_fd(), PollFlags::IN)], None);
        match line.read(&mut buffer) {
            Ok(count) if count > 0 => {
                gate.read(count);
                if events.send(Event::bytes(id, &buffer[..count])).is_err() {
                    return;
                }
            }
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {}
            _ => {
                let _ = events.send(Event::Left(id));
                return;
            }
        }
    }
}

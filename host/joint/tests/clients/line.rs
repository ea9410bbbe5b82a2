//! Line of a test to the twin: a pseudo-terminal or a TCP connection, with text or bytes.

use std::fs::File;
use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpStream};
use std::os::unix::fs::OpenOptionsExt;
use std::time::Duration;

use rustix::fs::OFlags;

use crate::command::{TIMEOUT, within};

/// Open line. Everything that arrived is kept in `heard`.
pub struct Line {
    reader: Box<dyn Read>,
    writer: Box<dyn Write>,
    /// Bytes that arrived since the last [`Line::forget`].
    pub heard: Vec<u8>,
}

impl Line {
    /// Opens a pseudo-terminal.
    pub fn terminal(path: &str) -> Self {
        let open = |flags: OFlags| {
            let flags = (OFlags::NOCTTY | flags).bits() as i32;
            File::options().read(true).write(true).custom_flags(flags).open(path).expect("the terminal of the twin")
        };
        Self { reader: Box::new(open(OFlags::NONBLOCK)), writer: Box::new(open(OFlags::empty())), heard: Vec::new() }
    }

    /// Connects to socketcand and opens its bus in raw mode.
    pub fn socketcand(port: &str) -> Self {
        let address = (Ipv4Addr::LOCALHOST, port.parse::<u16>().expect("a port"));
        let writer = TcpStream::connect(address).expect("the twin listens");
        let reader = writer.try_clone().expect("a second handle");
        reader.set_read_timeout(Some(Duration::from_millis(1))).expect("a socket has a limit");
        let mut line = Self { reader: Box::new(reader), writer: Box::new(writer), heard: Vec::new() };
        line.hears("< hi >");
        line.say("< open can0 >< rawmode >");
        line.hears("< ok >< ok >");
        line
    }

    /// Sends text.
    pub fn say(&mut self, text: &str) {
        self.send(text.as_bytes());
    }

    /// Sends bytes.
    pub fn send(&mut self, bytes: &[u8]) {
        self.writer.write_all(bytes).expect("the twin reads");
    }

    /// Waits until a text arrives.
    pub fn hears(&mut self, text: &str) {
        self.hears_bytes(text.as_bytes());
    }

    /// Waits until bytes arrive.
    pub fn hears_bytes(&mut self, bytes: &[u8]) {
        within(TIMEOUT, &format!("{:?}", String::from_utf8_lossy(bytes)), || {
            self.read();
            self.has(bytes).then_some(())
        });
    }

    /// True if bytes are among those that arrived since the last [`Line::forget`].
    pub fn has(&self, bytes: &[u8]) -> bool {
        self.heard.windows(bytes.len()).any(|part| part == bytes)
    }

    /// Reads what there is and drops it with everything that arrived before.
    pub fn forget(&mut self) {
        self.read();
        self.heard.clear();
    }

    /// Reads what has arrived.
    pub fn read(&mut self) {
        let mut buffer = [0; 1 << 16];
        while let Ok(count) = self.reader.read(&mut buffer) {
            if count == 0 {
                return;
            }
            self.heard.extend(&buffer[..count]);
        }
    }
}

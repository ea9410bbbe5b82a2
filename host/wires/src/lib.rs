//! Form of frames on a line: `slcan` and `fdcanusb` as text of USB adapters, `socketcand` as text over TCP, `serial` as
//! bare bytes; and the bits of CAN frames on the bus. The twin and the model of the boards' registers use them.

pub mod bits;
mod fdcanusb;
mod hex;
mod serial;
mod slcan;
mod socketcand;

use clap::ValueEnum;
use drives::Frame;

/// Form of frames on a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum WireName {
    /// Text lines of fdcanusb on a pseudo-terminal
    Fdcanusb,
    /// Text lines of slcan (LAWICEL) on a pseudo-terminal
    Slcan,
    /// socketcand over TCP on 127.0.0.1
    Socketcand,
    /// Bytes of a serial bus on a pseudo-terminal
    Serial,
}

/// Unit of transfer on a bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Packet {
    /// CAN frame.
    Frame(Frame),
    /// Bytes of a serial bus.
    Bytes(Vec<u8>),
}

/// Item that a client sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Received {
    /// Packet for the bus.
    Packet(Packet),
    /// Bytes of a serial bus that complete no packet.
    Part(Vec<u8>),
    /// Answer of the adapter itself.
    Answer(Vec<u8>),
    /// Text that the adapter does not understand.
    Malformed,
}

/// Codec of one client's line, with its state.
pub trait Wire: Send {
    /// Takes bytes of the client; returns what they complete.
    fn receive(&mut self, bytes: &[u8]) -> Vec<Received>;

    /// Encodes a packet from the bus for the client; `None` if the client does not listen or cannot take it.
    fn encode(&mut self, packet: &Packet) -> Option<Vec<u8>>;

    /// Text for a client that has just connected.
    fn greeting(&self) -> &'static [u8] {
        b""
    }
}

/// Wire in its initial state.
pub fn wire(name: WireName) -> Box<dyn Wire> {
    match name {
        WireName::Fdcanusb => Box::new(fdcanusb::Fdcanusb::default()),
        WireName::Slcan => Box::new(slcan::Slcan::default()),
        WireName::Socketcand => Box::new(socketcand::Socketcand::default()),
        WireName::Serial => Box::new(serial::Serial::default()),
    }
}

/// Splits bytes into lines and drops lines that are longer than any command.
#[derive(Debug, Default)]
struct Lines {
    line: Vec<u8>,
    is_too_long: bool,
}

impl Lines {
    /// Longest command: a CAN FD frame in hexadecimal digits with flags and checksum.
    const MAX_LENGTH: usize = 256;

    /// Takes bytes; returns the lines that they complete, without their ends, and `None` for a line that is too long.
    fn take(&mut self, bytes: &[u8], is_end: fn(u8) -> bool) -> Vec<Option<String>> {
        let mut lines = Vec::new();
        for byte in bytes {
            if is_end(*byte) {
                let line = std::mem::take(&mut self.line);
                let is_too_long = std::mem::take(&mut self.is_too_long);
                lines.push((!is_too_long).then(|| String::from_utf8_lossy(&line).into_owned()));
            } else {
                self.is_too_long |= self.line.len() >= Self::MAX_LENGTH;
                if !self.is_too_long {
                    self.line.push(*byte);
                }
            }
        }
        lines
    }
}

/// True for the end of a line of an adapter: either of the two that clients send.
fn is_line_end(byte: u8) -> bool {
    matches!(byte, b'\r' | b'\n')
}

#[cfg(test)]
mod tests;

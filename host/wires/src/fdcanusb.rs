//! fdcanusb: the text of mjbots' CAN FD adapter. A line ends in a line feed.
//!
//! | line of the client | answer |
//! |---|---|
//! | `can send ID DATA FLAGS`, `can std ..`, `can ext ..` | `OK`, or `ERR` with a reason |
//! | `can on`, `can off`, `can status`, `conf ..` | `OK` |
//!
//! Flags: `B`, `F`, `R` turn bit rate switch, CAN FD and remote frame on, lower-case letters turn them off. Frames of
//! the bus arrive as `rcv ID DATA FLAGS`. A line may end in ` *XX`, a CRC-8 with polynomial 0x97 over everything before
//! the asterisk; the answer and all frames that follow then have one as well.

use drives::Frame;
use drives::frame::Kind;

use super::slcan::identifier;
use super::{Lines, Packet, Received, Wire, hex, is_line_end};

/// State of an adapter.
#[derive(Debug, Default)]
pub struct Fdcanusb {
    lines: Lines,
    /// True once the last line of the client had a checksum.
    has_checksum: bool,
}

impl Fdcanusb {
    fn line(&mut self, line: &str, received: &mut Vec<Received>) {
        let command = match line.trim().rsplit_once('*') {
            Some((before, checksum)) => {
                self.has_checksum = true;
                let is_right = hex::number(checksum.trim()) == Some(crc8(before.as_bytes()).into());
                if !is_right {
                    received.push(Received::Malformed);
                    return self.answer("ERR checksum", received);
                }
                before.trim()
            }
            None => {
                self.has_checksum = false;
                line.trim()
            }
        };
        let words: Vec<&str> = command.split_whitespace().collect();
        match words.as_slice() {
            [] => {}
            ["can", "on" | "off", ..] | ["can", "status"] | ["conf", ..] => self.answer("OK", received),
            ["can", kind @ ("send" | "std" | "ext"), id, rest @ ..] => match decode(kind, id, rest) {
                Some(frame) => {
                    self.answer("OK", received);
                    received.push(Received::Packet(Packet::Frame(frame)));
                }
                None => {
                    received.push(Received::Malformed);
                    self.answer("ERR malformed frame", received);
                }
            },
            _ => {
                received.push(Received::Malformed);
                self.answer("ERR unknown command", received);
            }
        }
    }

    fn answer(&self, text: &str, received: &mut Vec<Received>) {
        received.push(Received::Answer(self.finished(text).into_bytes()));
    }

    /// Line with its end, and with a checksum if the client uses them.
    fn finished(&self, text: &str) -> String {
        if !self.has_checksum {
            return format!("{text}\r\n");
        }
        let before = format!("{text} ");
        format!("{before}*{:02X}\r\n", crc8(before.as_bytes()))
    }
}

impl Wire for Fdcanusb {
    fn receive(&mut self, bytes: &[u8]) -> Vec<Received> {
        let mut received = Vec::new();
        for line in self.lines.take(bytes, is_line_end) {
            match line {
                Some(line) => self.line(&line, &mut received),
                None => received.push(Received::Malformed),
            }
        }
        received
    }

    fn encode(&mut self, packet: &Packet) -> Option<Vec<u8>> {
        let Packet::Frame(frame) = packet else { return None };
        let letter = |is_on: bool, letter: char| if is_on { letter } else { letter.to_ascii_lowercase() };
        let (is_flexible, switches) = match frame.kind {
            Kind::Flexible(switches) => (true, switches),
            _ => (false, false),
        };
        let mut text = format!("rcv {:X} {}", frame.raw_id(), hex::digits(frame.data()));
        text += &format!(
            " {} {} {}",
            letter(frame.extended_id().is_some(), 'E'),
            letter(switches, 'B'),
            letter(is_flexible, 'F')
        );
        if frame.kind == Kind::Remote {
            text += " R";
        }
        Some(self.finished(&text).into_bytes())
    }
}

/// Frame of a command. Without flags a frame is CAN FD with the second bit rate, as the adapter is configured.
fn decode(kind: &str, id: &str, rest: &[&str]) -> Option<Frame> {
    let number = hex::number(id)?;
    let id = identifier(number, kind == "ext" || (kind == "send" && number >= 1 << 11))?;
    let (data, flags) = match rest {
        [first, flags @ ..] if hex::bytes(first).is_some() && !is_flag(first) => (hex::bytes(first)?, flags),
        flags => (Vec::new(), flags),
    };
    let (mut is_flexible, mut switches, mut is_remote) = (true, true, false);
    for flag in flags {
        match *flag {
            "F" | "f" => is_flexible = *flag == "F",
            "B" | "b" => switches = *flag == "B",
            "R" | "r" => is_remote = *flag == "R",
            other if other.starts_with('t') => {}
            // An adapter takes flags as one word as well.
            "BF" => (switches, is_flexible) = (true, true),
            "bf" => (switches, is_flexible) = (false, false),
            "bF" => (switches, is_flexible) = (false, true),
            _ => return None,
        }
    }
    if is_remote {
        return Frame::remote(id, data.len() as u8);
    }
    let kind = if is_flexible { Kind::Flexible(switches) } else { Kind::Classic };
    match kind {
        Kind::Flexible(_) => {
            let padded = Frame::flexible(id, &data, 0x50)?;
            Frame::with_kind(id, kind, padded.data())
        }
        _ => Frame::with_kind(id, kind, &data),
    }
}

/// True for a word of flags, of which some are hexadecimal digits as well.
fn is_flag(word: &str) -> bool {
    matches!(word, "B" | "b" | "F" | "f" | "BF" | "bf" | "bF")
}

/// CRC-8 with polynomial 0x97, initial value 0, not reflected.
fn crc8(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0_u8, |crc, byte| {
        (0..8).fold(crc ^ byte, |crc, _| if crc & 0x80 == 0 { crc << 1 } else { (crc << 1) ^ 0x97 })
    })
}

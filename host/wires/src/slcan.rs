//! slcan: the text of LAWICEL's CANUSB, with the CAN FD frames of later adapters. A line ends in a carriage return.
//!
//! | command | meaning |
//! |---|---|
//! | `O`, `L`, `C` | open, open and listen only, close |
//! | `S`n, `s`xxxx, `Y`n, `M`, `m`, `X`, `Z`, `W` with digits | settings of the adapter: accepted |
//! | `t`iiildd.., `T`iiiiiiiildd.. | data frame with 11 or 29 bits |
//! | `r`iiil, `R`iiiiiiiil | remote frame |
//! | `d`, `D`; `b`, `B` | CAN FD frame without or with the second bit rate; the length is a DLC of 0 to F |
//! | `V`, `N`, `F` | version, serial number, status |
//!
//! Frames and settings are not answered: python-can does not read the answers and would take them for frames.

use drives::Frame;
use drives::frame::{Id, Kind, LENGTHS, extended, length_code, standard};

use super::{Lines, Packet, Received, Wire, hex, is_line_end};

/// State of an adapter.
#[derive(Debug, Default)]
pub struct Slcan {
    lines: Lines,
    is_open: bool,
    listens_only: bool,
}

impl Slcan {
    fn command(&mut self, line: &str) -> Option<Received> {
        let first = line.chars().next()?;
        match first {
            'O' | 'L' => (self.is_open, self.listens_only) = (true, first == 'L'),
            'C' => self.is_open = false,
            'S' | 's' | 'Y' | 'y' | 'M' | 'm' | 'X' | 'Z' | 'W' | 'Q' => {}
            'V' => return Some(Received::Answer(b"V1013\r".into())),
            'N' => return Some(Received::Answer(b"NTWIN\r".into())),
            'F' => return Some(Received::Answer(b"F00\r".into())),
            't' | 'T' | 'r' | 'R' | 'd' | 'D' | 'b' | 'B' => {
                return match decode(line).filter(|_| self.is_open && !self.listens_only) {
                    Some(frame) => Some(Received::Packet(Packet::Frame(frame))),
                    None => Some(Received::Malformed),
                };
            }
            _ => return Some(Received::Malformed),
        }
        None
    }
}

impl Wire for Slcan {
    fn receive(&mut self, bytes: &[u8]) -> Vec<Received> {
        let lines = self.lines.take(bytes, is_line_end).into_iter();
        lines.filter_map(|line| line.map_or(Some(Received::Malformed), |line| self.command(&line))).collect()
    }

    fn encode(&mut self, packet: &Packet) -> Option<Vec<u8>> {
        match packet {
            Packet::Frame(frame) if self.is_open => Some(encode(frame).into_bytes()),
            _ => None,
        }
    }
}

fn encode(frame: &Frame) -> String {
    let is_extended = frame.extended_id().is_some();
    let letter = match (frame.kind, is_extended) {
        (Kind::Classic, false) => 't',
        (Kind::Classic, true) => 'T',
        (Kind::Remote, false) => 'r',
        (Kind::Remote, true) => 'R',
        (Kind::Flexible(false), false) => 'd',
        (Kind::Flexible(false), true) => 'D',
        (Kind::Flexible(true), false) => 'b',
        (Kind::Flexible(true), true) => 'B',
    };
    let dlc = length_code(frame.length());
    let width = if is_extended { 8 } else { 3 };
    format!("{letter}{:0width$X}{dlc:X}{}\r", frame.raw_id(), hex::digits(frame.data()))
}

fn decode(line: &str) -> Option<Frame> {
    if !line.is_ascii() {
        return None;
    }
    let (letter, rest) = line.split_at(1);
    let kind = match letter {
        "t" | "T" => Kind::Classic,
        "r" | "R" => Kind::Remote,
        "d" | "D" => Kind::Flexible(false),
        _ => Kind::Flexible(true),
    };
    let is_extended = letter.chars().all(char::is_uppercase);
    let (id, rest) = rest.split_at_checked(if is_extended { 8 } else { 3 })?;
    let id = identifier(hex::number(id)?, is_extended)?;
    let (dlc, data) = rest.split_at_checked(1)?;
    let length = LENGTHS.get(hex::number(dlc)? as usize).copied()?;
    if kind == Kind::Remote {
        return data.is_empty().then(|| Frame::remote(id, length as u8))?;
    }
    // Digits after the data are a time stamp.
    let data = hex::bytes(data.get(..2 * length)?)?;
    Frame::with_kind(id, kind, &data)
}

/// Identifier of a number, if it has room for it.
pub(super) fn identifier(number: u32, is_extended: bool) -> Option<Id> {
    match is_extended {
        true => (number < 1 << 29).then(|| extended(number)),
        false => (number < 1 << 11).then(|| standard(number as u16)),
    }
}

//! socketcand: CAN over TCP as text in angle brackets.
//!
//! | from the client | answer |
//! |---|---|
//! | (connected) | `< hi >` |
//! | `< open can0 >`, `< rawmode >`, `< bcmmode >`, `< echo >` | `< ok >`, `< echo >` |
//! | `< send ID LENGTH BYTE .. >` | none |
//!
//! In raw mode frames of the bus arrive as `< frame ID SECONDS.MICROSECONDS DATA >`. An identifier of eight digits has
//! 29 bits. The time is that of this machine's clock.

use std::time::{SystemTime, UNIX_EPOCH};

use drives::Frame;
use drives::frame::Kind;

use super::slcan::identifier;
use super::{Lines, Packet, Received, Wire, hex};

/// State of a connection.
#[derive(Debug, Default)]
pub struct Socketcand {
    lines: Lines,
    is_raw: bool,
}

impl Socketcand {
    fn command(&mut self, line: &str) -> Received {
        let Some((_, text)) = line.split_once('<') else { return Received::Malformed };
        let words: Vec<&str> = text.split_whitespace().collect();
        let ok = || Received::Answer(b"< ok >".into());
        match words.as_slice() {
            ["open", _] | ["bcmmode"] | ["controlmode"] => {
                self.is_raw = false;
                ok()
            }
            ["rawmode"] => {
                self.is_raw = true;
                ok()
            }
            ["echo"] => Received::Answer(b"< echo >".into()),
            ["send", id, length, data @ ..] => match decode(id, length, data) {
                Some(frame) => Received::Packet(Packet::Frame(frame)),
                None => Received::Malformed,
            },
            _ => Received::Answer(b"< error unknown command >".into()),
        }
    }
}

impl Wire for Socketcand {
    fn receive(&mut self, bytes: &[u8]) -> Vec<Received> {
        let lines = self.lines.take(bytes, |byte| byte == b'>').into_iter();
        lines.map(|line| line.map_or(Received::Malformed, |line| self.command(&line))).collect()
    }

    fn encode(&mut self, packet: &Packet) -> Option<Vec<u8>> {
        match packet {
            // The protocol has no CAN FD and no remote frames.
            Packet::Frame(frame) if self.is_raw && frame.kind == Kind::Classic => {
                let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
                let width = if frame.extended_id().is_some() { 8 } else { 3 };
                let (id, data) = (frame.raw_id(), hex::digits(frame.data()));
                Some(
                    format!("< frame {id:0width$X} {}.{:06} {data} >", now.as_secs(), now.subsec_micros()).into_bytes(),
                )
            }
            _ => None,
        }
    }

    fn greeting(&self) -> &'static [u8] {
        b"< hi >"
    }
}

fn decode(id: &str, length: &str, data: &[&str]) -> Option<Frame> {
    let id = identifier(hex::number(id)?, id.len() == 8)?;
    let data: Vec<u8> =
        data.iter().map(|byte| hex::number(byte).and_then(|byte| u8::try_from(byte).ok())).collect::<Option<_>>()?;
    (length.parse() == Ok(data.len())).then(|| Frame::with_kind(id, Kind::Classic, &data))?
}

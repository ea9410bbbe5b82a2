//! Identifier and fields of 16 bits.

use crate::frame::{self, Frame, Kind};
use crate::scale;

/// Target of the answer to an identification.
pub(super) const BROADCAST: u8 = 0xFE;

/// Types of frames.
pub(super) mod kind {
    pub const IDENTIFY: u8 = 0;
    pub const OPERATION: u8 = 1;
    pub const FEEDBACK: u8 = 2;
    pub const ENABLE: u8 = 3;
    pub const STOP: u8 = 4;
    pub const CALIBRATE: u8 = 5;
    pub const SET_ZERO: u8 = 6;
    pub const SET_ADDRESS: u8 = 7;
    pub const READ: u8 = 17;
    pub const WRITE: u8 = 18;
    pub const FAULT: u8 = 21;
    /// Bit rate on CyberGear, saving on RobStride.
    pub const RATE_OR_SAVE: u8 = 22;
    pub const RATE: u8 = 23;
    pub const REPORT: u8 = 24;
    pub const PROTOCOL: u8 = 25;
}

/// Parts of an identifier.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Header {
    /// Type.
    pub kind: u8,
    /// Data between type and target.
    pub data: u16,
    /// Target address.
    pub target: u8,
}

impl Header {
    /// Header of a classical frame with a 29-bit identifier; `None` for other frames.
    pub fn read(frame: &Frame) -> Option<Self> {
        let id = frame.extended_id().filter(|_| frame.kind == Kind::Classic)?;
        Some(Self { kind: (id >> 24) as u8, data: (id >> 8) as u16, target: id as u8 })
    }

    /// Frame with this header.
    pub fn frame(self, data: &[u8]) -> Option<Frame> {
        let id = u32::from(self.kind) << 24 | u32::from(self.data) << 8 | u32::from(self.target);
        Frame::classic(frame::extended(id), data)
    }
}

/// Field of 16 bits over a range, high byte first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Value of 0.
    pub low: f32,
    /// Value of 65535.
    pub high: f32,
}

impl Field {
    /// Range from -`half` to `half`.
    pub(super) const fn around_zero(half: f32) -> Self {
        Self { low: -half, high: half }
    }

    /// Range from 0 to `high`.
    pub(super) const fn up_to(high: f32) -> Self {
        Self { low: 0.0, high }
    }

    /// Number next to a value.
    pub fn encode(self, value: f32) -> u16 {
        scale::to_range(value, self.low, self.high, 16) as u16
    }

    /// Value of a number.
    pub fn decode(self, number: u16) -> f32 {
        scale::from_range(number.into(), self.low, self.high, 16)
    }
}

/// Data bytes of four numbers, high bytes first.
pub(super) fn join(numbers: [u16; 4]) -> [u8; 8] {
    let [a, b, c, d] = numbers.map(u16::to_be_bytes);
    [a[0], a[1], b[0], b[1], c[0], c[1], d[0], d[1]]
}

/// Four numbers of data bytes, high bytes first.
pub(super) fn split(bytes: [u8; 8]) -> [u16; 4] {
    let [a, b, c, d, e, f, g, h] = bytes;
    [[a, b], [c, d], [e, f], [g, h]].map(u16::from_be_bytes)
}

//! Addresses and subframes: the multiplex protocol under the registers.

use heapless::Vec;

use super::value::{Resolution, Value};
use crate::frame::{Frame, Id, Kind, MAX_DATA, extended, standard};

/// Byte that fills a frame up to a length that CAN FD has: a subframe without an effect.
pub const PADDING: u8 = 0x50;
/// Identifier that every drive takes as its own.
pub const BROADCAST: u8 = 0x7f;
/// Error of an unknown register.
pub const UNKNOWN_REGISTER: u32 = 1;
/// Error of a write to a register that can only be read.
pub const NOT_WRITABLE: u32 = 2;

/// Data of a frame under construction.
pub type Payload = Vec<u8, MAX_DATA>;

/// Address in the identifier of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Address {
    /// Sender, 7 bits.
    pub source: u8,
    /// True if the receiver is to reply.
    pub wants_reply: bool,
    /// Receiver; 7 bits are used.
    pub destination: u8,
    /// Prefix, 13 bits.
    pub prefix: u16,
}

impl Address {
    /// Address of a frame.
    pub fn of(frame: &Frame) -> Self {
        let id = frame.raw_id();
        Self {
            source: (id >> 8) as u8 & 0x7f,
            wants_reply: id & 0x8000 != 0,
            destination: id as u8,
            prefix: (id >> 16) as u16,
        }
    }

    /// Identifier; of 29 bits where 11 bits do not suffice.
    pub fn id(self) -> Id {
        let source = u16::from(self.source & 0x7f) | if self.wants_reply { 0x80 } else { 0 };
        let low = source << 8 | u16::from(self.destination);
        if self.prefix == 0 && low <= 0x7ff {
            standard(low)
        } else {
            extended(u32::from(self.prefix) << 16 | u32::from(low))
        }
    }

    /// Frame with this address; `flexible` is true for the second bit rate. `None` for more than 64 bytes.
    pub fn frame(self, data: &[u8], flexible: bool) -> Option<Frame> {
        let mut frame = Frame::flexible(self.id(), data, PADDING)?;
        frame.kind = Kind::Flexible(flexible);
        Some(frame)
    }
}

/// Consecutive registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Registers {
    /// Resolution of all values.
    pub resolution: Resolution,
    /// Number of registers.
    pub count: u32,
    /// First register.
    pub first: u32,
    /// True if the number stands in the first byte.
    pub is_short: bool,
}

impl Registers {
    /// Registers in the shorter form.
    pub fn new(resolution: Resolution, first: u32, count: u32) -> Self {
        Self { resolution, count, first, is_short: (1..=3).contains(&count) }
    }
}

/// Start of a subframe; the values of registers follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subframe<'d> {
    /// Values to write.
    Write(Registers),
    /// Registers to read; no values follow.
    Read(Registers),
    /// Values that were read.
    Reply(Registers),
    /// Register that could not be written, and the error.
    WriteError(u32, u32),
    /// Register that could not be read, and the error.
    ReadError(u32, u32),
    /// Bytes for the diagnostic channel of the drive.
    ToServer(u32, &'d [u8]),
    /// Bytes from the diagnostic channel of the drive.
    ToClient(u32, &'d [u8]),
    /// Request for up to a number of bytes from a diagnostic channel.
    Poll(u32, u32),
}

const WRITE: u8 = 0x00;
const READ: u8 = 0x10;
const REPLY: u8 = 0x20;
const WRITE_ERROR: u8 = 0x30;
const READ_ERROR: u8 = 0x31;
const TO_SERVER: u8 = 0x40;
const TO_CLIENT: u8 = 0x41;
const POLL: u8 = 0x42;

/// Data of a frame that is still to be read.
#[derive(Debug, Clone, Copy)]
pub struct Reader<'d>(&'d [u8]);

impl<'d> Reader<'d> {
    /// Reader of all data.
    pub fn new(data: &'d [u8]) -> Self {
        Self(data)
    }

    /// Next subframe; `None` at the end and at a malformed or unknown subframe.
    pub fn subframe(&mut self) -> Option<Subframe<'d>> {
        let mut code = self.byte()?;
        while code == PADDING {
            code = self.byte()?;
        }
        Some(match code & 0xf0 {
            WRITE => Subframe::Write(self.registers(code)?),
            READ => Subframe::Read(self.registers(code)?),
            REPLY => Subframe::Reply(self.registers(code)?),
            _ => match code {
                WRITE_ERROR => Subframe::WriteError(self.varuint()?, self.varuint()?),
                READ_ERROR => Subframe::ReadError(self.varuint()?, self.varuint()?),
                TO_SERVER => Subframe::ToServer(self.varuint()?, self.counted()?),
                TO_CLIENT => Subframe::ToClient(self.varuint()?, self.counted()?),
                POLL => Subframe::Poll(self.varuint()?, self.varuint()?),
                _ => return None,
            },
        })
    }

    /// Next value.
    pub fn value(&mut self, resolution: Resolution) -> Option<Value> {
        Some(match resolution {
            Resolution::Int8 => Value::Int8(i8::from_le_bytes(self.array()?)),
            Resolution::Int16 => Value::Int16(i16::from_le_bytes(self.array()?)),
            Resolution::Int32 => Value::Int32(i32::from_le_bytes(self.array()?)),
            Resolution::Float => Value::Float(f32::from_le_bytes(self.array()?)),
        })
    }

    fn registers(&mut self, code: u8) -> Option<Registers> {
        let (short, resolution) = (u32::from(code & 3), Resolution::from_code(code >> 2));
        let count = if short == 0 { self.varuint()? } else { short };
        Some(Registers { resolution, count, first: self.varuint()?, is_short: short != 0 })
    }

    /// Number of up to five bytes with seven bits each, the least significant first.
    fn varuint(&mut self) -> Option<u32> {
        let mut number = 0_u32;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            number |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(number);
            }
        }
        None
    }

    fn counted(&mut self) -> Option<&'d [u8]> {
        let count = self.varuint()?;
        let (bytes, rest) = self.0.split_at_checked(usize::try_from(count).ok()?)?;
        self.0 = rest;
        Some(bytes)
    }

    fn byte(&mut self) -> Option<u8> {
        self.array().map(|[byte]| byte)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*bytes)
    }
}

/// Appends the start of a subframe; appends nothing and returns `None` if the frame is full.
pub fn put_subframe(payload: &mut Payload, subframe: Subframe<'_>) -> Option<()> {
    let start = payload.len();
    let put = put_start(payload, subframe);
    if put.is_none() {
        payload.truncate(start);
    }
    put
}

fn put_start(payload: &mut Payload, subframe: Subframe<'_>) -> Option<()> {
    let (code, numbers, bytes): (u8, [u32; 2], &[u8]) = match subframe {
        Subframe::Write(registers) => return put_registers(payload, WRITE, registers),
        Subframe::Read(registers) => return put_registers(payload, READ, registers),
        Subframe::Reply(registers) => return put_registers(payload, REPLY, registers),
        Subframe::WriteError(register, error) => (WRITE_ERROR, [register, error], &[]),
        Subframe::ReadError(register, error) => (READ_ERROR, [register, error], &[]),
        Subframe::ToServer(channel, bytes) => (TO_SERVER, [channel, bytes.len() as u32], bytes),
        Subframe::ToClient(channel, bytes) => (TO_CLIENT, [channel, bytes.len() as u32], bytes),
        Subframe::Poll(channel, most) => (POLL, [channel, most], &[]),
    };
    payload.push(code).ok()?;
    numbers.into_iter().try_for_each(|number| put_varuint(payload, number))?;
    payload.extend_from_slice(bytes).ok()
}

/// Appends a value; `None` if the frame is full.
pub fn put_value(payload: &mut Payload, value: Value) -> Option<()> {
    match value {
        Value::Int8(number) => payload.extend_from_slice(&number.to_le_bytes()),
        Value::Int16(number) => payload.extend_from_slice(&number.to_le_bytes()),
        Value::Int32(number) => payload.extend_from_slice(&number.to_le_bytes()),
        Value::Float(number) => payload.extend_from_slice(&number.to_le_bytes()),
    }
    .ok()
}

fn put_registers(payload: &mut Payload, code: u8, registers: Registers) -> Option<()> {
    let short = if registers.is_short { registers.count as u8 & 3 } else { 0 };
    payload.push(code | registers.resolution.code() << 2 | short).ok()?;
    if !registers.is_short {
        put_varuint(payload, registers.count)?;
    }
    put_varuint(payload, registers.first)
}

fn put_varuint(payload: &mut Payload, mut number: u32) -> Option<()> {
    for _ in 0..5 {
        let (low, more) = (number as u8 & 0x7f, number > 0x7f);
        payload.push(if more { low | 0x80 } else { low }).ok()?;
        if !more {
            break;
        }
        number >>= 7;
    }
    Some(())
}

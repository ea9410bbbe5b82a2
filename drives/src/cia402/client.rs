//! Client: frames that command a CiA 402 drive, and the answers.

use super::dictionary::{Address, Direction, PDO_COUNT};
use super::nmt::{Nmt, NmtCommand};
use super::pdo;
use super::sdo::{Sdo, Side};
use crate::frame::{Frame, standard};
use heapless::Vec;

/// Frame of the drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Boot-up (initialising), heartbeat or guarding answer.
    State(Nmt),
    /// Error; code 0 when the errors are over.
    Emergency {
        /// Error code.
        code: u16,
        /// Error register.
        register: u8,
    },
    /// Answer of the SDO server.
    Sdo(Sdo),
    /// Transmit PDO with a number from 1.
    Pdo(u8, pdo::Data),
}

/// Command of the network management; node 0 for all nodes.
pub fn manage(command: NmtCommand, node: u8) -> Option<Frame> {
    Frame::classic(standard(0), &[command as u8, node])
}

/// SYNC.
pub fn sync() -> Option<Frame> {
    Frame::classic(standard(0x80), &[])
}

/// Heartbeat of a master.
pub fn heartbeat(master: u8, state: Nmt) -> Option<Frame> {
    Frame::classic(id(0x700, master), &[state as u8])
}

/// Request of node guarding.
pub fn guard(node: u8) -> Option<Frame> {
    Frame::remote(id(0x700, node), 1)
}

/// Value of the consumer heartbeat time 1016h:01 for a master and a time [ms].
pub fn consumer_heartbeat(master: u8, time: u16) -> u32 {
    u32::from(master) << 16 | u32::from(time)
}

/// Request of an SDO transfer.
pub fn request(node: u8, sdo: &Sdo) -> Option<Frame> {
    Frame::classic(id(0x600, node), &sdo.encode(Side::Request))
}

/// Request to read an object.
pub fn upload(node: u8, address: Address) -> Option<Frame> {
    request(node, &Sdo::Empty { address })
}

/// Request to write a number of an object of the dictionary; the bits of a float. `None` for an unknown object.
pub fn download(node: u8, address: Address, raw: u32) -> Option<Frame> {
    request(node, &Sdo::expedited(address, raw, address.entry()?.kind.size()))
}

/// Receive PDO with a number from 1 under a mapping, as of [`mapping`]. `None` for a frame that is too long.
pub fn receive_pdo(node: u8, number: u8, mappings: &[u32], values: &[u32]) -> Option<Frame> {
    let mut data = pdo::Data::new();
    let fits =
        mappings.iter().zip(values).all(|(mapping, raw)| pdo::pack(&mut data, *raw, pdo::size_of_mapping(*mapping)));
    let base = Direction::Receive.base_id(position(number)?) as u16;
    fits.then(|| Frame::classic(id(base, node), &data)).flatten()
}

/// Mapping of a PDO with a number from 1 after power-up of the drive.
pub fn mapping(direction: Direction, number: u8) -> Vec<u32, 8> {
    let Some(position) = position(number) else { return Vec::new() };
    let initial = |sub| Address::new(direction.mapping(position), sub).entry().map_or(0, |entry| entry.initial(0));
    (1..=initial(0).min(8) as u8).map(initial).collect()
}

/// Value of an object in a PDO under a mapping, with its sign; the bits of a float.
pub fn value(address: Address, mappings: &[u32], data: &[u8]) -> Option<i64> {
    let (_, raw) = pdo::unpack(mappings, data).find(|(mapped, _)| *mapped == address)?;
    number(address, raw)
}

/// Value of an object in an SDO answer, with its sign; the bits of a float.
pub fn uploaded(address: Address, answer: &Answer) -> Option<i64> {
    match answer {
        Answer::Sdo(Sdo::Expedited { address: read, data, .. }) if *read == address => {
            number(address, u32::from_le_bytes(*data))
        }
        _ => None,
    }
}

/// Decodes a frame of a node; `None` for other frames.
pub fn decode(node: u8, frame: &Frame) -> Option<Answer> {
    let (base, data) = (frame.standard_id()?.checked_sub(node.into())?, frame.data());
    Some(match base {
        0x700 => Answer::State(Nmt::from_code(*data.first()?)?),
        0x80 => {
            let [low, high, register, ..] = frame.bytes::<8>()?;
            Answer::Emergency { code: u16::from_le_bytes([low, high]), register }
        }
        0x580 => Answer::Sdo(Sdo::decode(Side::Response, &frame.bytes()?)?),
        _ => {
            let number = (0..PDO_COUNT).find(|number| Direction::Transmit.base_id(*number) == u32::from(base))?;
            Answer::Pdo(number as u8 + 1, Vec::from_slice(data).ok()?)
        }
    })
}

fn number(address: Address, raw: u32) -> Option<i64> {
    Some(address.entry()?.kind.number(raw))
}

fn id(base: u16, node: u8) -> crate::frame::Id {
    standard(base + u16::from(node & 0x7F))
}

/// Position of a PDO with a number from 1.
fn position(number: u8) -> Option<usize> {
    usize::from(number).checked_sub(1).filter(|position| *position < PDO_COUNT)
}

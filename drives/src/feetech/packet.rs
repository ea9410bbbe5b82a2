//! Packets on the bus: header FF FF, identifier, length, instruction or error bits, parameters, checksum.
//!
//! The length counts the bytes behind it. The checksum is the complement of the sum from the identifier to the last
//! parameter.

use heapless::Vec;

/// Identifier of a packet for every servo on the bus.
pub const BROADCAST: u8 = 0xFE;

/// Most parameters of a packet.
pub const MAX_PARAMETERS: usize = 253;

/// Most bytes of a packet.
pub const MAX_BYTES: usize = MAX_PARAMETERS + 6;

/// Bytes of a packet, or a part of them.
pub type Bytes = Vec<u8, MAX_BYTES>;

const HEADER: u8 = 0xFF;

/// Instruction of a client.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Instruction {
    /// Asks for a status packet.
    Ping = 0x01,
    /// Reads registers: first address, number of bytes.
    Read = 0x02,
    /// Writes registers: first address, bytes.
    Write = 0x03,
    /// Keeps a write for [`Instruction::Action`].
    RegisterWrite = 0x04,
    /// Executes the kept write.
    Action = 0x05,
    /// Restores the backup of the registers that survive a power cycle, except for the identifier.
    Recovery = 0x06,
    /// Restarts the servo as after power-up; there is no answer.
    Reboot = 0x08,
    /// Makes the present registers the backup.
    Backup = 0x09,
    /// Resets the count of turns.
    Reset = 0x0A,
    /// Makes the present angle the middle, 2048 steps, or the angle given by two bytes.
    Calibrate = 0x0B,
    /// Reads the same registers of several servos: first address, number of bytes, identifiers.
    SyncRead = 0x82,
    /// Writes the same registers of several servos: first address, number of bytes, then identifier and bytes of each.
    SyncWrite = 0x83,
}

impl Instruction {
    /// Instruction of a code.
    pub fn decode(code: u8) -> Option<Self> {
        const ALL: [Instruction; 12] = [
            Instruction::Ping,
            Instruction::Read,
            Instruction::Write,
            Instruction::RegisterWrite,
            Instruction::Action,
            Instruction::Recovery,
            Instruction::Reboot,
            Instruction::Backup,
            Instruction::Reset,
            Instruction::Calibrate,
            Instruction::SyncRead,
            Instruction::SyncWrite,
        ];
        ALL.into_iter().find(|instruction| *instruction as u8 == code)
    }
}

/// Packet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Packet {
    /// Identifier of the servo: the receiver of an instruction, the sender of a status.
    pub id: u8,
    /// Instruction, or error bits of a status.
    pub code: u8,
    parameters: Vec<u8, MAX_PARAMETERS>,
}

impl Packet {
    /// Packet; `None` with too many parameters.
    pub fn new(id: u8, code: u8, parameters: &[u8]) -> Option<Self> {
        Some(Self { id, code, parameters: Vec::from_slice(parameters).ok()? })
    }

    /// Parameters.
    pub fn parameters(&self) -> &[u8] {
        &self.parameters
    }

    /// Bytes on the bus.
    pub fn to_bytes(&self) -> Bytes {
        let length = self.parameters.len() as u8 + 2;
        let ends = [self.id, length, self.code];
        let checksum = checksum(ends.iter().chain(&self.parameters));
        [HEADER; 2].into_iter().chain(ends).chain(self.parameters.iter().copied()).chain([checksum]).collect()
    }
}

fn checksum<'b>(bytes: impl Iterator<Item = &'b u8>) -> u8 {
    !bytes.fold(0_u8, |sum, byte| sum.wrapping_add(*byte))
}

/// Receiver that finds the packets in a stream of bytes.
#[derive(Debug, Clone, Default)]
pub struct Receiver {
    headers: u8,
    /// Identifier, length, code, parameters, checksum.
    body: Vec<u8, { MAX_PARAMETERS + 4 }>,
}

impl Receiver {
    /// Handles a byte; returns the packet that it completes. Packets with a wrong checksum are dropped.
    pub fn receive(&mut self, byte: u8) -> Option<Packet> {
        if self.headers < 2 {
            self.headers = if byte == HEADER { self.headers + 1 } else { 0 };
            return None;
        }
        if self.body.is_empty() && byte == HEADER {
            return None;
        }
        let is_too_short = self.body.len() == 1 && byte < 2;
        if is_too_short || self.body.push(byte).is_err() {
            self.reset();
            return None;
        }
        let [id, length, rest @ ..] = self.body.as_slice() else { return None };
        if rest.len() < usize::from(*length) {
            return None;
        }
        let packet = open(*id, *length, rest);
        self.reset();
        packet
    }

    /// Drops the bytes of a packet that is not complete.
    pub fn reset(&mut self) {
        self.headers = 0;
        self.body.clear();
    }
}

/// Packet of its bytes behind the length, if the checksum is right.
fn open(id: u8, length: u8, rest: &[u8]) -> Option<Packet> {
    let (found, content) = rest.split_last()?;
    let (code, parameters) = content.split_first()?;
    (checksum([id, length].iter().chain(content)) == *found).then(|| Packet::new(id, *code, parameters))?
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec;

    fn packets(bytes: &[u8]) -> std::vec::Vec<Packet> {
        let mut receiver = Receiver::default();
        bytes.iter().filter_map(|byte| receiver.receive(*byte)).collect()
    }

    #[test]
    fn packet_is_found_behind_noise() {
        let wanted = Packet::new(1, 0, &[0x18, 0x05]).unwrap();
        // Third header byte, wrong checksum and impossible length before the packet.
        let mut bytes = vec![1, 0xFF, 3, 0xFF, 0xFF, 1, 2, 0, 0, 0xFF, 0xFF, 1, 1, 0xFF];
        bytes.extend(wanted.to_bytes());
        assert_eq!(packets(&bytes), [wanted]);
    }

    #[test]
    fn longest_packet_comes_through() {
        let longest = Packet::new(7, 3, &[0xFF; MAX_PARAMETERS]).unwrap();
        assert_eq!(packets(&longest.to_bytes()), [longest]);
        assert_eq!(Packet::new(7, 3, &[0; MAX_PARAMETERS + 1]), None);
    }

    proptest! {
        #[test]
        fn random_bytes_do_not_panic(bytes: std::vec::Vec<u8>) {
            for packet in packets(&bytes) {
                prop_assert!(!packet.to_bytes().is_empty());
            }
        }
    }
}

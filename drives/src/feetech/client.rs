//! Client of the servos: packets that command them, and their answers.

use super::packet::{BROADCAST, Bytes, Instruction, MAX_PARAMETERS, Packet, Receiver};
use super::table::Field;
use heapless::Vec;

/// Parameters under construction.
type Parameters = Vec<u8, MAX_PARAMETERS>;

/// Status of a servo.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Status {
    /// Identifier of the servo.
    pub id: u8,
    /// Error bits, see [`super::error`].
    pub error: u8,
    data: Parameters,
}

impl Status {
    /// Bytes that were read.
    pub fn data(&self) -> &[u8] {
        &self.data
    }

    /// Value of a register, in the bytes of a read from `address` on.
    pub fn value(&self, address: u8, field: &Field) -> Option<i32> {
        self.data.get(usize::from(field.address.checked_sub(address)?)..).and_then(|bytes| field.decode(bytes))
    }
}

/// Receiver of the answers.
#[derive(Debug, Clone, Default)]
pub struct Answers(Receiver);

impl Answers {
    /// Handles a byte from the bus; returns the status that it completes.
    pub fn receive(&mut self, byte: u8) -> Option<Status> {
        let packet = self.0.receive(byte).filter(|packet| packet.id != BROADCAST)?;
        let data = Vec::from_slice(packet.parameters()).ok()?;
        Some(Status { id: packet.id, error: packet.code, data })
    }
}

/// Asks for the status of a servo, or with [`BROADCAST`] of all.
pub fn ping(id: u8) -> Option<Bytes> {
    instruct(id, Instruction::Ping, &[])
}

/// Reads `length` bytes from an address on.
pub fn read(id: u8, address: u8, length: u8) -> Option<Bytes> {
    instruct(id, Instruction::Read, &[address, length])
}

/// Writes bytes from an address on.
pub fn write(id: u8, address: u8, data: &[u8]) -> Option<Bytes> {
    instruct(id, Instruction::Write, &addressed(&[address], data)?)
}

/// Writes a register.
pub fn set(id: u8, field: &Field, value: i32) -> Option<Bytes> {
    write(id, field.address, field.encode(value).get(..field.width.into())?)
}

/// Keeps a write until [`action`].
pub fn register_write(id: u8, address: u8, data: &[u8]) -> Option<Bytes> {
    instruct(id, Instruction::RegisterWrite, &addressed(&[address], data)?)
}

/// Executes the write that a servo keeps.
pub fn action(id: u8) -> Option<Bytes> {
    instruct(id, Instruction::Action, &[])
}

/// Restores the backup of the kept registers.
pub fn recovery(id: u8) -> Option<Bytes> {
    instruct(id, Instruction::Recovery, &[])
}

/// Makes the present registers the backup.
pub fn backup(id: u8) -> Option<Bytes> {
    instruct(id, Instruction::Backup, &[])
}

/// Restarts a servo.
pub fn reboot(id: u8) -> Option<Bytes> {
    instruct(id, Instruction::Reboot, &[])
}

/// Resets the count of turns.
pub fn reset(id: u8) -> Option<Bytes> {
    instruct(id, Instruction::Reset, &[])
}

/// Makes the present angle a position [steps]; the middle without one.
pub fn calibrate(id: u8, position: Option<u16>) -> Option<Bytes> {
    let bytes = position.unwrap_or_default().to_le_bytes();
    instruct(id, Instruction::Calibrate, if position.is_some() { &bytes } else { &[] })
}

/// Reads `length` bytes from an address on, of several servos.
pub fn sync_read(address: u8, length: u8, ids: &[u8]) -> Option<Bytes> {
    instruct(BROADCAST, Instruction::SyncRead, &addressed(&[address, length], ids)?)
}

/// Writes a register of several servos: identifier and value of each.
pub fn sync_set(field: &Field, values: &[(u8, i32)]) -> Option<Bytes> {
    let mut parameters = Parameters::from_slice(&[field.address, field.width]).ok()?;
    for (id, value) in values {
        parameters.push(*id).ok()?;
        parameters.extend_from_slice(field.encode(*value).get(..field.width.into())?).ok()?;
    }
    instruct(BROADCAST, Instruction::SyncWrite, &parameters)
}

fn addressed(head: &[u8], data: &[u8]) -> Option<Parameters> {
    let mut parameters = Parameters::from_slice(head).ok()?;
    parameters.extend_from_slice(data).ok()?;
    Some(parameters)
}

fn instruct(id: u8, instruction: Instruction, parameters: &[u8]) -> Option<Bytes> {
    Some(Packet::new(id, instruction as u8, parameters)?.to_bytes())
}

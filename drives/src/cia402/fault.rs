//! Error codes, error register and the list of errors.

use crate::drive::Fault;

/// Life guarding or heartbeat failed.
pub const LIFE_GUARD: u16 = 0x8130;
/// The node returned from bus-off.
pub const BUS_OFF: u16 = 0x8140;
/// The node was stopped or reset in operation.
pub const COMMUNICATION: u16 = 0x8100;
/// A PDO was too short for its mapping.
pub const PDO_LENGTH: u16 = 0x8210;
/// An RPDO was missing for longer than its event timer.
pub const PDO_TIMEOUT: u16 = 0x8250;
/// Following error beyond its window.
pub const FOLLOWING_ERROR: u16 = 0x8611;

/// Error code of a fault (IEC 61800-7-201).
pub const fn code(fault: Fault) -> u16 {
    match fault {
        Fault::Watchdog => LIFE_GUARD,
        Fault::MotorEncoder => 0x7305,
        Fault::OutputEncoder => 0x7306,
        Fault::UnderVoltage => 0x3220,
        Fault::OverVoltage => 0x3210,
        Fault::OverCurrent => 0x2310,
        Fault::OverTemperature => 0x4310,
        Fault::Overspeed => 0x8400,
        Fault::OutsideTravel => 0x8612,
        Fault::NotCalibrated => 0x7122,
        Fault::EmergencyStop => 0x9000,
        Fault::InvalidCommand => 0x6320,
    }
}

/// Bits of the error register for an error code: generic, and one for the code's group.
pub const fn register(code: u16) -> u8 {
    match code >> 8 {
        0 => 0,
        0x20..=0x2F => 0x03,
        0x30..=0x3F => 0x05,
        0x40..=0x4F => 0x09,
        0x81 | 0x82 => 0x11,
        0x73 | 0x71 | 0x83..=0x87 => 0x21,
        _ => 0x01,
    }
}

/// Errors kept.
const KEPT: usize = 4;

/// Errors since power-up, the latest first.
#[derive(Debug, Clone, Copy)]
pub(super) struct History {
    codes: [u16; KEPT],
    count: u8,
}

impl History {
    pub const EMPTY: Self = Self { codes: [0; KEPT], count: 0 };

    pub fn push(&mut self, code: u16) {
        self.codes.rotate_right(1);
        self.codes[0] = code;
        self.count = (self.count + 1).min(KEPT as u8);
    }

    pub fn count(&self) -> u8 {
        self.count
    }

    /// Error with a number from 1; `None` beyond the last.
    pub fn get(&self, number: u8) -> Option<u16> {
        let position = usize::from(number).checked_sub(1).filter(|position| *position < usize::from(self.count))?;
        self.codes.get(position).copied()
    }

    pub fn clear(&mut self) {
        *self = Self::EMPTY;
    }
}

//! Feedback frame: the answer to each control frame and to the request for feedback.
//!
//! | byte | contents |
//! |---|---|
//! | 0 | bits 7 to 4: status; bits 3 to 0: low bits of the drive's identifier |
//! | 1 to 5 | state of the MIT frame: position, velocity, torque |
//! | 6 | temperature of the power stage [deg C] |
//! | 7 | temperature of the winding [deg C] |

use super::mit::{Ranges, State};
use crate::drive::{Drive, Fault, State as DriveState};

/// Status of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// No torque.
    Disabled,
    /// Control by commands.
    Enabled,
    /// Motor not calibrated.
    NotCalibrated,
    /// Readings of the motor encoder are missing.
    MotorEncoder,
    /// Readings of the output encoder are missing.
    OutputEncoder,
    /// Bus voltage too high.
    OverVoltage,
    /// Bus voltage too low.
    UnderVoltage,
    /// Current too high.
    OverCurrent,
    /// Power stage too hot.
    BoardOverTemperature,
    /// Winding too hot.
    MotorOverTemperature,
    /// No command arrived in time.
    CommunicationLost,
    /// Overload; also any fault without a code of its own.
    Overload,
    /// Code without a meaning in the documents.
    Unknown(u8),
}

impl Status {
    /// Status values with their codes.
    pub const CODES: [(u8, Self); 12] = [
        (0x0, Self::Disabled),
        (0x1, Self::Enabled),
        (0x2, Self::NotCalibrated),
        (0x5, Self::MotorEncoder),
        (0x7, Self::OutputEncoder),
        (0x8, Self::OverVoltage),
        (0x9, Self::UnderVoltage),
        (0xA, Self::OverCurrent),
        (0xB, Self::BoardOverTemperature),
        (0xC, Self::MotorOverTemperature),
        (0xD, Self::CommunicationLost),
        (0xE, Self::Overload),
    ];

    /// Status of a code.
    pub fn from_code(code: u8) -> Self {
        let known = Self::CODES.into_iter().find(|(known, _)| *known == code);
        known.map_or(Self::Unknown(code), |(_, status)| status)
    }

    /// Code of 4 bits.
    pub fn code(self) -> u8 {
        match self {
            Self::Unknown(code) => code & 0x0F,
            known => Self::CODES.into_iter().find(|(_, status)| *status == known).map_or(0, |(code, _)| code),
        }
    }

    /// Status of a drive; `hottest` is that of a temperature fault.
    pub(super) fn of(drive: &Drive, hottest: Self) -> Self {
        match drive.fault() {
            None if drive.state() == DriveState::Enabled => Self::Enabled,
            None => Self::Disabled,
            Some(Fault::Watchdog) => Self::CommunicationLost,
            Some(Fault::NotCalibrated) => Self::NotCalibrated,
            Some(Fault::MotorEncoder) => Self::MotorEncoder,
            Some(Fault::OutputEncoder) => Self::OutputEncoder,
            Some(Fault::UnderVoltage) => Self::UnderVoltage,
            Some(Fault::OverVoltage) => Self::OverVoltage,
            Some(Fault::OverCurrent) => Self::OverCurrent,
            Some(Fault::OverTemperature) => hottest,
            Some(_) => Self::Overload,
        }
    }
}

/// Feedback frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feedback {
    /// Low four bits of the drive's identifier.
    pub id: u8,
    /// Status.
    pub status: Status,
    /// Position, velocity and torque.
    pub state: State,
    /// Temperature of the power stage [deg C].
    pub board_temperature: u8,
    /// Temperature of the winding [deg C].
    pub motor_temperature: u8,
}

impl Feedback {
    /// Feedback of a drive.
    pub(super) fn of(drive: &Drive, id: u16, hottest: Status) -> Self {
        let now = drive.feedback();
        Self {
            id: id as u8 & 0x0F,
            status: Status::of(drive, hottest),
            state: State { position: now.position.to_rad(), velocity: now.velocity, torque: now.torque },
            // The casts keep to the range of a byte.
            board_temperature: now.sensors.board_temperature as u8,
            motor_temperature: now.sensors.motor_temperature as u8,
        }
    }

    /// Data of the frame.
    pub fn encode(&self, ranges: &Ranges) -> [u8; 8] {
        let [a, b, c, d, e] = self.state.encode(ranges);
        let head = self.status.code() << 4 | self.id & 0x0F;
        [head, a, b, c, d, e, self.board_temperature, self.motor_temperature]
    }

    /// Feedback of a frame's data.
    pub fn decode([head, a, b, c, d, e, board, motor]: [u8; 8], ranges: &Ranges) -> Self {
        Self {
            id: head & 0x0F,
            status: Status::from_code(head >> 4),
            state: State::decode([a, b, c, d, e], ranges),
            board_temperature: board,
            motor_temperature: motor,
        }
    }
}

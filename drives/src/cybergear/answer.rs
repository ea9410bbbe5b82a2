//! Frames from a drive, in both directions.

use super::faults::Flags;
use super::model::Model;
use super::request::indexed;
use super::wire::{BROADCAST, Header, join, kind, split};
use crate::frame::Frame;

/// State of a drive as its feedback tells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// No torque.
    Reset,
    /// Calibration.
    Calibration,
    /// Control by the run mode.
    Run,
}

/// Feedback of a drive at the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feedback {
    /// State.
    pub mode: Mode,
    /// Faults.
    pub flags: Flags,
    /// Angle [rad].
    pub angle: f32,
    /// Speed [rad/s].
    pub speed: f32,
    /// Torque [N m].
    pub torque: f32,
    /// Temperature of the winding [deg C].
    pub temperature: f32,
}

/// Answer of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// Address and unique identifier.
    Device {
        /// Address of the drive.
        drive: u8,
        /// Unique identifier of the controller.
        unique_id: [u8; 8],
    },
    /// Feedback, in answer to a command.
    Feedback {
        /// Address of the drive.
        drive: u8,
        /// Address of the host.
        host: u8,
        /// Feedback.
        feedback: Feedback,
    },
    /// Feedback, without a command.
    Report {
        /// Address of the drive.
        drive: u8,
        /// Address of the host.
        host: u8,
        /// Feedback.
        feedback: Feedback,
    },
    /// Value of a parameter.
    Parameter {
        /// Address of the drive.
        drive: u8,
        /// Address of the host.
        host: u8,
        /// Index of the parameter.
        index: u16,
        /// Value; `None` if the drive could not read it.
        value: Option<[u8; 4]>,
    },
    /// Faults and warnings.
    Fault {
        /// Address of the drive.
        drive: u8,
        /// Address of the host.
        host: u8,
        /// Faults.
        faults: u32,
        /// Warnings.
        warnings: u32,
    },
    /// Result of a calibration.
    Calibrated {
        /// Address of the drive.
        drive: u8,
        /// Address of the host.
        host: u8,
        /// Electrical offset of the encoder [rad].
        offset: f32,
    },
}

impl Answer {
    /// Frame of a model.
    pub fn encode(&self, model: Model) -> Option<Frame> {
        let frame = |kind: u8, high: u8, low: u8, target: u8, bytes: [u8; 8]| {
            Header { kind, data: u16::from(high) << 8 | u16::from(low), target }.frame(&bytes)
        };
        match *self {
            Self::Device { drive, unique_id } => frame(kind::IDENTIFY, 0, drive, BROADCAST, unique_id),
            Self::Feedback { drive, host, feedback } => {
                frame(kind::FEEDBACK, feedback.state(), drive, host, feedback.encode(model))
            }
            Self::Report { drive, host, feedback } => {
                frame(kind::REPORT, feedback.state(), drive, host, feedback.encode(model))
            }
            Self::Parameter { drive, host, index, value } => {
                let bytes = indexed(index, value.unwrap_or_default());
                frame(kind::READ, value.is_none().into(), drive, host, bytes)
            }
            Self::Fault { drive, host, faults, warnings } => {
                let (low, target) = if model.is_robstride() { (drive, host) } else { (host, drive) };
                let [a, b, c, d] = faults.to_le_bytes();
                let [e, f, g, h] = warnings.to_le_bytes();
                frame(kind::FAULT, 0, low, target, [a, b, c, d, e, f, g, h])
            }
            Self::Calibrated { drive, host, offset } => {
                let [a, b, c, d] = offset.to_le_bytes();
                frame(kind::CALIBRATE, 0, drive, host, [a, b, c, d, 0, 0, 0, 0])
            }
        }
    }

    /// Answer in a frame; `None` for all other frames.
    pub fn decode(model: Model, frame: &Frame) -> Option<Self> {
        let header = Header::read(frame)?;
        let [high, drive] = header.data.to_be_bytes();
        let (host, bytes) = (header.target, frame.bytes::<8>()?);
        let [a, b, c, d, value @ ..] = bytes;
        Some(match header.kind {
            kind::IDENTIFY if host == BROADCAST => Self::Device { drive, unique_id: bytes },
            kind::FEEDBACK => Self::Feedback { drive, host, feedback: Feedback::decode(model, high, bytes)? },
            kind::REPORT if model.is_robstride() => {
                Self::Report { drive, host, feedback: Feedback::decode(model, high, bytes)? }
            }
            kind::READ => {
                let value = (high == 0).then_some(value);
                Self::Parameter { drive, host, index: u16::from_le_bytes([a, b]), value }
            }
            kind::FAULT => {
                let (drive, host) = if model.is_robstride() { (drive, host) } else { (host, drive) };
                let (faults, warnings) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes(value));
                Self::Fault { drive, host, faults, warnings }
            }
            kind::CALIBRATE => Self::Calibrated { drive, host, offset: f32::from_le_bytes([a, b, c, d]) },
            _ => return None,
        })
    }
}

impl Feedback {
    /// Bits 23 to 16 of the identifier.
    fn state(&self) -> u8 {
        let mode = match self.mode {
            Mode::Reset => 0,
            Mode::Calibration => 1,
            Mode::Run => 2,
        };
        mode << 6 | self.flags.0
    }

    fn encode(&self, model: Model) -> [u8; 8] {
        let sheet = model.sheet();
        let temperature = (10.0 * self.temperature + 0.5) as u16;
        join([
            sheet.angle.encode(self.angle),
            sheet.speed.encode(self.speed),
            sheet.torque.encode(self.torque),
            temperature,
        ])
    }

    fn decode(model: Model, state: u8, bytes: [u8; 8]) -> Option<Self> {
        let (sheet, [angle, speed, torque, temperature]) = (model.sheet(), split(bytes));
        let mode = match state >> 6 {
            0 => Mode::Reset,
            1 => Mode::Calibration,
            2 => Mode::Run,
            _ => return None,
        };
        Some(Self {
            mode,
            flags: Flags(state & Flags::ALL),
            angle: sheet.angle.decode(angle),
            speed: sheet.speed.decode(speed),
            torque: sheet.torque.decode(torque),
            temperature: f32::from(temperature) / 10.0,
        })
    }
}

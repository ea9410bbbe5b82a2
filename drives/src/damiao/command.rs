//! Control frames: orders to the drive's state, and a command of motion for each control mode.

use super::mit::{self, Ranges};
use crate::scale;

/// Distance of the control modes' identifiers.
const MODE_STEP: u16 = 0x100;
/// Unit of the velocity in a force-position command [rad/s].
const VELOCITY_UNIT: f32 = 0.01;
/// Unit of the torque in a force-position command, as a share of the largest [-].
const SHARE_UNIT: f32 = 1e-4;
/// Largest number in the two fields of a force-position command.
const MOST: f32 = 10_000.0;

/// Control mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// MIT frame.
    Impedance,
    /// Position by a profile.
    PositionVelocity,
    /// Velocity.
    Velocity,
    /// Position by a profile under a torque limit.
    ForcePosition,
}

impl Mode {
    /// Modes in the order of their codes, from 1 on.
    pub const ALL: [Self; 4] = [Self::Impedance, Self::PositionVelocity, Self::Velocity, Self::ForcePosition];

    /// Mode of a code in the register CTRL_MODE.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.code() == code)
    }

    /// Code in the register CTRL_MODE.
    pub fn code(self) -> u32 {
        match self {
            Self::Impedance => 1,
            Self::PositionVelocity => 2,
            Self::Velocity => 3,
            Self::ForcePosition => 4,
        }
    }

    /// Distance of the frames' identifier to that of the drive.
    pub fn offset(self) -> u16 {
        (self.code() as u16 - 1) * MODE_STEP
    }
}

/// Order to the drive's state: seven bytes 0xFF and a code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Enables the drive.
    Enable,
    /// Disables the drive.
    Disable,
    /// Makes the present position the origin.
    SetZero,
    /// Clears a fault.
    ClearError,
}

impl Order {
    /// All orders.
    pub const ALL: [Self; 4] = [Self::Enable, Self::Disable, Self::SetZero, Self::ClearError];

    /// Data of the frame.
    pub fn encode(self) -> [u8; 8] {
        let code = match self {
            Self::ClearError => 0xFB,
            Self::Enable => 0xFC,
            Self::Disable => 0xFD,
            Self::SetZero => 0xFE,
        };
        [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, code]
    }

    /// Order of a frame's data.
    pub fn decode(data: &[u8]) -> Option<Self> {
        Self::ALL.into_iter().find(|order| order.encode() == data)
    }
}

/// Command of motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// MIT frame.
    Impedance(mit::Command),
    /// Position by a profile.
    PositionVelocity {
        /// Position [rad].
        position: f32,
        /// Largest velocity [rad/s].
        max_velocity: f32,
    },
    /// Velocity [rad/s].
    Velocity(f32),
    /// Position by a profile under a torque limit.
    ForcePosition {
        /// Position [rad].
        position: f32,
        /// Largest velocity [rad/s], at most 100.
        max_velocity: f32,
        /// Largest torque as a share of the drive's [-], at most 1.
        torque_share: f32,
    },
}

impl Motion {
    /// Command with all values at zero, as a drive has it after it was enabled or changed its mode.
    pub fn zero(mode: Mode) -> Self {
        match mode {
            Mode::Impedance => Self::Impedance(mit::Command::default()),
            Mode::PositionVelocity => Self::PositionVelocity { position: 0.0, max_velocity: 0.0 },
            Mode::Velocity => Self::Velocity(0.0),
            Mode::ForcePosition => Self::ForcePosition { position: 0.0, max_velocity: 0.0, torque_share: 0.0 },
        }
    }

    /// Mode of the command.
    pub fn mode(&self) -> Mode {
        match self {
            Self::Impedance(_) => Mode::Impedance,
            Self::PositionVelocity { .. } => Mode::PositionVelocity,
            Self::Velocity(_) => Mode::Velocity,
            Self::ForcePosition { .. } => Mode::ForcePosition,
        }
    }

    /// Data of the frame.
    pub fn encode(&self, ranges: &Ranges) -> [u8; 8] {
        match *self {
            Self::Impedance(command) => command.encode(ranges),
            Self::PositionVelocity { position, max_velocity } => joined(position, max_velocity.to_le_bytes()),
            Self::Velocity(velocity) => joined(velocity, [0; 4]),
            Self::ForcePosition { position, max_velocity, torque_share } => {
                let ([a, b], [c, d]) = (counted(max_velocity, VELOCITY_UNIT), counted(torque_share, SHARE_UNIT));
                joined(position, [a, b, c, d])
            }
        }
    }

    /// Command of a frame's data; `None` for a frame that is too short, and for numbers that are not finite.
    pub fn decode(mode: Mode, data: &[u8], ranges: &Ranges) -> Option<Self> {
        let first = f32::from_le_bytes(*data.first_chunk()?);
        if mode == Mode::Velocity {
            return first.is_finite().then_some(Self::Velocity(first));
        }
        let bytes: [u8; 8] = *data.first_chunk()?;
        let [_, _, _, _, a, b, c, d] = bytes;
        let second = f32::from_le_bytes([a, b, c, d]);
        match mode {
            Mode::Impedance => Some(Self::Impedance(mit::Command::decode(bytes, ranges))),
            Mode::PositionVelocity => (first.is_finite() && second.is_finite())
                .then_some(Self::PositionVelocity { position: first, max_velocity: second }),
            Mode::Velocity | Mode::ForcePosition => first.is_finite().then_some(Self::ForcePosition {
                position: first,
                max_velocity: measured([a, b], VELOCITY_UNIT),
                torque_share: measured([c, d], SHARE_UNIT),
            }),
        }
    }
}

/// Float and four bytes.
fn joined(first: f32, [e, f, g, h]: [u8; 4]) -> [u8; 8] {
    let [a, b, c, d] = first.to_le_bytes();
    [a, b, c, d, e, f, g, h]
}

/// Whole number of units; at most 10 000.
fn counted(value: f32, unit: f32) -> [u8; 2] {
    (scale::round(value / unit).clamp(0.0, MOST) as u16).to_le_bytes()
}

/// Value of a whole number of units; numbers above 10 000 count as 10 000.
fn measured(bytes: [u8; 2], unit: f32) -> f32 {
    f32::from(u16::from_le_bytes(bytes)).min(MOST) * unit
}

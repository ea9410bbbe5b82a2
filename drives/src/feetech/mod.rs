//! Feetech STS servos on a half-duplex serial bus, as the STS3215.
//!
//! Documents: Feetech, "SCS communication protocol" (sections on instruction packet, status packet and instructions)
//! and "Magnetic encoder STS servo, memory table" (sections 2.1 to 2.5 on the registers, 3.1 to 3.3 on phase, status
//! and unloading condition; defaults of the STS3215 by the edition 220328), both as quoted in public repositories.
//!
//! # Bus
//!
//! 1 Mbit/s, 8 data bits, no parity, 1 stop bit. A client sends an instruction, the servo answers with a status.
//!
//! | byte | instruction | status |
//! |---|---|---|
//! | 0, 1 | FF FF | FF FF |
//! | 2 | identifier 0 to 253, or FE for all | identifier |
//! | 3 | number of parameters + 2 | number of parameters + 2 |
//! | 4 | [`Instruction`] | [`error`] bits |
//! | 5 ... | parameters | bytes that were read |
//! | last | checksum | checksum |
//!
//! Values of several bytes are little endian. Signed registers hold a magnitude and a sign bit: bit 15 for positions,
//! speeds and the current, bit 10 for load and duty, bit 11 for the offset.
//!
//! # Registers
//!
//! [`table`] lists them. Units: position 1/4096 turn of the output; speed 1 step/s, or 50 steps/s by a bit of the phase;
//! acceleration 100 steps/s^2; load, duty and torque 0.1 % or 1 % of the stall torque; voltage 0.1 V; current 6.5 mA.
//! Positions, speeds, loads and currents are positive in the direction of a positive turn of the output.
//!
//! Addresses 5 to 39 and 80 to 86 survive a power cycle if they are written while the lock (address 55) is 0; written
//! under the lock they act until the power cycle. A value out of range becomes the end of the range. Addresses without a
//! register read as 0.
//!
//! # Encoders
//!
//! An STS servo has one encoder, at the output: address 56 is the output encoder. The angle of the rotor stands in a
//! block behind the maker's last address, which is an extension of this implementation:
//!
//! | address | bytes | content |
//! |---|---|---|
//! | 96 | 4 | angle of the rotor since power-up [counts], two's complement |
//! | 100 | 4 | counts of the motor encoder in a turn |
//! | 104 | 4 | speed of the rotor [counts/s], two's complement |
//! | 108, 110 | 2, 2 | numerator and denominator of the turns of the rotor in a turn of the output |
//!
//! # Behaviour
//!
//! - Torque: the torque switch (address 40), and a goal in the register of the mode, which switches the torque on as in
//!   the maker's examples. Switched on without a goal, the servo holds its position. Off, it turns freely.
//! - Position mode: the goal is clipped to the angle limits and lies in the turn in which the torque was switched on. If
//!   both limits are 0, the goal counts all turns.
//! - Step mode: each write of the goal moves the target by that number of steps.
//! - Errors: the bits of [`error`] are in every status. Those of the unloading condition (address 19) take the torque
//!   off; the overload reduces it to the protection torque (address 34). They stay until the torque switch is written,
//!   or a reboot.
//! - There is no watchdog: the last goal stays in force however long the bus is silent.
//! - Order on the bus: after a synchronous read each servo counts the answers of the servos before it, so it has to
//!   receive the bytes of the other servos, and not its own. A byte of the client has to reach all servos before the
//!   answer to it. Answers to a broadcast ping follow each other in the order of the identifiers, 3 ms for each.
//!
//! # Known limits
//!
//! - The position loop acts on the angle of the output by the motor encoder, not on the output encoder as in the real
//!   servo: at rest address 56 may be off the goal by half the gap and the twist of the gear, and the loop does not
//!   hunt through the gap as a real servo may.
//! - Gains are relative: the factory values of P and D (32) and of the speed loop (10) stand for the gains in the
//!   settings. An I of 32 gives an integral gain of the stiffness times 1/s.
//! - Mode 2 commands torque in proportion to the duty, up to the speed in proportion to it.
//! - Without effect: least starting duty, resolution factor, light, the bits of the phase that reverse direction.
//! - A lost encoder takes the torque off whatever the unloading condition: the drive cannot be controlled without it.
//! - Choices where the documents are silent: when an error is cleared, the order of the answers to a broadcast ping, the
//!   silence that replaces a missing answer, and registers out of range.
//! - The protection current is 1.2 times the stall current of the drive, at least the maker's 3.25 A, at most the
//!   13.3 A that its register can hold.

pub mod client;
mod memory;
mod packet;
mod protection;
mod queue;
mod server;
mod servo;
pub mod table;
#[cfg(test)]
mod tests;

pub use packet::{BROADCAST, Bytes, Instruction, MAX_BYTES, MAX_PARAMETERS, Packet, Receiver};
pub use server::Server;

use crate::drive::{Expiry, Law, Settings};
use core::f32::consts::TAU;

/// Voltage of the supply that fits the default limits [V].
pub const SUPPLY_VOLTAGE: f32 = 12.0;

/// Largest speed of the output [rad/s]: 3400 steps/s.
const MAX_VELOCITY: f32 = 3400.0 * TAU / table::STEPS as f32;

/// Error bits of a status.
pub mod error {
    /// Voltage out of its limits.
    pub const VOLTAGE: u8 = 1;
    /// Encoder without a reading.
    pub const ENCODER: u8 = 2;
    /// Temperature above its limit.
    pub const TEMPERATURE: u8 = 4;
    /// Current above its limit for too long.
    pub const CURRENT: u8 = 8;
    /// Load above its limit for too long.
    pub const OVERLOAD: u8 = 32;
}

/// Bits of the phase register.
pub mod phase {
    /// Unit of speed: 1 step/s if set, 50 steps/s otherwise.
    pub const FINE_SPEED: u8 = 4;
    /// Speed 0 of a move: the largest speed if set, standstill otherwise.
    pub const ZERO_IS_FASTEST: u8 = 8;
    /// Positions count all turns if set, one turn otherwise.
    pub const ALL_TURNS: u8 = 16;

    /// Unit of the registers of speed [steps/s].
    pub fn speed_unit(phase: u8) -> f32 {
        if phase & FINE_SPEED != 0 { 1.0 } else { 50.0 }
    }
}

/// Mode of a servo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Position within a turn, or over all turns.
    Position,
    /// Speed.
    Speed,
    /// Duty, without a loop.
    Duty,
    /// Position relative to the last one.
    Step,
}

impl Mode {
    /// Mode of a value of the register; numbers that are no mode give the position.
    pub fn decode(value: i32) -> Self {
        match value {
            1 => Self::Speed,
            2 => Self::Duty,
            3 => Self::Step,
            _ => Self::Position,
        }
    }
}

/// Settings with the maker's defaults: parallel law, limits of a 12 V servo, no watchdog, no limits that are a fault
/// which the protocol cannot report.
pub fn settings(settings: Settings) -> Settings {
    Settings {
        max_velocity: settings.max_velocity.min(MAX_VELOCITY),
        overspeed: f32::INFINITY,
        travel: (None, None),
        min_voltage: table::MIN_VOLTAGE.quantity_of(table::MIN_VOLTAGE.default),
        max_voltage: table::MAX_VOLTAGE.quantity_of(table::MAX_VOLTAGE.default),
        derating_temperature: f32::INFINITY,
        max_temperature: table::MAX_TEMPERATURE.quantity_of(table::MAX_TEMPERATURE.default),
        law: Law::Parallel,
        watchdog: None,
        expiry: Expiry::Disable,
        is_calibrated: true,
        ..settings
    }
}

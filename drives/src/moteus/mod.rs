//! moteus on CAN FD: registers that are read and written by subframes.
//!
//! Bus: CAN FD, 1 Mbit/s and 5 Mbit/s for the data, at most 64 bytes; lengths that CAN FD does not have are filled with
//! 0x50. A classical frame is understood as well and answered by one, if the answer has room in it.
//!
//! | bits of the identifier | content |
//! |---|---|
//! | 0 to 7 | receiver, 7 bits; 0x7f is every drive |
//! | 8 to 14 | sender |
//! | 15 | 1 asks for a reply |
//! | 16 to 28 | prefix |
//!
//! The identifier has 29 bits where 11 do not suffice. A frame holds subframes, each of a code, variable-length numbers
//! of seven bits a byte, and values with the least significant byte first:
//!
//! | code | subframe | content |
//! |---|---|---|
//! | 0x00 | write | number of registers, first register, values |
//! | 0x10 | read | number of registers, first register |
//! | 0x20 | reply to a read | number of registers, first register, values |
//! | 0x30, 0x31 | write error, read error | register, error: 1 unknown, 2 not writable |
//! | 0x40, 0x41 | bytes to the drive's diagnostic channel, bytes from it | channel, length, bytes |
//! | 0x42 | request for bytes of the diagnostic channel | channel, most bytes |
//! | 0x50 | no operation | |
//!
//! Codes below 0x30 hold the resolution in bits 2 and 3 (int8, int16, int32, float) and, if it is not zero, the number
//! of registers in bits 0 and 1.
//!
//! Units: turns of the output, turns/s, turns/s^2, N m at the output, A, V, s, W, deg C. Integers count multiples of a
//! unit that depends on quantity and resolution ([`value::Scale`]); the most negative integer is NaN. A positive torque
//! accelerates a positive turn. The torques of the loop, registers 0x030 to 0x032, have the sign of the error: sensed
//! minus commanded.
//!
//! Encoders: encoder 0 at the motor, registers 0x050 and 0x051 in turns of the rotor; encoder 1 at the output,
//! registers 0x052 and 0x053, and 0x006. Encoder 0 controls the position; encoder 1 sets the turn at power-up, so that
//! the position begins within half a turn of zero.
//!
//! State: a command (mode, then its registers) acts once its frame is read; the answers of a frame show the state
//! before it. A position or stay-within command that is not renewed within its timeout, 0.1 s by default, puts the
//! drive into mode 11, which damps. Modes 1 and 11 end by the command to stop only.
//!
//! Bounds: the server takes the travel out of the drive's settings. A target is held within these position bounds, and
//! only a start outside of them is a fault.
//!
//! Documents: moteus documentation, "CAN Protocol", "Register Reference" and "Configuration" (repository mjbots/moteus,
//! revision db1a762, register map 5). Where the document is silent, firmware 1.1.0 of that revision decides: error
//! codes, order of answers, faults of a stopped drive.
//!
//! Limits of this implementation:
//!
//! - Modes 5 to 8 and 14, which set voltages or measure the inductance, have the write error 1. The fixed voltage and
//!   current of the position mode are kept without an effect, as are outputs of the auxiliary ports and the clock trim.
//! - The diagnostic channel, channel 1, knows `conf get` and `conf set` for gains, limits, bounds, timeout and
//!   identifier (file `diagnostic.rs`); it has no telemetry, and `conf write` keeps nothing.
//! - `servo.timeout_mode` is 12 with [`crate::drive::Expiry::Damp`] and 0 with [`crate::drive::Expiry::Disable`].
//! - The drive is enabled without the current calibration of modes 2 to 4.
//! - Of the limit codes 96 to 105 there are 99, 101 and 102.
//! - Driver faults are always 0.

mod channel;
pub mod client;
pub mod command;
mod decimal;
mod diagnostic;
mod read;
pub mod register;
mod server;
pub mod subframe;
#[cfg(test)]
mod tests;
pub mod value;

pub use client::Client;
pub use command::Mode;
pub use server::{Server, settings};

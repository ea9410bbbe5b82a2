//! Damiao drives: impedance commands in the MIT frame, three further control modes, and registers. Classical CAN with
//! 11-bit identifiers at 1 Mbit/s by default; the drive speaks only when it is asked.
//!
//! | identifier | data | meaning |
//! |---|---|---|
//! | id | [`mit::Command`] | mode 1: impedance command |
//! | 0x100 + id | position f32 [rad], largest velocity f32 [rad/s] | mode 2: position by a profile |
//! | 0x200 + id | velocity f32 [rad/s], 4 bytes of padding or none | mode 3: velocity |
//! | 0x300 + id | position f32 [rad], velocity u16 [0.01 rad/s], torque u16 [1e-4] | mode 4: limited torque |
//! | id, or the mode's | 7 bytes 0xFF, then the code of an [`Order`] | enable, disable, set zero, clear error |
//! | 0x7FF | [`Parameter`] | read, write or store registers, request feedback |
//! | feedback id | [`Feedback`], or [`Parameter`] | answer |
//!
//! Floats and the fields of mode 4 stand low byte first, the MIT frame high byte first.
//!
//! Positions, velocities and torques are those of the output; a positive torque accelerates a positive turn. Register
//! p_m and the feedback hold the position by the motor encoder and the ratio, register xout the position by the output
//! encoder, both [rad] from the origin that the order to set zero gave. At power-up both begin at the output encoder's
//! reading.
//!
//! States: disabled at power-up, with a shorted winding; enabled by order. A fault disables the drive until the order
//! to clear it; afterwards the drive has to be enabled again. Enabling and a change of the mode set all commands to
//! zero. Each frame to the drive feeds the watchdog.
//!
//! | status | meaning | status | meaning |
//! |---|---|---|---|
//! | 0 | disabled | 9 | bus voltage too low |
//! | 1 | enabled | A | current too high |
//! | 2 | not calibrated | B | power stage too hot |
//! | 5 | motor encoder silent | C | winding too hot |
//! | 7 | output encoder silent | D | communication lost |
//! | 8 | bus voltage too high | E | overload, and any fault without a code: overspeed, end of travel |
//!
//! Documents: Damiao DM-H3510 user manual V1.0 (2025-01-02), sections on feedback, control frames, parameters and the
//! list of registers; DM-J4310-2EC V1.1 user manual V1.0, sections on working modes and protections. Status 2, 5 and 7
//! are not in these manuals; they come from a user's list of status values of the DM4310. Clients read: damiao-motor
//! 1.0.6, LeRobot's Damiao bus.
//!
//! Known limits:
//!
//! - A frame that the documents give no answer to has none: another control mode, an unknown register, a value out of
//!   range, an order to store while enabled.
//! - An impedance command whose bytes are those of an order is the order.
//! - The documents give no unit for KP_ASR and KI_ASR. Here they give a share of the largest current for the rotor's
//!   speed [s/rad] and for the integral of the speed [1/rad].
//! - KT_Value, I_BW, KI_APR, GREF, Deta, V_BW, IQ_c1 and VL_c1 are kept without an effect. Damp, Inertia, Ls, versions
//!   and calibration factors are constants.
//! - OT_Value limits winding and power stage alike; the maker's power stage has a fixed limit of 120 deg C.
//! - The smaller of ACC and -DEC limits both acceleration and deceleration.
//! - Storing is confirmed, but nothing outlasts the [`Server`].
//! - A new bit rate is only told to the host by [`Server::bit_rate`]. CAN FD is not supported.

mod access;
mod client;
mod command;
mod feedback;
mod kept;
pub mod mit;
mod motor_type;
mod parameter;
mod register;
mod server;

pub use access::TIMEOUT_UNIT;
pub use client::{Answer, Client};
pub use command::{Mode, Motion, Order};
pub use feedback::{Feedback, Status};
pub use motor_type::{MOTOR_TYPES, ranges};
pub use parameter::{ID as PARAMETER_ID, Parameter, Purpose};
pub use register::{Form, Register, Value};
pub use server::{Server, settings};

#[cfg(test)]
mod tests;

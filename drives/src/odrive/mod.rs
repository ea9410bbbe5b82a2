//! ODrive with its protocol CANSimple on classical CAN, firmware lines 0.5 (ODrive v3) and 0.6 (Pro, S1, Micro).
//!
//! Identifier of 11 bits: node, 6 bits, and command, 5 bits. All fields are little endian. A remote frame, or a frame
//! without data, requests a report.
//!
//! | command | to the drive | from the drive | bytes |
//! |---|---|---|---|
//! | 0x00 | | 0.6: versions | 8 x u8 |
//! | 0x01 | | heartbeat | error u32, state u8; 0.5: flags 3 x u8; 0.6: result u8, trajectory done u8 |
//! | 0x02 | emergency stop | | |
//! | 0x03 | | 0.5: motor error; 0.6: active errors, disarm reason | u64; 2 x u32 |
//! | 0x04 | 0.6: access to a parameter | 0.5: encoder error | operation u8, endpoint u16, u8, value; u32 |
//! | 0x05 | | 0.5: sensorless error; 0.6: parameter | u32; u8, endpoint u16, u8, value |
//! | 0x06 | 0.5: node; 0.6: address | 0.6: address | u32; node u8, serial number u48, u8 |
//! | 0x07 | requested state | | u32 |
//! | 0x09 | | angle [turns], speed [turns/s] | 2 x f32 |
//! | 0x0a | | 0.5: counts with all turns, within a turn | 2 x i32 |
//! | 0x0b | control mode, input mode | | 2 x u32 |
//! | 0x0c | input angle [turns], speed [0.001 turns/s], torque [0.001 N m] | | f32, 2 x i16 |
//! | 0x0d | input speed [turns/s], torque [N m] | | 2 x f32 |
//! | 0x0e | input torque [N m] | | f32 |
//! | 0x0f | limits of speed [turns/s] and current [A] | | 2 x f32 |
//! | 0x10 | 0.5: cogging calibration, no effect | | |
//! | 0x11 | trajectory's speed [turns/s] | | f32 |
//! | 0x12 | trajectory's acceleration, deceleration [turns/s^2] | | 2 x f32 |
//! | 0x13 | inertia [N m/(turns/s^2)] | | f32 |
//! | 0x14 | | commanded, measured current [A] | 2 x f32 |
//! | 0x15 | | 0.5: sensorless estimates, zero; 0.6: temperatures of inverter, motor [deg C] | 2 x f32 |
//! | 0x16 | reboot | | 0.6: action u8 |
//! | 0x17 | | bus voltage [V], current [A] | 2 x f32 |
//! | 0x18 | clear errors | | 0.6: identify u8 |
//! | 0x19 | 0.5: count to be set; 0.6: angle to be set [turns] | | i32; f32 |
//! | 0x1a | position gain [1/s] | | f32 |
//! | 0x1b | speed gain [N m/(turns/s)], integral gain [N m/turn] | | 2 x f32 |
//! | 0x1c | 0.5: pin | 0.5: its voltage, zero; 0.6: commanded, estimated torque [N m] | u8; f32; 2 x f32 |
//! | 0x1d | | 0.5: controller error; 0.6: electrical, mechanical power [W] | u32; 2 x f32 |
//! | 0x1f | 0.6: boot loader, no effect | | |
//!
//! Cyclic messages: heartbeat each 100 ms and angle and speed each 10 ms; the others are off. The periods are set by
//! [`Server::set_rate`], with firmware 0.6 also by parameters.
//!
//! # Units and signs
//!
//! All quantities are those of the motor: turns, turns/s and N m of the rotor. The ratio of the drive's settings leads
//! to the output; a positive turn of the motor turns the output in the positive direction. The angle is the drive's
//! output angle times the ratio, so that an output encoder gives the turn of the output at power-up, as homing does
//! with the maker's drive.
//!
//! # Both encoders
//!
//! The loops use the motor encoder.
//!
//! - Firmware 0.5: angle and speed (0x09) and counts (0x0a) are those of the motor encoder. The board has two axes, each
//!   a node of its own. The output encoder is wired to the second axis, whose 0x09 and 0x0a are output turns and counts
//!   of the output encoder; [`Server::output_node`], at first the next node. The second axis has no motor: it stays in
//!   IDLE, and other states are INVALID_STATE.
//! - Firmware 0.6: 0x09, `pos_vel_mapper` and `commutation_mapper` are the motor encoder's, since `load_encoder` and
//!   `commutation_encoder` are both the one on the board; `onboard_encoder0.raw` is its reading within a turn. The output
//!   encoder's reading within a turn is `spi_encoder0.raw` [turns of the output].
//!
//! # Control
//!
//! As the maker's controller: v = v_input + k_p (p_input - p), limited; torque = k_v (v - speed) + k_vi integral +
//! torque input; input modes passthrough, velocity ramp, torque
//! ramp, position filter and trapezoidal trajectory. Gains and limits act on the drive's
//! settings. Torque control is limited by k_v (v_max - speed). Speed above the limit times the tolerance is an error.
//!
//! # Watchdog
//!
//! Each frame to the axis feeds it. With firmware 0.5 it expires in each state, with 0.6 in closed loop control. It is
//! off by default; [`Settings::watchdog`] or, with firmware 0.6, parameters set it.
//!
//! # Documents
//!
//! - Repository odriverobotics/ODrive, branch master (firmware 0.5.6): page "CAN protocol", sections Messages and
//!   Cyclic Messages; tools/odrive-cansimple.dbc; Firmware/communication/can/can_simple.cpp,
//!   Firmware/MotorControl/controller.cpp and axis.cpp, tools/odrive/enums.py.
//! - ODrive documentation, CAN Protocol and Controller (firmware 0.6); odrive-cansimple-0.6.10.dbc as in the package
//!   odrive-can 2.1.0; repository odriverobotics/ODriveResources, examples/can_enumerate.py, can_param_access.py.
//!
//! # Known limits
//!
//! - Identifiers of 29 bits, circular set-points, anticogging, gain scheduling, autotuning, mirroring, homing, index
//!   search and hall sensors are missing: modes and states that need them are refused with the maker's error.
//! - Voltage control acts as torque control, as firmware 0.5 does with motors other than gimbals.
//! - The speed integral holds while the torque is limited; the maker's decays by 1 % in each period.
//! - A trajectory uses the smaller one of acceleration and deceleration for both.
//! - Numbers that are not finite are ignored, and so are limits below zero; the maker's drive takes them.
//! - A reboot keeps the configuration, as if it had been saved; erasing it reboots as well.
//! - Firmware 0.6: errors stay active until they are cleared. Versions and the numbers of endpoints are those of an S1
//!   with firmware 0.6.10, as far as public clients show them; a write of a parameter is not confirmed, as before 0.6.11.
//!   Each frame to the axis feeding the watchdog is known from 0.5 and assumed for 0.6.

mod axis;
pub mod client;
pub mod codes;
mod commands;
mod controller;
mod cyclic;
mod errors;
mod message;
mod output_axis;
pub mod parameters;
pub mod payload;
mod procedure;
mod server;
mod units;

pub use message::{Command, MAX_NODE, Report, identifier};
pub use server::{BROADCAST, Server};

use crate::drive::{Expiry, Law, Settings};

/// Speed over the limit that is an error, over the limit [-]; default of the maker.
const VELOCITY_TOLERANCE: f32 = 1.2;
/// Version of the protocol (firmware 0.6).
const PROTOCOL_VERSION: u8 = 2;
/// Product line, version and variant of an ODrive S1.
const HARDWARE_VERSION: [u8; 3] = [5, 2, 0];
/// Firmware of the newest DBC that was compared.
const FIRMWARE_VERSION: [u8; 3] = [0, 6, 10];

/// Firmware line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Firmware {
    /// ODrive v3, firmware 0.5.
    V0_5,
    /// ODrive Pro, S1, Micro, firmware 0.6.
    V0_6,
}

/// Settings with the maker's defaults: cascade, errors on overspeed, no watchdog, and no torque after an expiry. Gains
/// and limits stay those of the joint, as after commissioning.
pub fn settings(settings: Settings) -> Settings {
    Settings {
        law: Law::Cascade,
        overspeed: VELOCITY_TOLERANCE * settings.max_velocity,
        watchdog: None,
        expiry: Expiry::Disable,
        velocity_integral_limit: f32::INFINITY,
        ..settings
    }
}

#[cfg(test)]
mod tests;

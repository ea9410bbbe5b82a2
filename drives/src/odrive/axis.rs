//! Quantities of an axis as its reports carry them.

use core::f32::consts::TAU;

use super::Firmware;
use super::codes::axis_state;
use super::errors::AxisErrors;
use super::message::Report;
use super::payload::*;
use super::units::Units;
use super::{FIRMWARE_VERSION, HARDWARE_VERSION, PROTOCOL_VERSION};
use crate::drive::{Drive, Sensors};
use crate::scale;
use crate::turns::Turns;

/// Readings of an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Readings {
    pub state: u8,
    pub procedure_result: u8,
    pub is_trajectory_done: bool,
    pub errors: AxisErrors,
    /// Angle of the encoder.
    pub position: Turns,
    /// Speed of the encoder [turns/s].
    pub velocity: f32,
    pub counts_per_turn: u32,
    /// Reading of the encoder within a turn.
    pub raw: Turns,
    /// Commanded torque of the motor [N m].
    pub torque: f32,
    /// Commanded and measured current [A].
    pub currents: Currents,
    pub sensors: Sensors,
}

impl Readings {
    /// Readings of the axis with the motor.
    pub fn of_motor(drive: &Drive) -> Self {
        let (settings, feedback) = (drive.settings(), drive.feedback());
        let units = Units::new(settings.ratio);
        let torque = scale::limit(units.to_torque(feedback.demand), settings.torque_limit);
        let setpoint = settings.current(torque);
        Self {
            position: units.to_position(feedback.position),
            velocity: units.to_velocity(feedback.velocity),
            counts_per_turn: settings.motor_counts_per_turn,
            raw: feedback.motor_position,
            torque,
            currents: Currents { setpoint, measured: feedback.current },
            ..Self::idle(drive)
        }
    }

    /// Readings of the second axis of a board with firmware 0.5: the output encoder and no motor.
    pub fn of_output(drive: &Drive, offset: Turns) -> Self {
        let raw = drive.feedback().output_position.unwrap_or_default();
        Self {
            position: raw.plus(offset),
            velocity: drive.feedback().output_velocity / TAU,
            counts_per_turn: drive.settings().output_counts_per_turn.unwrap_or(0),
            raw,
            ..Self::idle(drive)
        }
    }

    fn idle(drive: &Drive) -> Self {
        Self {
            state: axis_state::IDLE,
            procedure_result: 0,
            is_trajectory_done: true,
            errors: AxisErrors::default(),
            position: Turns::ZERO,
            velocity: 0.0,
            counts_per_turn: 0,
            raw: Turns::ZERO,
            torque: 0.0,
            currents: Currents::default(),
            sensors: drive.feedback().sensors,
        }
    }

    /// Electrical and mechanical power [W].
    pub fn powers(&self) -> Powers {
        let Sensors { bus_voltage, bus_current, motor_torque, .. } = self.sensors;
        Powers { electrical: bus_voltage * bus_current, mechanical: motor_torque * self.velocity * TAU }
    }

    /// Report of a command's identifier; `None` without one.
    pub fn report(&self, firmware: Firmware, command: u8) -> Option<Report> {
        let errors = &self.errors;
        let sensors = &self.sensors;
        Some(match (firmware, command) {
            (Firmware::V0_5, 0x01) => Report::LegacyHeartbeat(self.legacy_heartbeat()),
            (Firmware::V0_5, 0x03) => Report::MotorError(MotorError { errors: errors.motor }),
            (Firmware::V0_5, 0x04) => Report::EncoderError(PartError { errors: errors.encoder }),
            (Firmware::V0_5, 0x05) => Report::SensorlessError(PartError { errors: 0 }),
            (Firmware::V0_5, 0x0a) => Report::EncoderCount(self.count()),
            (Firmware::V0_5, 0x15) => Report::SensorlessEstimates(Estimates::default()),
            (Firmware::V0_5, 0x1d) => Report::ControllerError(PartError { errors: errors.controller }),
            (Firmware::V0_6, 0x00) => Report::Version(Version {
                protocol: PROTOCOL_VERSION,
                hardware: HARDWARE_VERSION,
                firmware: FIRMWARE_VERSION,
                unreleased: 0,
            }),
            (Firmware::V0_6, 0x01) => Report::Heartbeat(Heartbeat {
                axis_error: errors.axis | errors.disarm_reason,
                state: self.state,
                procedure_result: self.procedure_result,
                trajectory_done: self.is_trajectory_done.into(),
            }),
            (Firmware::V0_6, 0x03) => {
                Report::Errors(Errors { active: errors.axis, disarm_reason: errors.disarm_reason })
            }
            (Firmware::V0_6, 0x15) => Report::Temperatures(Temperatures {
                inverter: sensors.board_temperature,
                motor: sensors.motor_temperature,
            }),
            (Firmware::V0_6, 0x1c) => Report::Torques(Torques { target: self.torque, estimate: sensors.motor_torque }),
            (Firmware::V0_6, 0x1d) => Report::Powers(self.powers()),
            (_, 0x09) => {
                Report::EncoderEstimates(Estimates { position: self.position.to_f32(), velocity: self.velocity })
            }
            (_, 0x14) => Report::Currents(self.currents),
            (_, 0x17) => Report::Bus(Bus { voltage: sensors.bus_voltage, current: sensors.bus_current }),
            _ => return None,
        })
    }

    fn legacy_heartbeat(&self) -> LegacyHeartbeat {
        let errors = &self.errors;
        LegacyHeartbeat {
            axis_error: errors.axis,
            state: self.state,
            motor_error: (errors.motor != 0).into(),
            encoder_error: (errors.encoder != 0).into(),
            controller_flags: u8::from(errors.controller != 0) | u8::from(self.is_trajectory_done) << 7,
        }
    }

    fn count(&self) -> EncoderCount {
        let counts = |angle: Turns| angle.to_counts(self.counts_per_turn);
        let in_turn = counts(self.raw).checked_rem_euclid(self.counts_per_turn.into()).unwrap_or(0);
        EncoderCount { shadow: counts(self.position) as i32, in_turn: in_turn as i32 }
    }
}

/// Angle in the middle of a count.
pub(super) fn angle_of_count(counts: i32, counts_per_turn: u32) -> Turns {
    let half_count = (1_i64 << 31).checked_div(counts_per_turn.into()).unwrap_or(0);
    Turns::from_counts(counts.into(), counts_per_turn).plus(Turns::from_bits(half_count))
}

//! Registers of the server: most of them are settings of the drive; the others are kept as they were written.

use super::command::{Mode, Motion};
use super::kept::Kept;
use super::register::{Form, Register, Value};
use super::server::Server;
use crate::drive::{Drive, Settings};
use crate::scale;

/// Unit of the register TIMEOUT [s].
pub const TIMEOUT_UNIT: f32 = 50e-6;

/// Factor from the speed loop's registers, shares of the largest current at the rotor's speed, to gains at the output.
fn velocity_unit(settings: &Settings) -> f32 {
    let ratio = settings.ratio.to_f32();
    (settings.torque_limit * ratio * ratio).max(f32::MIN_POSITIVE)
}

impl Server {
    /// Value of a register; `None` for the output encoder of a drive that has none.
    pub(super) fn read(&self, register: Register, drive: &Drive) -> Option<Value> {
        match register.form() {
            Form::Whole(_) => Some(Value::U32(self.read_whole(register, drive))),
            Form::Float(_) => self.read_float(register, drive).map(Value::F32),
        }
    }

    fn read_whole(&self, register: Register, drive: &Drive) -> u32 {
        match register {
            Register::FeedbackId => self.feedback_id().into(),
            Register::Id => self.id().into(),
            Register::Timeout => scale::round(drive.settings().watchdog.unwrap_or(0.0) / TIMEOUT_UNIT) as u32,
            Register::ControlMode => self.kept.mode.code(),
            Register::PolePairs => drive.settings().pole_pairs.into(),
            Register::BitRate => self.kept.bit_rate,
            _ => 0,
        }
    }

    fn read_float(&self, register: Register, drive: &Drive) -> Option<f32> {
        let (settings, now, kept) = (drive.settings(), drive.feedback(), &self.kept);
        if let Some(value) = Kept::slot(register).and_then(|slot| kept.floats.get(slot)) {
            return Some(*value);
        }
        let value = match register {
            Register::UnderVoltage => settings.min_voltage,
            Register::OverVoltage => settings.max_voltage,
            Register::OverTemperature => settings.max_temperature,
            Register::OverCurrent => (settings.max_current / settings.peak_current().max(f32::MIN_POSITIVE)).min(1.0),
            Register::Acceleration => kept.acceleration,
            Register::Deceleration => kept.deceleration,
            Register::MaxSpeed => settings.max_velocity.min(f32::MAX),
            Register::Resistance => settings.resistance,
            Register::Flux => settings.torque_constant / (1.5 * f32::from(settings.pole_pairs.max(1))),
            Register::GearRatio => settings.ratio.to_f32(),
            Register::PositionRange => kept.ranges.position,
            Register::VelocityRange => kept.ranges.velocity,
            Register::TorqueRange => kept.ranges.torque,
            Register::VelocityGain => settings.gains.velocity / velocity_unit(settings),
            Register::VelocityIntegral => settings.gains.velocity_integral / velocity_unit(settings),
            Register::PositionGain => settings.gains.position,
            Register::CorrectionOne | Register::CorrectionTwo | Register::Direction => 1.0,
            Register::MaxCurrent => settings.peak_current(),
            Register::BusVoltage => now.sensors.bus_voltage,
            Register::BoardTemperature => now.sensors.board_temperature,
            Register::MotorTemperature => now.sensors.motor_temperature,
            Register::MotorPosition => now.position.to_rad(),
            Register::OutputPosition => return now.output_position.map(|turns| turns.minus(self.output_zero).to_rad()),
            _ => 0.0,
        };
        Some(value)
    }

    /// Writes a register; returns false if it cannot be written or the value is out of range.
    pub(super) fn write(&mut self, register: Register, value: Value, drive: &mut Drive) -> bool {
        if !register.accepts(value) {
            return false;
        }
        match value {
            Value::F32(value) => self.write_float(register, value, drive),
            Value::U32(value) => self.write_whole(register, value, drive),
            _ => return false,
        }
        true
    }

    fn write_whole(&mut self, register: Register, value: u32, drive: &mut Drive) {
        match register {
            Register::FeedbackId => self.set_feedback_id(value as u16),
            Register::Id => self.set_id(value as u16),
            Register::Timeout => drive.set_watchdog((value > 0).then_some(value as f32 * TIMEOUT_UNIT)),
            Register::ControlMode => self.change_mode(Mode::from_code(value).unwrap_or(self.kept.mode), drive),
            Register::BitRate => self.kept.bit_rate = value,
            _ => {}
        }
    }

    fn write_float(&mut self, register: Register, value: f32, drive: &mut Drive) {
        let (settings, kept) = (drive.settings_mut(), &mut self.kept);
        if let Some(kept) = Kept::slot(register).and_then(|slot| kept.floats.get_mut(slot)) {
            *kept = value;
        }
        match register {
            Register::UnderVoltage => settings.min_voltage = value,
            Register::OverVoltage => settings.max_voltage = value,
            Register::OverTemperature => {
                settings.max_temperature = value;
                settings.derating_temperature = value;
            }
            Register::OverCurrent => settings.max_current = value * settings.peak_current(),
            Register::Acceleration => kept.acceleration = value,
            Register::Deceleration => kept.deceleration = value,
            Register::MaxSpeed => settings.max_velocity = value,
            Register::PositionRange => kept.ranges.position = value,
            Register::VelocityRange => kept.ranges.velocity = value,
            Register::TorqueRange => kept.ranges.torque = value,
            Register::VelocityGain => settings.gains.velocity = value * velocity_unit(settings),
            Register::VelocityIntegral => settings.gains.velocity_integral = value * velocity_unit(settings),
            Register::PositionGain => settings.gains.position = value,
            _ => {}
        }
    }

    /// Changes the control mode; an enabled drive has all commands at zero afterwards.
    fn change_mode(&mut self, mode: Mode, drive: &mut Drive) {
        self.kept.mode = mode;
        if drive.set_point().is_some() {
            drive.enable(self.set_point(&Motion::zero(mode), drive));
        }
    }
}

//! Registers that a drive reports.

use core::f32::consts::TAU;

use super::command::Mode;
use super::register as r;
use super::server::Server;
use super::value::{Content, Resolution, Scale, Value};
use crate::drive::{Drive, Fault, SetPoint, Target};
use crate::scale;
use crate::turns::Turns;

/// Version 1.1.0.
const FIRMWARE: i32 = 0x01_01_00;
/// Version of the registers.
const REGISTER_MAP: i32 = 5;
/// Size of the millisecond counter as a float.
const FLOAT_MILLISECONDS: u32 = 1 << 23;
/// Words of serial number and UUID behind the identifier.
const SERIAL: i32 = 0x6765_6172;

impl Server {
    /// Value of a register; `None` for one that cannot be read at this resolution.
    pub(super) fn read(&self, register: u32, resolution: Resolution, drive: &Drive) -> Option<Value> {
        let field = r::describe(register).filter(|field| field.access.is_readable())?;
        if field.scale == Scale::Word && resolution != Resolution::Int32 {
            return None;
        }
        let content = if field.scale.is_number() {
            Content::Number(self.number(register, drive))
        } else {
            Content::Integer(self.integer(register, resolution, drive))
        };
        Some(Value::new(content, field.scale, resolution))
    }

    /// UUID of the drive.
    pub(super) fn uuid(&self) -> [i32; 4] {
        [self.id().into(), SERIAL, SERIAL, SERIAL]
    }

    fn integer(&self, register: u32, resolution: Resolution, drive: &Drive) -> i32 {
        let feedback = drive.feedback();
        match register {
            r::MODE => self.mode(drive) as i32,
            r::TRAJECTORY_COMPLETE => feedback.is_trajectory_done.into(),
            r::HOME_STATE => self.home as i32,
            r::FAULT => self.fault_code(drive),
            r::COMMAND_IGNORE_BOUNDS | r::WITHIN_IGNORE_BOUNDS => self.command.ignores_bounds.into(),
            r::ENCODER_VALIDITY => encoder_validity(drive),
            r::MILLISECOND_COUNTER if resolution == Resolution::Float => {
                (self.milliseconds % FLOAT_MILLISECONDS).cast_signed()
            }
            r::MILLISECOND_COUNTER => self.milliseconds.cast_signed(),
            r::CLOCK_TRIM => self.clock_trim,
            r::FIRMWARE_VERSION => FIRMWARE,
            r::REGISTER_MAP_VERSION => REGISTER_MAP,
            r::SERIAL_NUMBER_1..=r::SERIAL_NUMBER_3 => word(&self.uuid(), register - r::SERIAL_NUMBER_1),
            r::UUID_1..=r::UUID_4 => word(&self.uuid(), register - r::UUID_1),
            r::UUID_MASK_CAPABLE => 1,
            _ => 0,
        }
    }

    fn number(&self, register: u32, drive: &Drive) -> f32 {
        let feedback = drive.feedback();
        let sensors = &feedback.sensors;
        match register {
            r::POSITION => feedback.position.to_f32(),
            r::VELOCITY => feedback.velocity / TAU,
            r::TORQUE => feedback.torque,
            r::Q_CURRENT => feedback.current,
            r::ABS_POSITION | r::ENCODER_1_POSITION => fraction(feedback.output_position.unwrap_or_default()),
            r::POWER => sensors.bus_voltage * sensors.bus_current,
            r::MOTOR_TEMPERATURE => sensors.motor_temperature,
            r::VOLTAGE => sensors.bus_voltage,
            r::TEMPERATURE => sensors.board_temperature,
            r::ENCODER_0_POSITION => fraction(feedback.motor_position),
            r::ENCODER_0_VELOCITY => feedback.motor_velocity / TAU,
            r::ENCODER_1_VELOCITY => feedback.output_velocity / TAU,
            r::AUX1_PWM_DUTY | r::AUX2_PWM_DUTY => f32::NAN,
            r::PROPORTIONAL_TORQUE..=r::TORQUE_ERROR => self.control(register, drive),
            _ => match self.command.read(register) {
                Some(Content::Number(number)) => number,
                _ => 0.0,
            },
        }
    }

    /// Registers of the control loop; torques of the loop have the sign of the error, sensed minus control.
    fn control(&self, register: u32, drive: &Drive) -> f32 {
        let feedback = drive.feedback();
        let set_point = drive.set_point();
        let most = set_point.map_or(0.0, SetPoint::max_torque);
        let torque = scale::limit(feedback.demand, most);
        match (register, set_point) {
            (r::FEEDFORWARD_TORQUE, _) => self.command.torque,
            (r::COMMAND_TORQUE_SUM | r::CONTROL_TORQUE, _) => torque,
            (r::TORQUE_ERROR, _) => feedback.torque - torque,
            (register, Some(SetPoint::Position(target))) => control_of_position(register, target, drive),
            (r::CONTROL_POSITION | r::CONTROL_VELOCITY, _) => f32::NAN,
            _ => 0.0,
        }
    }

    /// Code of the fault; for a drive without a fault that of the limit that reduces its torque, or 0.
    fn fault_code(&self, drive: &Drive) -> i32 {
        match drive.fault() {
            Some(fault) => code(fault),
            None => limit_code(drive, self.mode(drive)),
        }
    }
}

/// Position loop of a target.
fn control_of_position(register: u32, target: &Target, drive: &Drive) -> f32 {
    let (feedback, gains) = (drive.feedback(), &drive.settings().gains);
    let error = feedback.position.minus(feedback.target).to_f32();
    let error_rate = (feedback.velocity - feedback.target_velocity) / TAU;
    let proportional = target.stiffness_scale * gains.stiffness * TAU * error;
    let derivative = target.damping_scale * gains.damping * TAU * error_rate;
    match register {
        r::CONTROL_POSITION => feedback.target.to_f32(),
        r::CONTROL_VELOCITY => feedback.target_velocity / TAU,
        r::POSITION_ERROR => error,
        r::VELOCITY_ERROR => error_rate,
        r::PROPORTIONAL_TORQUE => proportional,
        r::DERIVATIVE_TORQUE => derivative,
        r::INTEGRAL_TORQUE => target.torque - feedback.demand - proportional - derivative,
        _ => 0.0,
    }
}

/// Code of a fault. Faults that the maker does not know have the code of the nearest one.
fn code(fault: Fault) -> i32 {
    match fault {
        Fault::Watchdog => 0,
        // Motor driver fault.
        Fault::EmergencyStop | Fault::OverCurrent => 33,
        Fault::OverVoltage => 34,
        // Encoder fault.
        Fault::MotorEncoder => 35,
        // Motor not configured.
        Fault::NotCalibrated => 36,
        Fault::OverTemperature => 38,
        // Start outside of the limits.
        Fault::OutsideTravel => 39,
        Fault::UnderVoltage => 40,
        // Position invalid: no valid output encoder.
        Fault::OutputEncoder => 43,
        // Stop position together with limits.
        Fault::InvalidCommand => 45,
        // Error of the speed.
        Fault::Overspeed => 50,
    }
}

/// Code of the limit that reduces the torque: temperature of the motor, largest current or commanded torque.
fn limit_code(drive: &Drive, mode: Mode) -> i32 {
    let (feedback, settings) = (drive.feedback(), drive.settings());
    if !feedback.is_limited || matches!(mode, Mode::Stopped | Mode::Calibrating) {
        return 0;
    }
    // After a timeout the damping has its own limit.
    let commanded = drive.set_point().map_or(settings.expiry_torque, SetPoint::max_torque);
    if commanded < settings.torque_limit * settings.ratio.to_f32() {
        102
    } else if feedback.sensors.motor_temperature > settings.derating_temperature {
        101
    } else {
        99
    }
}

/// Bits of the encoders with a reading in the last period.
fn encoder_validity(drive: &Drive) -> i32 {
    let feedback = drive.feedback();
    let motor = if feedback.sensors.motor_counts.is_some() { 0b0011 } else { 0 };
    let has_output = feedback.output_position.is_some() && feedback.sensors.output_counts.is_some();
    motor | if has_output { 0b1100 } else { 0 }
}

fn word(words: &[i32], index: u32) -> i32 {
    words.get(index as usize).copied().unwrap_or(0)
}

/// Angle less whole turns, from 0 to 1.
fn fraction(angle: Turns) -> f32 {
    Turns::from_bits((angle.to_bits() as u32).into()).to_f32()
}

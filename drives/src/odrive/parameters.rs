//! Parameters of firmware 0.6 by their endpoints.
//!
//! Endpoints are numbered by the maker for each pair of hardware and firmware. The numbers here are those of an ODrive
//! S1 as a public client lists them; [`ENDPOINTS`] is the table a client needs in place of `flat_endpoints.json`.

use super::payload::Limits;
use super::server::Server;
use super::units::Units;
use super::{FIRMWARE_VERSION, HARDWARE_VERSION};
use crate::drive::{Drive, State};
pub use crate::value::Value;

/// Encoder of the motor, `ONBOARD_ENCODER0`.
const MOTOR_ENCODER: u8 = 13;

/// Entry of the table.
#[derive(Debug, Clone, Copy)]
pub struct Endpoint {
    /// Number.
    pub id: u16,
    /// Path of the parameter.
    pub path: &'static str,
    /// True for a parameter that can be written.
    pub is_writable: bool,
    parameter: Parameter,
}

macro_rules! endpoints {
    ($($id:literal $path:literal $access:ident $parameter:ident $(($value:expr))?,)*) => {
        /// Endpoints in the order of their numbers.
        pub const ENDPOINTS: &[Endpoint] = &[$(Endpoint {
            id: $id,
            path: $path,
            is_writable: endpoints!(@$access),
            parameter: Parameter::$parameter $(($value))?,
        },)*];
    };
    (@r) => { false };
    (@rw) => { true };
}

#[derive(Debug, Clone, Copy)]
enum Parameter {
    BusVoltage,
    BusCurrent,
    Hardware(usize),
    Firmware(usize),
    Unreleased,
    ActiveErrors,
    DisarmReason,
    CurrentState,
    RequestedState,
    Position,
    Velocity,
    WatchdogTimeout,
    EnableWatchdog,
    NodeId,
    Rate(u8),
    LoopEncoder,
    PolePairs,
    TorqueConstant,
    CurrentLimit,
    CurrentSetpoint,
    CurrentMeasured,
    InverterTemperature,
    MotorTemperature,
    TorqueEstimate,
    MechanicalPower,
    ElectricalPower,
    InputPosition,
    InputVelocity,
    InputTorque,
    PositionSetpoint,
    VelocitySetpoint,
    TorqueSetpoint,
    TrajectoryDone,
    ControlMode,
    InputMode,
    PositionGain,
    VelocityGain,
    VelocityIntegratorGain,
    VelocityIntegratorLimit,
    VelocityLimit,
    VelocityLimitTolerance,
    VelocityRamp,
    TorqueRamp,
    Inertia,
    FilterBandwidth,
    TrajectoryVelocity,
    TrajectoryAcceleration,
    TrajectoryDeceleration,
    ProcedureResult,
    IsArmed,
    MotorEncoder,
    OutputEncoder,
}

endpoints! {
    1 "vbus_voltage" r BusVoltage,
    2 "ibus" r BusCurrent,
    6 "hw_version_major" r Hardware(0),
    7 "hw_version_minor" r Hardware(1),
    8 "hw_version_variant" r Hardware(2),
    10 "fw_version_major" r Firmware(0),
    11 "fw_version_minor" r Firmware(1),
    12 "fw_version_revision" r Firmware(2),
    14 "fw_version_unreleased" r Unreleased,
    175 "axis0.active_errors" r ActiveErrors,
    176 "axis0.disarm_reason" r DisarmReason,
    180 "axis0.current_state" r CurrentState,
    181 "axis0.requested_state" rw RequestedState,
    182 "axis0.pos_estimate" r Position,
    183 "axis0.vel_estimate" r Velocity,
    200 "axis0.config.watchdog_timeout" rw WatchdogTimeout,
    201 "axis0.config.enable_watchdog" rw EnableWatchdog,
    229 "axis0.config.can.node_id" rw NodeId,
    230 "axis0.config.can.version_msg_rate_ms" rw Rate(0x00),
    231 "axis0.config.can.heartbeat_msg_rate_ms" rw Rate(0x01),
    232 "axis0.config.can.encoder_msg_rate_ms" rw Rate(0x09),
    233 "axis0.config.can.iq_msg_rate_ms" rw Rate(0x14),
    234 "axis0.config.can.error_msg_rate_ms" rw Rate(0x03),
    235 "axis0.config.can.temperature_msg_rate_ms" rw Rate(0x15),
    236 "axis0.config.can.bus_voltage_msg_rate_ms" rw Rate(0x17),
    237 "axis0.config.can.torques_msg_rate_ms" rw Rate(0x1c),
    238 "axis0.config.can.powers_msg_rate_ms" rw Rate(0x1d),
    241 "axis0.config.load_encoder" r LoopEncoder,
    242 "axis0.config.commutation_encoder" r LoopEncoder,
    254 "axis0.config.motor.pole_pairs" r PolePairs,
    259 "axis0.config.motor.torque_constant" r TorqueConstant,
    271 "axis0.config.motor.current_soft_max" rw CurrentLimit,
    320 "axis0.motor.foc.Iq_setpoint" r CurrentSetpoint,
    326 "axis0.motor.foc.Iq_measured" r CurrentMeasured,
    333 "axis0.motor.fet_thermistor.temperature" r InverterTemperature,
    334 "axis0.motor.motor_thermistor.temperature" r MotorTemperature,
    350 "axis0.motor.torque_estimate" r TorqueEstimate,
    351 "axis0.motor.mechanical_power" r MechanicalPower,
    352 "axis0.motor.electrical_power" r ElectricalPower,
    367 "axis0.controller.input_pos" rw InputPosition,
    368 "axis0.controller.input_vel" rw InputVelocity,
    369 "axis0.controller.input_torque" rw InputTorque,
    370 "axis0.controller.pos_setpoint" r PositionSetpoint,
    371 "axis0.controller.vel_setpoint" r VelocitySetpoint,
    372 "axis0.controller.torque_setpoint" r TorqueSetpoint,
    374 "axis0.controller.trajectory_done" r TrajectoryDone,
    382 "axis0.controller.config.control_mode" rw ControlMode,
    383 "axis0.controller.config.input_mode" rw InputMode,
    384 "axis0.controller.config.pos_gain" rw PositionGain,
    385 "axis0.controller.config.vel_gain" rw VelocityGain,
    386 "axis0.controller.config.vel_integrator_gain" rw VelocityIntegratorGain,
    387 "axis0.controller.config.vel_integrator_limit" rw VelocityIntegratorLimit,
    388 "axis0.controller.config.vel_limit" rw VelocityLimit,
    389 "axis0.controller.config.vel_limit_tolerance" rw VelocityLimitTolerance,
    390 "axis0.controller.config.vel_ramp_rate" rw VelocityRamp,
    391 "axis0.controller.config.torque_ramp_rate" rw TorqueRamp,
    400 "axis0.controller.config.inertia" rw Inertia,
    401 "axis0.controller.config.input_filter_bandwidth" rw FilterBandwidth,
    416 "axis0.trap_traj.config.vel_limit" rw TrajectoryVelocity,
    417 "axis0.trap_traj.config.accel_limit" rw TrajectoryAcceleration,
    418 "axis0.trap_traj.config.decel_limit" rw TrajectoryDeceleration,
    442 "axis0.pos_vel_mapper.pos_rel" r Position,
    444 "axis0.pos_vel_mapper.vel" r Velocity,
    464 "axis0.commutation_mapper.pos_rel" r Position,
    466 "axis0.commutation_mapper.vel" r Velocity,
    532 "axis0.procedure_result" r ProcedureResult,
    534 "axis0.is_armed" r IsArmed,
    541 "onboard_encoder0.raw" r MotorEncoder,
    568 "spi_encoder0.raw" r OutputEncoder,
}

/// Endpoint of a number.
pub fn endpoint(id: u16) -> Option<&'static Endpoint> {
    ENDPOINTS.iter().find(|endpoint| endpoint.id == id)
}

/// Endpoint of a path.
pub fn endpoint_of(path: &str) -> Option<&'static Endpoint> {
    ENDPOINTS.iter().find(|endpoint| endpoint.path == path)
}

/// Value of a parameter.
pub(super) fn read(endpoint: &Endpoint, server: &Server, drive: &Drive) -> Value {
    let (settings, controller, readings) = (drive.settings(), server.controller(), server.readings(drive));
    let (units, configuration) = (Units::new(settings.ratio), &controller.configuration);
    let float = match endpoint.parameter {
        Parameter::Hardware(at) => return Value::U8(HARDWARE_VERSION.get(at).copied().unwrap_or(0)),
        Parameter::Firmware(at) => return Value::U8(FIRMWARE_VERSION.get(at).copied().unwrap_or(0)),
        Parameter::Unreleased => return Value::U8(0),
        Parameter::ActiveErrors => return Value::U32(readings.errors.axis),
        Parameter::DisarmReason => return Value::U32(readings.errors.disarm_reason),
        Parameter::CurrentState => return Value::U8(readings.state),
        Parameter::RequestedState => return Value::U8(0),
        Parameter::EnableWatchdog => return Value::Bool(settings.watchdog.is_some()),
        Parameter::NodeId => return Value::U32(server.node_id().into()),
        Parameter::Rate(command) => return Value::U32(server.rate(command).unwrap_or(0)),
        Parameter::LoopEncoder => return Value::U8(MOTOR_ENCODER),
        Parameter::PolePairs => return Value::U32(settings.pole_pairs.into()),
        Parameter::TrajectoryDone => return Value::Bool(readings.is_trajectory_done),
        Parameter::ControlMode => return Value::U8(configuration.control_mode as u8),
        Parameter::InputMode => return Value::U8(configuration.input_mode as u8),
        Parameter::ProcedureResult => return Value::U8(readings.procedure_result),
        Parameter::IsArmed => return Value::Bool(drive.state() == State::Enabled),
        Parameter::BusVoltage => readings.sensors.bus_voltage,
        Parameter::BusCurrent => readings.sensors.bus_current,
        Parameter::Position => readings.position.to_f32(),
        Parameter::Velocity => readings.velocity,
        Parameter::WatchdogTimeout => server.watchdog_timeout(drive),
        Parameter::TorqueConstant => settings.torque_constant,
        Parameter::CurrentLimit => settings.peak_current(),
        Parameter::CurrentSetpoint => readings.currents.setpoint,
        Parameter::CurrentMeasured => readings.currents.measured,
        Parameter::InverterTemperature => readings.sensors.board_temperature,
        Parameter::MotorTemperature => readings.sensors.motor_temperature,
        Parameter::TorqueEstimate => readings.sensors.motor_torque,
        Parameter::MechanicalPower => readings.powers().mechanical,
        Parameter::ElectricalPower => readings.powers().electrical,
        Parameter::InputPosition => units.to_position(controller.input.position).to_f32(),
        Parameter::InputVelocity => units.to_velocity(controller.input.velocity),
        Parameter::InputTorque => units.to_torque(controller.input.torque),
        Parameter::PositionSetpoint => units.to_position(controller.set_point.position).to_f32(),
        Parameter::VelocitySetpoint => units.to_velocity(controller.set_point.velocity),
        Parameter::TorqueSetpoint => units.to_torque(controller.set_point.torque),
        Parameter::PositionGain => settings.gains.position,
        Parameter::VelocityGain => units.to_gain(settings.gains.velocity),
        Parameter::VelocityIntegratorGain => units.to_gain(settings.gains.velocity_integral),
        Parameter::VelocityIntegratorLimit => units.to_torque(settings.velocity_integral_limit),
        Parameter::VelocityLimit => units.to_velocity(settings.max_velocity),
        Parameter::VelocityLimitTolerance => configuration.velocity_tolerance,
        Parameter::VelocityRamp => configuration.velocity_ramp,
        Parameter::TorqueRamp => configuration.torque_ramp,
        Parameter::Inertia => configuration.inertia,
        Parameter::FilterBandwidth => configuration.filter_bandwidth,
        Parameter::TrajectoryVelocity => configuration.trajectory_velocity,
        Parameter::TrajectoryAcceleration => configuration.trajectory_acceleration,
        Parameter::TrajectoryDeceleration => configuration.trajectory_deceleration,
        Parameter::MotorEncoder => turn_fraction(drive.feedback().motor_position.to_bits()),
        // Without an output encoder the value is no number.
        Parameter::OutputEncoder => {
            drive.feedback().output_position.map_or(f32::NAN, |angle| turn_fraction(angle.to_bits()))
        }
    };
    Value::F32(float)
}

/// Fraction of a turn, from 0 to below 1, of an angle in 2^-32 turns.
fn turn_fraction(bits: i64) -> f32 {
    // 24 bits fit an f32 exactly, so the largest fraction does not round to 1.
    ((bits as u32) >> 8) as f32 / (1 << 24) as f32
}

/// Writes a parameter; values out of its range change nothing.
pub(super) fn write(endpoint: &Endpoint, value: [u8; 4], server: &mut Server, drive: &mut Drive) {
    if !endpoint.is_writable {
        return;
    }
    let number = u32::from_le_bytes(value);
    let float = f32::from_bits(number);
    let units = Units::new(drive.settings().ratio);
    let current = drive.settings().peak_current();
    let speed = units.to_velocity(drive.settings().max_velocity);
    match endpoint.parameter {
        Parameter::RequestedState => server.request_state((number as u8).into(), drive),
        Parameter::EnableWatchdog => server.enable_watchdog(number as u8 != 0, drive),
        Parameter::NodeId => server.set_node_id(number),
        Parameter::Rate(command) => server.set_rate(command, number),
        Parameter::ControlMode => server.set_control_mode((number as u8).into(), drive),
        Parameter::InputMode => server.set_input_mode((number as u8).into(), drive),
        _ if float.is_nan() => {}
        Parameter::WatchdogTimeout => server.set_watchdog(drive.settings().watchdog.is_some(), float, drive),
        Parameter::InputPosition => server.set_input(Some(float), None, None, drive),
        Parameter::InputVelocity => server.set_input(None, Some(float), None, drive),
        Parameter::InputTorque => server.set_input(None, None, Some(float), drive),
        Parameter::CurrentLimit => server.set_limits(Limits { velocity: speed, current: float }, drive),
        Parameter::VelocityLimit => server.set_limits(Limits { velocity: float, current }, drive),
        Parameter::VelocityLimitTolerance if float > 0.0 => {
            server.configuration_mut().velocity_tolerance = float;
            server.set_limits(Limits { velocity: speed, current }, drive);
        }
        Parameter::PositionGain if float.is_finite() => drive.settings_mut().gains.position = float,
        Parameter::VelocityGain if float.is_finite() => drive.settings_mut().gains.velocity = units.gain(float),
        Parameter::VelocityIntegratorGain if float.is_finite() => {
            drive.settings_mut().gains.velocity_integral = units.gain(float);
        }
        Parameter::VelocityIntegratorLimit if float >= 0.0 => {
            drive.settings_mut().velocity_integral_limit = units.torque(float);
        }
        _ if !float.is_finite() => {}
        Parameter::VelocityRamp => server.configuration_mut().velocity_ramp = float,
        Parameter::TorqueRamp => server.configuration_mut().torque_ramp = float,
        Parameter::Inertia => server.configuration_mut().inertia = float,
        Parameter::FilterBandwidth if float >= 0.0 => server.configuration_mut().filter_bandwidth = float,
        Parameter::TrajectoryVelocity => server.configuration_mut().trajectory_velocity = float,
        Parameter::TrajectoryAcceleration => server.configuration_mut().trajectory_acceleration = float,
        Parameter::TrajectoryDeceleration => server.configuration_mut().trajectory_deceleration = float,
        _ => {}
    }
}

//! Commands to the axis with the motor: configuration, inputs and parameters.

use super::axis::angle_of_count;
use super::codes::reboot;
use super::message::{Command, MAX_NODE, Report};
use super::parameters;
use super::payload::{self, Limits, ParameterAccess};
use super::server::{BROADCAST, Server};
use super::units::Units;
use crate::drive::{Drive, Fault};
use crate::frame::Send;

/// Pins of a board with firmware 0.5.
const PIN_COUNT: u8 = 17;

impl Server {
    /// Carries out a command.
    pub(super) fn obey(&mut self, command: Command, drive: &mut Drive, send: Send<'_>) {
        let units = Units::new(drive.settings().ratio);
        let counts_per_turn = drive.settings().motor_counts_per_turn;
        match command {
            Command::Estop(_) => drive.declare(Fault::EmergencyStop),
            Command::Parameter(access) => self.access(access, drive, send),
            Command::SetNodeId(payload) => self.set_node_id(payload.node_id),
            Command::SetAddress(payload) => self.set_address(payload),
            Command::SetState(payload) => self.request_state(payload.state, drive),
            Command::SetControllerMode(payload) => {
                self.controller.configuration.input_mode = payload.input;
                self.set_control_mode(payload.control, drive);
            }
            Command::SetInputPosition(payload) => {
                let (velocity, torque) = (payload.velocity.0, payload.torque.0);
                self.set_input(Some(payload.position), Some(velocity), Some(torque), drive);
            }
            Command::SetInputVelocity(payload) => {
                self.set_input(None, Some(payload.velocity), Some(payload.torque), drive);
            }
            Command::SetInputTorque(payload) => self.set_input(None, None, Some(payload.torque), drive),
            Command::SetLimits(limits) => self.set_limits(limits, drive),
            Command::SetLinearCount(payload) => {
                let angle = angle_of_count(payload.position, counts_per_turn);
                drive.set_position(angle.over(drive.settings().ratio));
            }
            Command::SetAbsolutePosition(payload) if payload.position.is_finite() => {
                drive.set_position(units.position(payload.position));
            }
            Command::Reboot(payload) if payload.action == reboot::ENTER_DFU_MODE => {}
            Command::Reboot(_) => self.reboot(drive),
            Command::ClearErrors(payload) => {
                self.is_identifying = payload.identify != 0;
                self.clear_errors(drive);
            }
            Command::RequestAdcVoltage(payload) if payload.pin < PIN_COUNT => {
                let report = Report::AdcVoltage(payload::AdcVoltage::default());
                self.send(Some(report), self.node_id, send);
            }
            _ => self.configure(command, drive),
        }
    }

    /// Takes a gain or a limit of a trajectory; numbers that are not finite change nothing.
    fn configure(&mut self, command: Command, drive: &mut Drive) {
        let units = Units::new(drive.settings().ratio);
        let (gains, configuration) = (&mut drive.settings_mut().gains, &mut self.controller.configuration);
        match command {
            Command::SetTrajectoryVelocity(payload) if payload.velocity.is_finite() => {
                configuration.trajectory_velocity = payload.velocity;
            }
            Command::SetTrajectoryAcceleration(payload)
                if payload.acceleration.is_finite() && payload.deceleration.is_finite() =>
            {
                configuration.trajectory_acceleration = payload.acceleration;
                configuration.trajectory_deceleration = payload.deceleration;
            }
            Command::SetInertia(payload) if payload.inertia.is_finite() => configuration.inertia = payload.inertia,
            Command::SetPositionGain(payload) if payload.gain.is_finite() => gains.position = payload.gain,
            Command::SetVelocityGains(payload) if payload.gain.is_finite() && payload.integrator.is_finite() => {
                gains.velocity = units.gain(payload.gain);
                gains.velocity_integral = units.gain(payload.integrator);
            }
            _ => {}
        }
    }

    fn access(&mut self, access: ParameterAccess, drive: &mut Drive, send: Send<'_>) {
        let Some(endpoint) = parameters::endpoint(access.endpoint) else {
            return;
        };
        match access.opcode {
            0 => {
                let value = parameters::read(endpoint, self, drive).to_bytes();
                let answer = ParameterAccess { opcode: 0, endpoint: access.endpoint, value };
                self.send(Some(Report::Parameter(answer)), self.node_id, send);
            }
            1 => parameters::write(endpoint, access.value, self, drive),
            _ => {}
        }
    }

    /// Takes the node for this serial number, or gives up a node that another serial number takes.
    fn set_address(&mut self, address: payload::Address) {
        if address.serial_number == self.serial_number {
            self.set_node_id(address.node_id.into());
        } else if address.node_id == self.node_id {
            self.node_id = BROADCAST;
        }
    }

    pub(super) fn set_watchdog(&mut self, is_enabled: bool, timeout: f32, drive: &mut Drive) {
        self.watchdog_timeout = timeout;
        drive.set_watchdog(is_enabled.then_some(timeout));
    }

    pub(super) fn enable_watchdog(&mut self, is_enabled: bool, drive: &mut Drive) {
        self.set_watchdog(is_enabled, self.watchdog_timeout(drive), drive);
    }

    pub(super) fn set_node_id(&mut self, node_id: u32) {
        if let Some(node_id) = u8::try_from(node_id).ok().filter(|node_id| *node_id <= MAX_NODE) {
            self.node_id = node_id;
        }
    }

    /// Sets inputs in units of the motor; inputs that are no finite number change nothing.
    pub(super) fn set_input(
        &mut self,
        position: Option<f32>,
        velocity: Option<f32>,
        torque: Option<f32>,
        drive: &mut Drive,
    ) {
        let given = [position, velocity, torque];
        if given.into_iter().flatten().any(|value| !value.is_finite()) {
            return;
        }
        let units = Units::new(drive.settings().ratio);
        let input = &mut self.controller.input;
        input.velocity = velocity.map_or(input.velocity, |velocity| units.velocity(velocity));
        input.torque = torque.map_or(input.torque, |torque| units.torque(torque));
        if let Some(position) = position {
            self.controller.set_position(units.position(position));
        }
        if self.controller.is_direct() {
            self.control(drive);
        }
    }

    /// Sets the limits; limits that are negative or no number change nothing.
    pub(super) fn set_limits(&mut self, limits: Limits, drive: &mut Drive) {
        let tolerance = self.controller.configuration.velocity_tolerance;
        let settings = drive.settings_mut();
        if limits.velocity >= 0.0 && limits.current >= 0.0 && limits.current.is_finite() {
            settings.max_velocity = Units::new(settings.ratio).velocity(limits.velocity);
            settings.overspeed = tolerance * settings.max_velocity;
            settings.torque_limit = limits.current * settings.torque_constant;
        }
    }

    pub(super) fn set_control_mode(&mut self, mode: u32, drive: &mut Drive) {
        self.controller.configuration.control_mode = mode;
        self.controller.change_mode(drive);
        if self.controller.is_direct() {
            self.control(drive);
        }
    }

    pub(super) fn set_input_mode(&mut self, mode: u32, drive: &mut Drive) {
        self.controller.configuration.input_mode = mode;
        if self.controller.is_direct() {
            self.control(drive);
        }
    }
}

//! Drive on the bus.

use super::Firmware;
use super::axis::Readings;
use super::codes::{axis_error, axis_state, procedure_result};
use super::controller::{Configuration, Controller, State as Input};
use super::cyclic::Cyclic;
use super::errors::AxisErrors;
use super::message::{Command, MAX_NODE, Report, address};
use super::output_axis::OutputAxis;
use super::payload;
use super::procedure::Procedure;
use crate::bus::CanServer;
use crate::drive::{Drive, Fault, State};
use crate::frame::{Frame, Kind, Send};

/// Node of a broadcast, and of an axis without an address (firmware 0.6).
pub const BROADCAST: u8 = MAX_NODE;

/// ODrive on the bus.
#[derive(Debug, Clone)]
pub struct Server {
    pub(super) firmware: Firmware,
    pub(super) node_id: u8,
    pub(super) serial_number: [u8; 6],
    pub(super) controller: Controller,
    pub(super) procedure: Procedure,
    pub(super) errors: AxisErrors,
    pub(super) cyclic: Cyclic,
    pub(super) output_axis: Option<OutputAxis>,
    pub(super) watchdog_timeout: f32,
    /// Time since the last frame to this axis [s].
    pub(super) silence: f32,
    pub(super) was_armed: bool,
    pub(super) is_identifying: bool,
}

impl Server {
    /// Drive at a node up to 0x3f; higher bits are cut off. With firmware 0.5 the second axis, which has the output
    /// encoder, is the next node.
    pub fn new(node_id: u8, firmware: Firmware) -> Self {
        let node_id = node_id & MAX_NODE;
        let mut server = Self {
            firmware,
            node_id,
            serial_number: [node_id, 0, 0, 0, 0, 0],
            controller: Controller::default(),
            procedure: Procedure::new(),
            errors: AxisErrors::default(),
            cyclic: Cyclic::new(firmware),
            output_axis: None,
            watchdog_timeout: 0.0,
            silence: 0.0,
            was_armed: false,
            is_identifying: false,
        };
        if firmware == Firmware::V0_5 {
            server.set_output_node(Some(node_id.wrapping_add(1)));
        }
        server
    }

    /// Node of the motor's axis; a client may change it.
    pub fn node_id(&self) -> u8 {
        self.node_id
    }

    /// Firmware line.
    pub fn firmware(&self) -> Firmware {
        self.firmware
    }

    /// Node of the axis with the output encoder (firmware 0.5).
    pub fn output_node(&self) -> Option<u8> {
        self.output_axis.as_ref().map(|axis| axis.node_id)
    }

    /// Sets the node of the axis with the output encoder; `None` takes the axis off the bus.
    pub fn set_output_node(&mut self, node_id: Option<u8>) {
        self.output_axis = node_id.map(|node_id| OutputAxis::new(node_id & MAX_NODE));
    }

    /// Serial number of 48 bits by which firmware 0.6 is addressed.
    pub fn serial_number(&self) -> u64 {
        let [a, b, c, d, e, f] = self.serial_number;
        u64::from_le_bytes([a, b, c, d, e, f, 0, 0])
    }

    /// Sets the serial number.
    pub fn set_serial_number(&mut self, number: u64) {
        let [a, b, c, d, e, f, _, _] = number.to_le_bytes();
        self.serial_number = [a, b, c, d, e, f];
    }

    /// True while a client wants the lamp to blink.
    pub fn is_identifying(&self) -> bool {
        self.is_identifying
    }

    /// Period of a cyclic message [ms]; `None` for a message that is not cyclic.
    pub fn rate(&self, command: u8) -> Option<u32> {
        self.cyclic.rate(command)
    }

    /// Sets the period of a cyclic message [ms]; 0 turns it off.
    pub fn set_rate(&mut self, command: u8, rate: u32) {
        self.cyclic.set_rate(command, rate);
    }

    pub(super) fn controller(&self) -> &Controller {
        &self.controller
    }

    pub(super) fn configuration_mut(&mut self) -> &mut Configuration {
        &mut self.controller.configuration
    }

    /// Time after which the watchdog expires, also while it is off [s].
    pub(super) fn watchdog_timeout(&self, drive: &Drive) -> f32 {
        drive.settings().watchdog.unwrap_or(self.watchdog_timeout)
    }

    /// Readings of the motor's axis.
    pub(super) fn readings(&self, drive: &Drive) -> Readings {
        Readings {
            state: self.procedure.state(drive),
            procedure_result: self.procedure.result,
            is_trajectory_done: self.controller.is_trajectory_done(),
            errors: self.errors,
            ..Readings::of_motor(drive)
        }
    }

    pub(super) fn request_state(&mut self, state: u32, drive: &mut Drive) {
        if state == axis_state::UNDEFINED.into() {
            return;
        }
        if self.firmware == Firmware::V0_5 {
            self.errors.axis &= !axis_error::INVALID_STATE;
        }
        let has_error = drive.fault().is_some() || self.errors.axis != 0;
        if self.procedure.request(state, has_error, drive) {
            self.arm(drive);
        }
        if self.firmware == Firmware::V0_5 {
            self.errors.axis |= match self.procedure.result {
                procedure_result::INVALID_STATE | procedure_result::NOT_CALIBRATED => axis_error::INVALID_STATE,
                procedure_result::HOMING_WITHOUT_ENDSTOP => axis_error::HOMING_WITHOUT_ENDSTOP,
                _ => 0,
            };
        }
    }

    fn arm(&mut self, drive: &mut Drive) {
        self.errors.disarm_reason = 0;
        if self.firmware == Firmware::V0_6 {
            self.controller.input = Input { position: self.controller.input.position, ..Input::default() };
        }
        self.controller.start(drive);
        match self.controller.step(drive) {
            Ok(set_point) => drive.enable(set_point),
            Err(code) => self.fail(code, drive),
        }
        self.was_armed = true;
    }

    /// Gives the drive its set-point; a mode that is not possible is a fault.
    pub(super) fn control(&mut self, drive: &mut Drive) {
        if drive.state() == State::Enabled {
            match self.controller.step(drive) {
                Ok(set_point) => drive.change_set_point(set_point),
                Err(code) => self.fail(code, drive),
            }
        }
    }

    pub(super) fn fail(&mut self, code: u32, drive: &mut Drive) {
        if self.firmware == Firmware::V0_5 {
            self.errors.add_controller(code);
        }
        drive.declare(Fault::InvalidCommand);
    }

    pub(super) fn clear_errors(&mut self, drive: &mut Drive) {
        self.errors = AxisErrors::default();
        if let Some(axis) = &mut self.output_axis {
            axis.errors = AxisErrors::default();
        }
        self.procedure.clear_result();
        self.silence = 0.0;
        drive.clear_fault();
    }

    /// Restarts with the present configuration.
    pub(super) fn reboot(&mut self, drive: &mut Drive) {
        drive.restart();
        self.controller = Controller::new(self.controller.configuration);
        self.procedure = Procedure::new();
        self.errors = AxisErrors::default();
        self.silence = 0.0;
        self.was_armed = false;
        self.is_identifying = false;
        if let Some(axis) = &mut self.output_axis {
            axis.reset();
        }
    }

    fn feed(&mut self, drive: &mut Drive) {
        self.silence = 0.0;
        drive.feed();
    }

    pub(super) fn send(&self, report: Option<Report>, node_id: u8, send: Send<'_>) {
        if let Some(frame) = report.and_then(|report| report.encode(self.firmware, node_id)) {
            send(frame);
        }
    }

    /// Handles a frame to the motor's axis.
    fn receive_own(&mut self, command: u8, frame: &Frame, drive: &mut Drive, send: Send<'_>) {
        self.feed(drive);
        if is_request(self.firmware, command, frame) {
            let report = match (self.firmware, command) {
                (Firmware::V0_6, 0x06) => Some(self.address()),
                _ => self.readings(drive).report(self.firmware, command),
            };
            if report.is_some() {
                self.send(report, self.node_id, send);
                return;
            }
        }
        if let Some(command) = data_command(self.firmware, command, frame) {
            self.obey(command, drive, send);
        }
    }

    fn address(&self) -> Report {
        let (node_id, serial_number) = (self.node_id, self.serial_number);
        Report::Address(payload::Address { node_id, serial_number, connection: 0 })
    }

    /// Handles a frame to all axes (firmware 0.6).
    fn receive_broadcast(&mut self, command: u8, frame: &Frame, drive: &mut Drive, send: Send<'_>) {
        if command == 0x06 && is_request(self.firmware, command, frame) {
            self.send(Some(self.address()), self.node_id, send);
            return;
        }
        let addressed = data_command(self.firmware, command, frame)
            .filter(|command| matches!(command, Command::SetAddress(_) | Command::Reboot(_) | Command::ClearErrors(_)));
        if let Some(command) = addressed {
            self.obey(command, drive, send);
        }
    }

    /// Handles a frame to the axis with the output encoder (firmware 0.5).
    fn receive_output(&mut self, command: u8, frame: &Frame, drive: &mut Drive, send: Send<'_>) {
        let Some(axis) = &mut self.output_axis else {
            return;
        };
        if is_request(self.firmware, command, frame) {
            let (report, node_id) = (axis.report(command, drive), axis.node_id);
            self.send(report, node_id, send);
            return;
        }
        match data_command(self.firmware, command, frame) {
            Some(Command::Reboot(_)) => self.reboot(drive),
            Some(Command::ClearErrors(_)) => self.clear_errors(drive),
            Some(command) => axis.obey(command, drive),
            None => {}
        }
    }

    /// Records a new fault of the drive.
    fn record_faults(&mut self, drive: &Drive) {
        self.errors.record(self.firmware, drive, self.was_armed);
        if let Some(axis) = &mut self.output_axis {
            axis.errors.record_second(drive.fault());
        }
        self.was_armed = drive.state() == State::Enabled;
    }

    /// Declares the watchdog of firmware 0.5, which runs in each state.
    fn watch(&mut self, drive: &mut Drive) {
        self.silence += drive.settings().period;
        let is_expired = drive.settings().watchdog.is_some_and(|timeout| timeout > 0.0 && self.silence > timeout);
        if is_expired && self.firmware == Firmware::V0_5 && drive.fault().is_none() {
            drive.declare(Fault::Watchdog);
        }
    }
}

/// True for a remote frame or one without data, which requests a report.
fn is_request(firmware: Firmware, command: u8, frame: &Frame) -> bool {
    let is_empty = frame.kind == Kind::Remote || frame.length() == 0;
    match (firmware, command) {
        // Firmware 0.5 sends its heartbeat by itself only, and answers any frame that asks for the controller's error.
        (Firmware::V0_5, 0x01) => false,
        (Firmware::V0_5, 0x1d) => true,
        _ => is_empty,
    }
}

/// Command of a data frame.
fn data_command(firmware: Firmware, command: u8, frame: &Frame) -> Option<Command> {
    Command::decode_data(firmware, command, frame.data()).filter(|_| frame.kind == Kind::Classic)
}

impl CanServer for Server {
    fn receive(&mut self, frame: &Frame, drive: &mut Drive, send: Send<'_>) {
        let Some((node_id, command)) = address(frame) else {
            return;
        };
        if self.firmware == Firmware::V0_6 && node_id == BROADCAST {
            self.receive_broadcast(command, frame, drive, send);
        } else if node_id == self.node_id {
            self.receive_own(command, frame, drive, send);
        } else if self.output_node() == Some(node_id) {
            self.receive_output(command, frame, drive, send);
        }
        self.record_faults(drive);
    }

    fn tick(&mut self, drive: &mut Drive, send: Send<'_>) {
        self.watch(drive);
        self.record_faults(drive);
        self.control(drive);
        self.record_faults(drive);
        self.procedure.step(drive);
        let period = drive.settings().period;
        let readings = self.readings(drive);
        for command in self.cyclic.step(period).into_iter().flatten() {
            self.send(readings.report(self.firmware, command), self.node_id, send);
        }
        let Some(axis) = &mut self.output_axis else {
            return;
        };
        let (due, node_id) = (axis.cyclic.step(period), axis.node_id);
        for report in due.map(|command| command.and_then(|command| axis.report(command, drive))) {
            self.send(report, node_id, send);
        }
    }
}

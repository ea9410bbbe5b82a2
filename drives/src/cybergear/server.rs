//! Drive on the bus.

use super::answer::{Answer, Feedback, Mode};
use super::faults::{Flags, fault_word, warning_word};
use super::model::Model;
use super::parameter::Value;
use super::registers::{Registers, RunMode};
use super::request::{Command, Operation, Request};
use crate::bus::CanServer;
use crate::drive::{Drive, Fault, SetPoint, State};
use crate::frame::{Frame, Send};
use crate::turns::Turns;

/// Largest address of a drive.
const MAX_ADDRESS: u8 = 127;
/// Bits of the turns that the feedback of a RobStride covers, -4 pi to 4 pi.
const FEEDBACK_TURNS: i64 = 4 << 32;

/// Drive of either maker.
#[derive(Debug, Clone)]
pub struct Server {
    model: Model,
    unique_id: [u8; 8],
    registers: Registers,
    operation: Operation,
    /// Fault of the last period.
    fault: Option<Fault>,
    was_enabled: bool,
    is_calibrating: bool,
    is_reporting: bool,
    /// Time since the last report [s].
    report_age: f32,
}

impl Server {
    /// Drive with an address from 1 to 127; the makers' is 127.
    pub fn new(id: u8, model: Model) -> Self {
        Self {
            model,
            unique_id: [0, 0, 0, 0, 0, 0, 0, id],
            registers: Registers::new(id, model),
            operation: Operation::default(),
            fault: None,
            was_enabled: false,
            is_calibrating: false,
            is_reporting: false,
            report_age: 0.0,
        }
    }

    /// Drive with the unique identifier of its controller.
    pub fn with_unique_id(self, unique_id: [u8; 8]) -> Self {
        Self { unique_id, ..self }
    }

    /// Address, which a client can change.
    pub fn id(&self) -> u8 {
        self.registers.drive
    }

    /// Model.
    pub fn model(&self) -> Model {
        self.model
    }

    /// Address of the host that commanded last.
    pub fn host(&self) -> u8 {
        self.registers.host
    }

    /// Run mode.
    pub fn run_mode(&self) -> RunMode {
        self.registers.mode
    }

    fn send(&self, answer: Answer, send: Send<'_>) {
        if let Some(frame) = answer.encode(self.model) {
            send(frame);
        }
    }

    /// Answers a command.
    fn execute(&mut self, command: Command, drive: &mut Drive) -> Option<Answer> {
        match command {
            Command::Identify | Command::SetRate(_) | Command::SetProtocol(_) => return Some(self.device()),
            Command::SetAddress(address) => {
                // Without an answer for an address that no drive can have.
                (1..=MAX_ADDRESS).contains(&address).then(|| self.registers.drive = address)?;
                return Some(self.device());
            }
            Command::Read(index) => return self.read(index, drive),
            Command::Operate(operation) => self.operate(operation, drive),
            Command::Enable => self.enable(drive),
            Command::Stop(clears) => self.stop(clears, drive),
            Command::Calibrate => {
                drive.calibrate();
                self.is_calibrating = matches!(drive.state(), State::Calibrating(_));
            }
            Command::SetZero => self.set_zero(drive),
            Command::Write(index, bytes) => self.write(index, bytes, drive),
            Command::Save => {}
            Command::Report(is_on) => {
                (self.is_reporting, self.report_age) = (is_on, 0.0);
                return Some(self.report(drive));
            }
        }
        Some(self.feedback(drive))
    }

    fn device(&self) -> Answer {
        Answer::Device { drive: self.id(), unique_id: self.unique_id }
    }

    fn read(&self, index: u16, drive: &Drive) -> Option<Answer> {
        let parameter = self.model.parameter(index);
        let value = parameter.and_then(|parameter| self.registers.read(parameter, drive)).map(Value::to_bytes);
        // CyberGear's answer has no place for a failure.
        let answers = value.is_some() || self.model.is_robstride();
        answers.then_some(Answer::Parameter { drive: self.id(), host: self.host(), index, value })
    }

    fn write(&mut self, index: u16, bytes: [u8; 4], drive: &mut Drive) {
        if let Some(parameter) = self.model.parameter(index) {
            self.registers.write(parameter, Value::from_bytes(parameter.kind(), bytes), drive);
            self.apply(drive);
        }
    }

    fn operate(&mut self, operation: Operation, drive: &mut Drive) {
        if drive.state() == State::Enabled {
            self.operation = operation;
            self.apply(drive);
        }
    }

    fn enable(&mut self, drive: &mut Drive) {
        let position = drive.feedback().position;
        self.registers.loc_ref = self.registers.loc_ref.or(Some(position));
        drive.settings_mut().max_velocity = self.registers.max_velocity();
        drive.enable(self.set_point(drive));
        self.was_enabled = drive.state() == State::Enabled;
    }

    fn stop(&mut self, clears: bool, drive: &mut Drive) {
        drive.disable();
        self.release();
        if clears {
            drive.clear_fault();
        }
    }

    fn release(&mut self) {
        self.registers.release();
        self.operation = Operation::default();
        self.was_enabled = false;
    }

    /// Makes the present angle zero; an enabled drive stays where it is. A profile forbids it.
    fn set_zero(&mut self, drive: &mut Drive) {
        let is_enabled = drive.state() == State::Enabled;
        if is_enabled && self.model.is_robstride() && self.run_mode() == RunMode::Position {
            return;
        }
        drive.set_position(Turns::ZERO);
        self.operation.angle = 0.0;
        self.registers.loc_ref = self.registers.loc_ref.map(|_| Turns::ZERO);
        self.apply(drive);
    }

    fn set_point(&self, drive: &Drive) -> SetPoint {
        let Operation { angle, speed, kp, kd, torque } = self.operation;
        self.registers.set_point(drive).unwrap_or(SetPoint::Impedance {
            position: Turns::from_rad(angle),
            velocity: speed,
            stiffness: kp,
            damping: kd,
            torque,
        })
    }

    /// Brings references and limits to an enabled drive.
    fn apply(&self, drive: &mut Drive) {
        if drive.state() == State::Enabled {
            drive.settings_mut().max_velocity = self.registers.max_velocity();
            drive.enable(self.set_point(drive));
        }
    }

    fn measurement(&self, drive: &Drive) -> Feedback {
        let now = drive.feedback();
        let mode = match drive.state() {
            State::Disabled => Mode::Reset,
            State::Calibrating(_) => Mode::Calibration,
            State::Enabled | State::TimedOut => Mode::Run,
        };
        let angle = if self.model.is_robstride() { wrapped(now.position) } else { now.position };
        Feedback {
            mode,
            flags: Flags::new(self.model, drive),
            angle: angle.to_rad(),
            speed: now.velocity,
            torque: now.torque,
            temperature: now.sensors.motor_temperature,
        }
    }

    fn feedback(&self, drive: &Drive) -> Answer {
        Answer::Feedback { drive: self.id(), host: self.host(), feedback: self.measurement(drive) }
    }

    fn report(&self, drive: &Drive) -> Answer {
        Answer::Report { drive: self.id(), host: self.host(), feedback: self.measurement(drive) }
    }

    /// Follows a drive that stopped by itself. A timeout resets it without a fault.
    fn settle(&mut self, drive: &mut Drive) {
        if drive.fault() == Some(Fault::Watchdog) {
            drive.clear_fault();
        }
        if self.was_enabled && drive.state() == State::Disabled {
            self.release();
        }
    }

    /// Sends a new fault.
    fn tell_fault(&mut self, drive: &Drive, send: Send<'_>) {
        let before = core::mem::replace(&mut self.fault, drive.fault());
        if self.fault.is_some() && self.fault != before {
            let (faults, warnings) = (fault_word(drive), warning_word(self.model, drive));
            self.send(Answer::Fault { drive: self.id(), host: self.host(), faults, warnings }, send);
        }
    }

    /// Sends the result of a calibration that has ended; the offset is that of this drive, zero.
    fn tell_calibration(&mut self, drive: &Drive, send: Send<'_>) {
        if self.is_calibrating && !matches!(drive.state(), State::Calibrating(_)) {
            self.is_calibrating = false;
            if drive.is_calibrated() {
                self.send(Answer::Calibrated { drive: self.id(), host: self.host(), offset: 0.0 }, send);
            }
        }
    }
}

impl CanServer for Server {
    fn receive(&mut self, frame: &Frame, drive: &mut Drive, send: Send<'_>) {
        let Some(request) = Request::decode(self.model, frame).filter(|request| request.drive == self.id()) else {
            return;
        };
        self.settle(drive);
        drive.feed();
        self.registers.host = request.host.unwrap_or(self.registers.host);
        if let Some(answer) = self.execute(request.command, drive) {
            self.send(answer, send);
        }
    }

    fn tick(&mut self, drive: &mut Drive, send: Send<'_>) {
        self.settle(drive);
        self.tell_fault(drive, send);
        self.tell_calibration(drive, send);
        if self.is_reporting {
            self.report_age += drive.settings().period;
            if self.report_age >= self.registers.report_interval() {
                self.report_age = 0.0;
                self.send(self.report(drive), send);
            }
        }
    }
}

/// Angle within -4 pi to 4 pi.
fn wrapped(angle: Turns) -> Turns {
    let half = FEEDBACK_TURNS / 2;
    Turns::from_bits(angle.to_bits().saturating_add(half).rem_euclid(FEEDBACK_TURNS) - half)
}

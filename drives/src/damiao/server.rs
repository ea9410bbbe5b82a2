//! Drive on the bus.

use super::command::{Mode, Motion, Order};
use super::feedback::{Feedback, Status};
use super::kept::Kept;
use super::mit::Ranges;
use super::parameter::{self, Parameter, Purpose};
use super::register::Register;
use crate::bus::CanServer;
use crate::drive::{Drive, Expiry, Fault, Law, ProfileLimits, SetPoint, Settings, State, Target};
use crate::frame::{Frame, Kind, Send, standard};
use crate::turns::Turns;

/// Bit rates by their code [bit/s].
const BIT_RATES: [u32; 5] = [125_000, 200_000, 250_000, 500_000, 1_000_000];

/// Settings with the maker's behaviour: position by a cascade, no watchdog until the register TIMEOUT is written, a
/// fault when the watchdog expires, the full torque up to the temperature limit, and a winding that is shorted while
/// the drive is disabled.
pub fn settings(settings: Settings) -> Settings {
    Settings {
        law: Law::Cascade,
        watchdog: None,
        expiry: Expiry::Disable,
        derating_temperature: settings.max_temperature,
        brakes_while_disabled: true,
        ..settings
    }
}

/// Damiao drive.
#[derive(Debug, Clone)]
pub struct Server {
    id: u16,
    feedback_id: u16,
    pub(super) kept: Kept,
    /// Angle of the output encoder at the origin.
    pub(super) output_zero: Turns,
    /// Fault of the drive when it was last seen.
    seen: Option<Fault>,
    /// Status of a temperature fault, by the part that was hotter.
    hottest: Status,
}

impl Server {
    /// Drive with its identifier, that of its feedback frames, and the ranges of its motor type. Feedback frames carry
    /// four bits of the identifier: it should be below 16. Identifiers are cut to 11 bits. A drive that is powered up
    /// anew needs a new server.
    pub fn new(id: u16, feedback_id: u16, ranges: Ranges) -> Self {
        Self {
            id: id & 0x7FF,
            feedback_id: feedback_id & 0x7FF,
            kept: Kept::new(ranges),
            output_zero: Turns::ZERO,
            seen: None,
            hottest: Status::MotorOverTemperature,
        }
    }

    /// Identifier of the drive.
    pub fn id(&self) -> u16 {
        self.id
    }

    /// Identifier of feedback frames and answers.
    pub fn feedback_id(&self) -> u16 {
        self.feedback_id
    }

    /// Control mode.
    pub fn mode(&self) -> Mode {
        self.kept.mode
    }

    /// Ranges of the fields in frames.
    pub fn ranges(&self) -> Ranges {
        self.kept.ranges
    }

    /// Bit rate of the bus by the register can_br [bit/s].
    pub fn bit_rate(&self) -> u32 {
        BIT_RATES.get(self.kept.bit_rate as usize).copied().unwrap_or(1_000_000)
    }

    pub(super) fn set_id(&mut self, id: u16) {
        self.id = id;
    }

    pub(super) fn set_feedback_id(&mut self, id: u16) {
        self.feedback_id = id;
    }

    /// Control mode of an identifier; `None` for a frame to another drive.
    fn addressed_mode(&self, id: u16) -> Option<Mode> {
        Mode::ALL.into_iter().find(|mode| id.checked_sub(self.id) == Some(mode.offset()))
    }

    fn handle_control(&self, mode: Mode, data: &[u8]) -> Option<Control> {
        let is_active = mode == self.kept.mode;
        let order = Order::decode(data).filter(|_| is_active || mode == Mode::Impedance).map(Control::Order);
        order.or_else(|| Motion::decode(mode, data, &self.kept.ranges).filter(|_| is_active).map(Control::Motion))
    }

    fn execute(&mut self, control: Control, drive: &mut Drive) {
        drive.feed();
        match control {
            Control::Order(Order::Enable) if drive.state() != State::Enabled => {
                drive.enable(self.set_point(&Motion::zero(self.kept.mode), drive));
            }
            Control::Order(Order::Enable) => {}
            Control::Order(Order::Disable) => drive.disable(),
            Control::Order(Order::SetZero) => self.set_zero(drive),
            Control::Order(Order::ClearError) => drive.clear_fault(),
            Control::Motion(motion) if drive.state() == State::Enabled => {
                drive.enable(self.set_point(&motion, drive));
            }
            Control::Motion(_) => {}
        }
    }

    /// Set-point of a command.
    pub(super) fn set_point(&self, motion: &Motion, drive: &Drive) -> SetPoint {
        let settings = drive.settings();
        let acceleration = self.kept.profile_acceleration();
        let profile = |position: f32, max_velocity: f32| Target {
            limits: ProfileLimits { velocity: max_velocity.abs(), acceleration },
            ..Target::hold(Turns::from_rad(position))
        };
        match *motion {
            Motion::Impedance(command) => command.set_point(),
            Motion::PositionVelocity { position, max_velocity } => SetPoint::Position(profile(position, max_velocity)),
            Motion::Velocity(velocity) => {
                SetPoint::Velocity { velocity, torque: 0.0, max_acceleration: acceleration, max_torque: f32::INFINITY }
            }
            Motion::ForcePosition { position, max_velocity, torque_share } => SetPoint::Position(Target {
                max_torque: torque_share * settings.torque_limit * settings.ratio.to_f32(),
                ..profile(position, max_velocity)
            }),
        }
    }

    /// Makes the present position the origin of both encoders, and the commanded position zero.
    fn set_zero(&mut self, drive: &mut Drive) {
        drive.set_position(Turns::ZERO);
        self.output_zero = drive.feedback().output_position.unwrap_or_default();
        if let Some(mut set_point) = drive.set_point().copied() {
            match &mut set_point {
                SetPoint::Impedance { position, .. } => *position = Turns::ZERO,
                SetPoint::Position(target) => target.position = Turns::ZERO,
                _ => {}
            }
            drive.enable(set_point);
        }
    }

    fn handle_parameter(&mut self, request: Parameter, drive: &mut Drive, send: Send<'_>) {
        drive.feed();
        // A new identifier holds from the next frame on.
        let feedback_id = self.feedback_id;
        let register = Register::from_address(request.address);
        let answer = match request.purpose {
            Purpose::Refresh => return self.send_feedback(drive, send),
            Purpose::Read => register
                .and_then(|register| self.read(register, drive))
                .map(|value| Parameter { value: value.to_bytes(), ..request }),
            Purpose::Write => {
                register.filter(|register| self.write(*register, register.value(request.value), drive)).map(|_| request)
            }
            Purpose::Store => {
                let is_accepted = request.address == parameter::STORE_ALL && drive.state() != State::Enabled;
                is_accepted.then_some(Parameter { value: [0; 4], ..request })
            }
        };
        if let Some(frame) = answer.and_then(|answer| Frame::classic(standard(feedback_id), &answer.encode())) {
            send(frame);
        }
    }

    fn send_feedback(&self, drive: &Drive, send: Send<'_>) {
        let data = Feedback::of(drive, self.id, self.hottest).encode(&self.kept.ranges);
        if let Some(frame) = Frame::classic(standard(self.feedback_id), &data) {
            send(frame);
        }
    }

    /// Notes the part that is the hotter one when a temperature fault appears.
    fn observe(&mut self, drive: &Drive) {
        let fault = drive.fault();
        if fault == Some(Fault::OverTemperature) && self.seen != fault {
            let sensors = &drive.feedback().sensors;
            let is_board = sensors.board_temperature > sensors.motor_temperature;
            self.hottest = if is_board { Status::BoardOverTemperature } else { Status::MotorOverTemperature };
        }
        self.seen = fault;
    }
}

/// Control frame.
enum Control {
    Order(Order),
    Motion(Motion),
}

impl CanServer for Server {
    fn receive(&mut self, frame: &Frame, drive: &mut Drive, send: Send<'_>) {
        self.observe(drive);
        let Some(id) = frame.standard_id().filter(|_| frame.kind == Kind::Classic) else { return };
        if id == parameter::ID {
            if let Some(request) = Parameter::decode(frame.data()).filter(|request| request.id == self.id) {
                self.handle_parameter(request, drive, send);
            }
        } else if let Some(control) = self.addressed_mode(id).and_then(|mode| self.handle_control(mode, frame.data())) {
            self.execute(control, drive);
            self.send_feedback(drive, send);
        }
    }

    fn tick(&mut self, drive: &mut Drive, _send: Send<'_>) {
        self.observe(drive);
    }
}

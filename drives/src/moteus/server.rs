//! Drive on the bus: subframes, the state behind the modes, and the watchdog.

use super::channel::Channel;
use super::command::{Bounds, Command, Context, DEFAULT_TIMEOUT, Defaults, Mode, TIMEOUT_MAX_TORQUE};
use super::register as r;
use super::subframe::{
    Address, BROADCAST, NOT_WRITABLE, Payload, Reader, Registers, Subframe, UNKNOWN_REGISTER, put_subframe, put_value,
};
use super::value::Value;
use crate::bus::CanServer;
use crate::drive::{Drive, Expiry, Fault, Law, SetPoint, Settings, State};
use crate::frame::{Frame, Kind, MAX_DATA, Send};
use crate::turns::{Ratio, Turns};

/// Bus voltage below which the maker's firmware declares a fault [V].
const MIN_VOLTAGE: f32 = 4.0;

/// Number of the diagnostic channel.
const DIAGNOSTIC: u32 = 1;
/// Bytes of a subframe before its text.
const TEXT_OVERHEAD: usize = 3;

/// Settings with the maker's defaults: parallel law, watchdog of 0.1 s with damping, no fault for high speed, least
/// voltage 4 V.
pub fn settings(settings: Settings) -> Settings {
    Settings {
        law: Law::Parallel,
        watchdog: Some(DEFAULT_TIMEOUT),
        expiry: Expiry::Damp,
        expiry_torque: TIMEOUT_MAX_TORQUE,
        overspeed: f32::INFINITY,
        min_voltage: MIN_VOLTAGE,
        ..settings
    }
}

/// Reference of the position, as register 0x00c reports it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum HomeState {
    #[default]
    Relative,
    Rotor,
    Output,
}

/// Drive on the bus.
#[derive(Debug, Clone)]
pub struct Server {
    id: u8,
    prefix: u16,
    pub(super) command: Command,
    /// True between the write of a mode and the end of the frame.
    is_commanded: bool,
    /// Mode of the last command that the drive follows.
    active: Mode,
    /// Mode after the last frame or period.
    last_mode: Mode,
    pub(super) home: HomeState,
    pub(super) bounds: Bounds,
    pub(super) defaults: Defaults,
    pub(super) channel: Channel,
    pub(super) milliseconds: u32,
    /// Part of a millisecond that is not counted yet [ms].
    rest: f32,
    pub(super) clock_trim: i32,
}

/// Further course of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Flow {
    /// Next subframe.
    Continue,
    /// The rest of the frame is not read.
    End,
    /// The frame is for another drive.
    Discard,
}

impl Server {
    /// Drive with an identifier from 1 to 126, without a prefix.
    pub fn new(id: u8) -> Self {
        Self {
            id: id & 0x7f,
            prefix: 0,
            command: Command::default(),
            is_commanded: false,
            active: Mode::Stopped,
            last_mode: Mode::Stopped,
            home: HomeState::Relative,
            bounds: (None, None),
            defaults: Defaults::default(),
            channel: Channel::default(),
            milliseconds: 0,
            rest: 0.0,
            clock_trim: 0,
        }
    }

    /// Drive that answers to a prefix of 13 bits in the identifiers.
    pub fn with_prefix(self, prefix: u16) -> Self {
        Self { prefix: prefix & 0x1fff, ..self }
    }

    /// Identifier.
    pub fn id(&self) -> u8 {
        self.id
    }

    pub(super) fn set_id(&mut self, id: u8) {
        self.id = id;
    }

    /// Prefix of the identifiers.
    pub fn prefix(&self) -> u16 {
        self.prefix
    }

    /// Mode that the drive reports.
    pub fn mode(&self, drive: &Drive) -> Mode {
        match (drive.fault(), drive.state()) {
            (Some(Fault::Watchdog), _) | (None, State::TimedOut) => Mode::Timeout,
            (Some(_), _) => Mode::Fault,
            (None, State::Disabled) => Mode::Stopped,
            (None, State::Calibrating(_)) => Mode::Calibrating,
            (None, State::Enabled) => match drive.set_point() {
                Some(SetPoint::Brake) => Mode::Brake,
                Some(SetPoint::Torque { .. }) => Mode::Current,
                Some(SetPoint::Within { .. }) => Mode::StayWithin,
                _ if self.active == Mode::ZeroVelocity => Mode::ZeroVelocity,
                _ => Mode::Position,
            },
        }
    }

    /// Reads and answers the subframes of a frame.
    fn process(&mut self, data: &[u8], drive: &mut Drive, mut reply: Option<&mut Payload>) -> Flow {
        let mut reader = Reader::new(data);
        while let Some(subframe) = reader.subframe() {
            let flow = match subframe {
                Subframe::Write(registers) => self.write_all(registers, &mut reader, drive, reply.as_deref_mut()),
                Subframe::Read(registers) => match reply.as_deref_mut() {
                    Some(reply) => self.read_all(registers, drive, reply),
                    None => Flow::Continue,
                },
                Subframe::ToServer(DIAGNOSTIC, text) => {
                    self.read_text(text, drive);
                    reply.as_deref_mut().map_or(Flow::Continue, |reply| self.write_text(MAX_DATA, reply))
                }
                Subframe::Poll(DIAGNOSTIC, most) => {
                    reply.as_deref_mut().map_or(Flow::Continue, |reply| self.write_text(most as usize, reply))
                }
                _ => Flow::End,
            };
            if flow != Flow::Continue {
                return flow;
            }
        }
        Flow::End
    }

    /// Answers with up to `most` bytes of the diagnostic channel.
    #[inline(never)]
    fn write_text(&mut self, most: usize, reply: &mut Payload) -> Flow {
        let room = reply.capacity().saturating_sub(reply.len() + TEXT_OVERHEAD);
        let text = self.channel.take(most.min(room));
        flow_of(put_subframe(reply, Subframe::ToClient(DIAGNOSTIC, &text)))
    }

    fn write_all(
        &mut self,
        registers: Registers,
        reader: &mut Reader<'_>,
        drive: &mut Drive,
        mut reply: Option<&mut Payload>,
    ) -> Flow {
        for offset in 0..registers.count {
            // Ends with the data at the latest.
            let Some(value) = reader.value(registers.resolution) else {
                return Flow::End;
            };
            let register = registers.first.wrapping_add(offset);
            if is_foreign(register, value, self.uuid()) {
                return Flow::Discard;
            }
            if let Err(error) = self.write(register, value, drive)
                && let Some(reply) = reply.as_deref_mut()
                && put_subframe(reply, Subframe::WriteError(register, error)).is_none()
            {
                return Flow::End;
            }
        }
        Flow::Continue
    }

    /// Writes a register; returns the error of the protocol.
    fn write(&mut self, register: u32, value: Value, drive: &mut Drive) -> Result<(), u32> {
        let field = r::describe(register).ok_or(UNKNOWN_REGISTER)?;
        if !field.access.is_writable() {
            return Err(NOT_WRITABLE);
        }
        let number = value.number(field.scale);
        match register {
            r::MODE => {
                let mode = Mode::from_number(value.integer()).ok_or(UNKNOWN_REGISTER)?;
                self.command = Command { mode, ..Command::default() };
                self.is_commanded = true;
            }
            r::SET_OUTPUT_NEAREST => self.set_output(nearest(drive, Turns::new(number)), drive),
            r::SET_OUTPUT_EXACT => self.set_output(Turns::new(number), drive),
            r::REQUIRE_REINDEX => {
                self.home = HomeState::Relative;
                self.find_home(drive);
            }
            r::RECAPTURE => self.recapture(drive),
            r::CLOCK_TRIM => self.clock_trim = value.integer(),
            _ => {
                self.command.write(register, value);
            }
        }
        Ok(())
    }

    fn read_all(&self, registers: Registers, drive: &Drive, reply: &mut Payload) -> Flow {
        let start = reply.len();
        if put_subframe(reply, Subframe::Reply(registers)).is_none() {
            reply.truncate(start);
            return Flow::End;
        }
        for offset in 0..registers.count {
            // Ends with the room in the answer at the latest.
            let register = registers.first.wrapping_add(offset);
            let Some(value) = self.read(register, registers.resolution, drive) else {
                reply.truncate(start);
                let error = Subframe::ReadError(register, UNKNOWN_REGISTER);
                if put_subframe(reply, error).is_none() {
                    reply.truncate(start);
                }
                return Flow::End;
            };
            if put_value(reply, value).is_none() {
                reply.truncate(start);
                return Flow::End;
            }
        }
        Flow::Continue
    }

    /// Follows the command of a frame.
    fn execute(&mut self, drive: &mut Drive) {
        let (before, mode) = (self.mode(drive), self.command.mode);
        if mode == Mode::Stopped {
            drive.disable();
            drive.clear_fault();
            return;
        }
        // Fault and timeout last until the command to stop.
        if !mode.is_command() || matches!(before, Mode::Fault | Mode::Timeout) {
            return;
        }
        if mode == Mode::Timeout {
            drive.expire();
            return;
        }
        let is_new = before != mode;
        if is_new && mode.is_supervised() && !self.command.ignores_bounds && is_outside(drive, self.bounds) {
            drive.declare(Fault::OutsideTravel);
            return;
        }
        self.active = mode;
        let command = self.command;
        self.enable(&command, is_new, drive);
    }

    fn enable(&mut self, command: &Command, is_new: bool, drive: &mut Drive) {
        let context = Context { defaults: self.defaults, bounds: self.bounds, is_new };
        match command.set_point(drive, &context) {
            Ok(set_point) => {
                if is_new {
                    // Integral and profile begin anew.
                    drive.disable();
                }
                drive.set_watchdog(command.watchdog(&self.defaults));
                drive.enable(set_point);
            }
            Err(fault) => drive.declare(fault),
        }
    }

    /// Begins the control at the sensed position.
    fn recapture(&mut self, drive: &mut Drive) {
        if self.mode(drive) == Mode::Position {
            let command = Command { position: f32::NAN, ..self.command };
            self.enable(&command, true, drive);
        }
    }

    /// Sets the position, and moves the target with it.
    fn set_output(&mut self, position: Turns, drive: &mut Drive) {
        let shift = position.minus(drive.feedback().position);
        let set_point = drive.set_point().copied();
        drive.set_position(position);
        self.home = HomeState::Output;
        if let Some(SetPoint::Position(mut target)) = set_point {
            target.position = target.position.plus(shift);
            target.stop = target.stop.map(|stop| stop.plus(shift));
            drive.enable(SetPoint::Position(target));
        }
    }

    /// Position as after power-up, once the motor encoder has a reading.
    fn find_home(&mut self, drive: &mut Drive) {
        if self.home != HomeState::Relative {
            return;
        }
        if let Some((position, home)) = absolute_position(drive) {
            self.set_output(position, drive);
            self.home = home;
        }
    }

    /// Takes over the travel of the drive: the maker's drive limits the target, and tests the position at a start only.
    fn take_over_travel(&mut self, drive: &mut Drive) {
        let travel = &mut drive.settings_mut().travel;
        if *travel != (None, None) {
            self.bounds = *travel;
            *travel = (None, None);
        }
    }

    fn count_time(&mut self, period: f32) {
        self.rest += 1000.0 * period;
        let whole = self.rest as u32;
        self.milliseconds = self.milliseconds.wrapping_add(whole);
        self.rest -= whole as f32;
    }
}

impl CanServer for Server {
    fn receive(&mut self, frame: &Frame, drive: &mut Drive, send: Send<'_>) {
        let address = Address::of(frame);
        let is_own = address.destination == self.id || address.destination == BROADCAST;
        if !is_own || address.prefix != self.prefix || frame.kind == Kind::Remote {
            return;
        }
        self.take_over_travel(drive);
        self.is_commanded = false;
        let mut payload = Payload::new();
        let flow = self.process(frame.data(), drive, address.wants_reply.then_some(&mut payload));
        if flow != Flow::Discard {
            if address.wants_reply {
                answer(self.id, address, frame.kind, &payload).into_iter().for_each(send);
            }
            // The answers show the state before the command, as those of the maker's firmware.
            if self.is_commanded {
                self.execute(drive);
            }
        }
        self.last_mode = self.mode(drive);
    }

    fn tick(&mut self, drive: &mut Drive, _: Send<'_>) {
        self.take_over_travel(drive);
        self.count_time(drive.settings().period);
        self.find_home(drive);
        // The maker's drive tests voltage and temperature only while it is not stopped.
        if self.last_mode == Mode::Stopped && matches!(drive.fault(), Some(Fault::OverVoltage | Fault::OverTemperature))
        {
            drive.clear_fault();
        }
        self.last_mode = self.mode(drive);
    }
}

/// The frame goes on while the answer has room.
fn flow_of(put: Option<()>) -> Flow {
    if put.is_some() { Flow::Continue } else { Flow::End }
}

/// Answer to a frame, of its kind where the length permits.
fn answer(id: u8, asked: Address, kind: Kind, payload: &[u8]) -> Option<Frame> {
    let address = Address { source: id, wants_reply: false, destination: asked.source, ..asked };
    match kind {
        Kind::Classic if payload.len() <= 8 => Frame::classic(address.id(), payload),
        kind => address.frame(payload, kind == Kind::Flexible(true)),
    }
}

/// True for a mask of another drive's UUID.
fn is_foreign(register: u32, value: Value, uuid: [i32; 4]) -> bool {
    let word = register.checked_sub(r::UUID_MASK_1).and_then(|index| uuid.get(index as usize));
    word.is_some_and(|word| *word != value.integer())
}

fn is_outside(drive: &Drive, (low, high): Bounds) -> bool {
    let position = drive.feedback().position;
    low.is_some_and(|low| position < low) || high.is_some_and(|high| position > high)
}

/// Position by the encoders alone, within half a turn of the output encoder, or of the rotor without one.
fn absolute_position(drive: &Drive) -> Option<(Turns, HomeState)> {
    let feedback = drive.feedback();
    let is_missing = |has_encoder: bool, counts: Option<u32>| has_encoder && counts.is_none();
    let sensors = &feedback.sensors;
    if is_missing(true, sensors.motor_counts)
        || is_missing(drive.settings().output_counts_per_turn.is_some(), sensors.output_counts)
    {
        return None;
    }
    Some(match feedback.output_position {
        Some(output) => (within_half_turn(output), HomeState::Output),
        None => (within_half_turn(feedback.motor_position).over(drive.settings().ratio), HomeState::Rotor),
    })
}

/// Position next to `wanted` that the encoders permit: whole turns of the output away from its encoder's reading, or
/// whole turns of the rotor without an output encoder.
fn nearest(drive: &Drive, wanted: Turns) -> Turns {
    let Some((home, reference)) = absolute_position(drive) else {
        return wanted;
    };
    let ratio = if reference == HomeState::Output { Ratio::ONE } else { drive.settings().ratio };
    let away = wanted.minus(home).times(ratio);
    let whole = away.minus(within_half_turn(away));
    home.plus(whole.over(ratio))
}

/// Angle less whole turns, from -1/2 to 1/2.
fn within_half_turn(angle: Turns) -> Turns {
    Turns::from_bits((angle.to_bits() as i32).into())
}

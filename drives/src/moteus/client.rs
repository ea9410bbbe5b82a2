//! Commands to a drive and its answers.

use super::command::Mode;
use super::register as r;
use super::subframe::{Address, BROADCAST, Payload, Reader, Registers, Subframe, put_subframe, put_value};
use super::value::{Content, Resolution, Value};
use crate::frame::{Frame, Kind};

/// Registers to read from the first number on; `None` leaves a register out.
pub type Block = (u32, &'static [Option<Resolution>]);

const INT8: Option<Resolution> = Some(Resolution::Int8);
const FLOAT: Option<Resolution> = Some(Resolution::Float);

/// Default query of the maker's clients: mode, position, speed and torque; voltage, temperature and fault.
pub const DEFAULT_QUERY: &[Block] = &[(r::MODE, &[INT8, FLOAT, FLOAT, FLOAT]), (r::VOLTAGE, &[INT8; 3])];

/// Query of both encoders, each with its position and speed.
pub const ENCODER_QUERY: &[Block] = &[(r::ENCODER_0_POSITION, &[FLOAT; 4]), (r::ENCODER_VALIDITY, &[INT8])];

/// Command of the position mode; values left out have the drive's defaults.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PositionCommand {
    /// Position [turns]; NaN for the present one.
    pub position: Option<f32>,
    /// Speed [turns/s].
    pub velocity: Option<f32>,
    /// Feed-forward torque [N m].
    pub torque: Option<f32>,
    /// Factor on the stiffness [-].
    pub kp_scale: Option<f32>,
    /// Factor on the damping [-].
    pub kd_scale: Option<f32>,
    /// Largest torque [N m].
    pub max_torque: Option<f32>,
    /// Position at which the motion stops [turns].
    pub stop_position: Option<f32>,
    /// Watchdog [s]: NaN for none.
    pub timeout: Option<f32>,
    /// Largest speed [turns/s]: negative for none.
    pub velocity_limit: Option<f32>,
    /// Largest acceleration [turns/s^2]: negative for none.
    pub accel_limit: Option<f32>,
    /// Factor on the limit of the integral [-].
    pub ilimit_scale: Option<f32>,
    /// True to ignore the position bounds.
    pub ignores_bounds: Option<bool>,
}

/// Command of the mode stay within; values left out have the drive's defaults.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WithinCommand {
    /// Lower bound [turns]; NaN for none.
    pub low: Option<f32>,
    /// Upper bound [turns]; NaN for none.
    pub high: Option<f32>,
    /// Feed-forward torque [N m].
    pub torque: Option<f32>,
    /// Factor on the stiffness [-].
    pub kp_scale: Option<f32>,
    /// Factor on the damping [-].
    pub kd_scale: Option<f32>,
    /// Largest torque [N m].
    pub max_torque: Option<f32>,
    /// Watchdog [s]: NaN for none.
    pub timeout: Option<f32>,
    /// Factor on the limit of the integral [-].
    pub ilimit_scale: Option<f32>,
    /// True to ignore the position bounds.
    pub ignores_bounds: Option<bool>,
}

/// Data of a request. A subframe for which there is no room is left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request(Payload);

impl Request {
    /// Command of a mode without further registers.
    pub fn mode(mode: Mode) -> Self {
        Self::default().write(r::MODE, Content::Integer(mode as i32), Resolution::Int8)
    }

    /// Command to stop, which clears a fault and a timeout.
    pub fn stop() -> Self {
        Self::mode(Mode::Stopped)
    }

    /// Command to short the phases.
    pub fn brake() -> Self {
        Self::mode(Mode::Brake)
    }

    /// Command to damp, with a factor on the damping.
    pub fn zero_velocity(kd_scale: Option<f32>) -> Self {
        Self::mode(Mode::ZeroVelocity).write_block(r::COMMAND_KD_SCALE, &[kd_scale])
    }

    /// Command of a position.
    pub fn position(command: &PositionCommand) -> Self {
        let c = command;
        Self::mode(Mode::Position).write_block(
            r::COMMAND_POSITION,
            &[
                c.position,
                c.velocity,
                c.torque,
                c.kp_scale,
                c.kd_scale,
                c.max_torque,
                c.stop_position,
                c.timeout,
                c.velocity_limit,
                c.accel_limit,
                None,
                c.ilimit_scale,
                None,
                c.ignores_bounds.map(flag),
            ],
        )
    }

    /// Command of a position within bounds.
    pub fn stay_within(command: &WithinCommand) -> Self {
        let c = command;
        let ignores_bounds = c.ignores_bounds.map(flag);
        Self::mode(Mode::StayWithin).write_block(
            r::WITHIN_LOW,
            &[c.low, c.high, c.torque, c.kp_scale, c.kd_scale, c.max_torque, c.timeout, c.ilimit_scale, ignores_bounds],
        )
    }

    /// Command of the torque-producing and flux-producing current [A].
    pub fn current(q: f32, d: f32) -> Self {
        Self::mode(Mode::Current).write_block(r::COMMAND_Q_CURRENT, &[Some(q), Some(d)])
    }

    /// Request to set the turn nearest to a position [turns].
    pub fn set_output_nearest(position: f32) -> Self {
        Self::default().write_block(r::SET_OUTPUT_NEAREST, &[Some(position)])
    }

    /// Request to set the position [turns].
    pub fn set_output_exact(position: f32) -> Self {
        Self::default().write_block(r::SET_OUTPUT_EXACT, &[Some(position)])
    }

    /// Request to set the position as after power-up.
    pub fn require_reindex() -> Self {
        Self::default().write(r::REQUIRE_REINDEX, Content::Integer(1), Resolution::Int8)
    }

    /// Request to begin the control at the sensed position.
    pub fn recapture() -> Self {
        Self::default().write(r::RECAPTURE, Content::Integer(1), Resolution::Int8)
    }

    /// Adds the write of a register; an unknown register is left out.
    pub fn write(mut self, register: u32, content: Content, resolution: Resolution) -> Self {
        let start = self.0.len();
        let put = r::describe(register).and_then(|field| {
            put_subframe(&mut self.0, Subframe::Write(Registers::new(resolution, register, 1)))?;
            put_value(&mut self.0, Value::new(content, field.scale, resolution))
        });
        if put.is_none() {
            self.0.truncate(start);
        }
        self
    }

    /// Adds the write of floats to consecutive registers; those without a value are left out.
    fn write_block(mut self, first: u32, numbers: &[Option<f32>]) -> Self {
        for (offset, run) in runs(numbers, |number, next| number.is_some() == next.is_some()) {
            if run.first().is_some_and(Option::is_some) {
                let registers = Registers::new(Resolution::Float, first + offset, run.len() as u32);
                let start = self.0.len();
                let put = put_subframe(&mut self.0, Subframe::Write(registers));
                let mut values = run.iter().flatten().map(|number| Value::Float(*number));
                if put.and_then(|()| values.try_for_each(|value| put_value(&mut self.0, value))).is_none() {
                    self.0.truncate(start);
                }
            }
        }
        self
    }

    /// Adds a query of blocks of registers.
    pub fn query(self, blocks: &[Block]) -> Self {
        blocks.iter().fold(self, |request, (first, resolutions)| request.read_block(*first, resolutions))
    }

    fn read_block(mut self, first: u32, resolutions: &[Option<Resolution>]) -> Self {
        for (offset, run) in runs(resolutions, |resolution, next| resolution == next) {
            if let Some(Some(resolution)) = run.first() {
                let registers = Registers::new(*resolution, first + offset, run.len() as u32);
                // A full frame leaves the rest out.
                let _ = put_subframe(&mut self.0, Subframe::Read(registers));
            }
        }
        self
    }

    /// Data of the request.
    pub fn data(&self) -> &[u8] {
        &self.0
    }
}

/// Client of one drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Client {
    /// Identifier of the client.
    pub source: u8,
    /// Identifier of the drive.
    pub destination: u8,
    /// Prefix of the identifiers.
    pub prefix: u16,
}

impl Client {
    /// Client 0 of a drive, without a prefix.
    pub fn new(destination: u8) -> Self {
        Self { source: 0, destination, prefix: 0 }
    }

    /// Frame of a request; `wants_reply` asks for an answer.
    pub fn frame(&self, request: &Request, wants_reply: bool) -> Option<Frame> {
        let address = Address { source: self.source, wants_reply, destination: self.destination, prefix: self.prefix };
        address.frame(request.data(), true)
    }

    /// Answers in a frame of the drive; `None` for another frame.
    pub fn answers<'f>(&self, frame: &'f Frame) -> Option<Answers<'f>> {
        let address = Address::of(frame);
        let is_own = address.prefix == self.prefix
            && address.destination == self.source
            && (address.source == self.destination || self.destination == BROADCAST);
        (is_own && frame.kind != Kind::Remote).then(|| Answers { reader: Reader::new(frame.data()), registers: None })
    }
}

/// Answer of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer<'f> {
    /// Register and its value.
    Value(u32, Value),
    /// Register that could not be written, and the error.
    WriteError(u32, u32),
    /// Register that could not be read, and the error.
    ReadError(u32, u32),
    /// Bytes of a diagnostic channel.
    Diagnostic(u32, &'f [u8]),
}

/// Answers in a frame, in the order of the frame. Ends at a malformed subframe.
#[derive(Debug, Clone)]
pub struct Answers<'f> {
    reader: Reader<'f>,
    /// Registers whose values are still to be read.
    registers: Option<Registers>,
}

impl Answers<'_> {
    /// Physical quantity of a register; NaN for a register of another kind, `None` for one that is not in the frame.
    pub fn number(&self, register: u32) -> Option<f32> {
        let scale = r::describe(register)?.scale;
        self.value(register).map(|value| if scale.is_number() { value.number(scale) } else { f32::NAN })
    }

    /// Content of an integer register; `None` for one that is not in the frame.
    pub fn integer(&self, register: u32) -> Option<i32> {
        self.value(register).map(Value::integer)
    }

    fn value(&self, register: u32) -> Option<Value> {
        self.clone().find_map(|answer| match answer {
            Answer::Value(found, value) if found == register => Some(value),
            _ => None,
        })
    }
}

impl<'f> Iterator for Answers<'f> {
    type Item = Answer<'f>;

    fn next(&mut self) -> Option<Answer<'f>> {
        // Each turn reads at least a byte.
        loop {
            if let Some(registers) = self.registers.filter(|registers| registers.count > 0) {
                let next = registers.first.wrapping_add(1);
                self.registers = Some(Registers { count: registers.count - 1, first: next, ..registers });
                return Some(Answer::Value(registers.first, self.reader.value(registers.resolution)?));
            }
            match self.reader.subframe()? {
                Subframe::Reply(registers) => self.registers = Some(registers),
                Subframe::WriteError(register, error) => return Some(Answer::WriteError(register, error)),
                Subframe::ReadError(register, error) => return Some(Answer::ReadError(register, error)),
                Subframe::ToClient(channel, bytes) => return Some(Answer::Diagnostic(channel, bytes)),
                _ => return None,
            }
        }
    }
}

fn flag(is_set: bool) -> f32 {
    if is_set { 1.0 } else { 0.0 }
}

/// Runs of items alike, each with the offset of its first item.
fn runs<T>(items: &[T], is_alike: impl Fn(&T, &T) -> bool) -> impl Iterator<Item = (u32, &[T])> {
    items.chunk_by(is_alike).scan(0, |offset, run| {
        let first = *offset;
        *offset += run.len() as u32;
        Some((first, run))
    })
}

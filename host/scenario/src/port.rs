//! The seam between a run and observer with compensation: samples and set-points in, estimates and shaped set-points
//! out, once a control period. Here it is served on the host; a board serves the same trait over its line.

use std::f64::consts::TAU;

use model_core::compensation::{self, Command, ImpedancePoint, Position};
use model_core::controller::{self, Controller};
use model_core::numbers::Real;
use model_core::observer::{Memory, Reading, Samples};
use reference::closed_loop::{Motion, SetPoint};

use super::case::Designed;
use super::faults::{ControllerInputs, TimedReading};
use report::failure::{Failure, Outcome};

/// The answer of one control period.
pub type Answer = controller::Answer<f32>;

/// Observer and compensation, wherever they run.
pub trait ControllerPort {
    /// One control period.
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Outcome<Answer>;

    /// One control period of a width probe.
    fn probe(&mut self, samples: &Samples<f32>) -> Outcome<Answer>;

    /// Keeps what has been learnt, and begins anew from it: says what that is.
    fn restart_from_memory(&mut self) -> Outcome<Memory>;

    /// What has been learnt, as a board keeps it; `None` where it is elsewhere.
    fn memory(&self) -> Option<Memory> {
        None
    }
}

/// Observer and compensation in this process: the very code that a board runs.
#[derive(Debug)]
pub struct HostPort<'t>(Controller<'t, f32>);

impl<'t> HostPort<'t> {
    /// Both as they are after a reset.
    pub fn new(designed: &'t Designed) -> Self {
        let Designed { observer, compensation, probe, .. } = designed;
        Self(Controller::new(observer, compensation).with_probe(probe.as_ref()))
    }
}

impl ControllerPort for HostPort<'_> {
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Outcome<Answer> {
        Ok(self.0.step(samples, command))
    }

    fn probe(&mut self, samples: &Samples<f32>) -> Outcome<Answer> {
        Ok(self.0.probe(samples))
    }

    fn restart_from_memory(&mut self) -> Outcome<Memory> {
        remember(&mut self.0)
    }

    fn memory(&self) -> Option<Memory> {
        Some(self.0.save())
    }
}

/// A controller's start from what it has learnt, as a board has it after a reset.
pub fn remember(controller: &mut Controller<'_, f32>) -> Outcome<Memory> {
    let memory = controller.save();
    controller.reset();
    controller
        .load(&memory)
        .map_err(|error| Failure::check_failed(format!("what was learnt is not taken back: {error}")))?;
    Ok(memory)
}

/// Converts a run's numbers (f64, radians, counts) to those of the port (f32, turns).
#[derive(Debug, Clone)]
pub struct Translator {
    /// Clock ticks in a control period.
    ticks: u32,
    /// Raw counts before they wrap: motor, output.
    ranges: [i64; 2],
    /// Turn of the output encoder's first reading, which is the observer's turn zero.
    first_turn: Option<i32>,
    torque: f32,
}

impl Translator {
    /// For encoders of so many bits.
    pub fn new(ticks: u32, bits: [u32; 2]) -> Self {
        Self { ticks, ranges: bits.map(|bits| 1 << bits), first_turn: None, torque: 0.0 }
    }

    /// For set-points alone, whose observer counts the link's turns from this one.
    pub fn from_turn(ticks: u32, first_turn: i32) -> Self {
        Self { first_turn: Some(first_turn), ..Self::new(ticks, [0, 0]) }
    }

    /// The next reading is the first again.
    pub fn reset(&mut self) {
        (self.first_turn, self.torque) = (None, 0.0);
    }

    /// Readings with their own times; the torque is that of the period before.
    pub fn samples(&mut self, seen: &ControllerInputs) -> Samples<f32> {
        if let (None, Some(first)) = (self.first_turn, seen.output) {
            self.first_turn = Some(first.counts.div_euclid(self.ranges[1]) as i32);
        }
        let time = |period: u64| (period as u32).wrapping_mul(self.ticks);
        let reading = |frame: TimedReading, range: i64| Reading {
            counts: frame.counts.rem_euclid(range) as u32,
            time: time(frame.period),
        };
        Samples {
            time: time(seen.period),
            motor: reading(seen.motor, self.ranges[0]),
            output: seen.output.map(|frame| reading(frame, self.ranges[1])),
            torque: self.torque,
        }
    }

    /// A set-point on the scale of the observer's link shaft, its angles in whole turns and the rest.
    pub fn command(&self, set_point: &SetPoint) -> Command<f32> {
        command(set_point, self.first_turn.unwrap_or(0))
    }

    /// Remembers the torque that the observer is shown next.
    pub fn note(&mut self, torque: f32) {
        self.torque = torque;
    }
}

/// A set-point as the compensation takes it, turns counted from one of them.
pub fn command<T: Real>(set_point: &SetPoint, first_turn: i32) -> Command<T> {
    let motion = |of: Motion| motion(of, first_turn);
    match *set_point {
        SetPoint::Position { now, ahead } => Command::Position { now: motion(now), ahead: ahead.map(motion) },
        SetPoint::Impedance { about, torque, stiffness, damping } => {
            let compensation::Motion { position, speed, .. } = motion(about);
            Command::Impedance(ImpedancePoint {
                position,
                speed,
                torque: T::from_f64(torque),
                stiffness: T::from_f64(stiffness),
                damping: T::from_f64(damping),
            })
        }
    }
}

/// An angle as whole turns and the rest.
pub fn position<T: Real>(angle: f64, first_turn: i32) -> Position<T> {
    let turns = (angle / TAU).floor();
    Position { turns: turns as i32 - first_turn, fraction: T::from_f64(angle / TAU - turns) }
}

fn motion<T: Real>(of: Motion, first_turn: i32) -> compensation::Motion<T> {
    compensation::Motion {
        position: position(of.position, first_turn),
        speed: T::from_f64(of.speed),
        acceleration: T::from_f64(of.acceleration),
    }
}

//! Interface between a run and observer with compensation: samples and set-points in, estimates and torque out, once a
//! control period. `HostPort` implements it on the host; a board implements it over its line.

use std::f64::consts::TAU;

use model_core::compensation::{self, Command, ImpedancePoint, Position};
use model_core::controller::{self, Controller};
use model_core::numbers::Real;
use model_core::observer::{Memory, Reading, Samples};
use reference::closed_loop::{Motion, SetPoint};

use super::case::Designed;
use super::encoder_zeros::EncoderZeros;
use super::faults::{ControllerInputs, LATENESS_PARTS, TimedReading};
use report::failure::{Failure, Outcome};

/// Answer of one control period.
pub type Answer = controller::Answer<f32>;

/// Observer and compensation, on the host or on a board.
pub trait ControllerPort {
    /// Runs one control period.
    fn exchange(&mut self, samples: &Samples<f32>, command: &Command<f32>) -> Outcome<Answer>;

    /// Runs one control period of a width probe.
    fn probe(&mut self, samples: &Samples<f32>) -> Outcome<Answer>;

    /// Restarts from the estimated parameters; returns their memory.
    fn restart_from_memory(&mut self) -> Outcome<Memory>;

    /// Memory of the estimated parameters; `None` if the observer runs elsewhere.
    fn memory(&self) -> Option<Memory> {
        None
    }
}

/// Observer and compensation in this process, with the code of a board.
#[derive(Debug)]
pub struct HostPort<'t>(Controller<'t, f32>);

impl<'t> HostPort<'t> {
    /// State after a reset.
    pub fn new(designed: &'t Designed) -> Self {
        let Designed { observer, compensation, probe, .. } = designed;
        Self(Controller::with_tables(observer, compensation).with_probe(probe.as_ref()))
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
        restart_from_memory(&mut self.0)
    }

    fn memory(&self) -> Option<Memory> {
        Some(self.0.save())
    }
}

/// Restarts a controller from its estimated parameters, as a board does after a reset.
pub fn restart_from_memory(controller: &mut Controller<'_, f32>) -> Outcome<Memory> {
    let memory = controller.save();
    controller.reset();
    controller
        .load(&memory)
        .map_err(|error| Failure::check_failed(format!("the saved memory is not accepted: {error}")))?;
    Ok(memory)
}

/// Converts a run's numbers (f64, radians, counts) to those of the port (f32, turns).
#[derive(Debug, Clone)]
pub struct Translator {
    /// Clock ticks in a control period.
    ticks: u32,
    /// Counts per turn of motor and output encoder.
    ranges: [i64; 2],
    /// Raw counts at the start of the joint: motor, output.
    zeros: [i64; 2],
    /// Whether the observer reads the output encoder. Without it, its angle of the link counts from the start.
    reads_output: bool,
    /// Turn of the output encoder's first reading, the observer's turn zero.
    first_turn: Option<i32>,
    torque: f32,
}

impl Translator {
    /// Translator for encoders with the given counts per turn and zeros, and an observer that reads the output or not.
    pub fn new(ticks: u32, counts_per_turn: [u64; 2], zeros: &EncoderZeros, reads_output: bool) -> Self {
        let ranges = counts_per_turn.map(u64::cast_signed);
        Self { ticks, ranges, zeros: zeros.counts(ranges), reads_output, first_turn: None, torque: 0.0 }
    }

    /// Treats the next reading as the first again.
    pub fn reset(&mut self) {
        (self.first_turn, self.torque) = (None, 0.0);
    }

    /// Samples with the times of their readings and the torque of the previous period.
    pub fn samples(&mut self, seen: &ControllerInputs) -> Samples<f32> {
        let raw = |frame: TimedReading, encoder: usize| frame.counts + self.zeros[encoder];
        if let (None, Some(first)) = (self.first_turn, seen.output) {
            self.first_turn = Some(raw(first, 1).div_euclid(self.ranges[1]) as i32);
        }
        let time = |period: u64, lateness: u32| {
            (period as u32).wrapping_mul(self.ticks).wrapping_add(lateness * self.ticks / LATENESS_PARTS)
        };
        let reading = |frame: TimedReading, encoder: usize| Reading {
            counts: raw(frame, encoder).rem_euclid(self.ranges[encoder]) as u32,
            time: time(frame.period, frame.lateness),
        };
        Samples {
            time: time(seen.period, seen.lateness),
            motor: reading(seen.motor, 0),
            output: seen.output.map(|frame| reading(frame, 1)),
            torque: self.torque,
        }
    }

    /// Set-point on the scale of the observer's link shaft, with angles as whole turns and fraction.
    pub fn command(&self, set_point: &SetPoint) -> Command<f32> {
        let of_output = self.zeros[1] as f64 / self.ranges[1] as f64 - f64::from(self.first_turn.unwrap_or(0));
        command(set_point, if self.reads_output { of_output } else { 0.0 })
    }

    /// Stores the torque for the observer's next samples.
    pub fn note(&mut self, torque: f32) {
        self.torque = torque;
    }
}

/// Set-point for the compensation, on a scale that reads `zero` at angle zero [turns].
pub fn command<T: Real>(set_point: &SetPoint, zero: f64) -> Command<T> {
    let motion = |of: Motion| motion(of, zero);
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

/// Angle as whole turns and fraction, on a scale that reads `zero` at angle zero [turns].
pub fn position<T: Real>(angle: f64, zero: f64) -> Position<T> {
    let place = angle / TAU + zero;
    let turns = place.floor();
    Position { turns: turns as i32, fraction: T::from_f64(place - turns) }
}

fn motion<T: Real>(of: Motion, zero: f64) -> compensation::Motion<T> {
    compensation::Motion {
        position: position(of.position, zero),
        speed: T::from_f64(of.speed),
        acceleration: T::from_f64(of.acceleration),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_period_has_time_of_start() {
        let frame = TimedReading { counts: 0, period: 7, lateness: 42 };
        let seen = ControllerInputs { period: 7, lateness: 42, motor: frame, output: Some(frame) };
        let samples = Translator::new(1000, [14, 17], &EncoderZeros::default(), true).samples(&seen);
        let times = (samples.time, samples.motor.time, samples.output.map(|reading| reading.time));
        assert_eq!(times, (7042, 7042, Some(7042)));
    }

    /// The start is angle zero of an observer without the output encoder, wherever the encoders are mounted.
    #[test]
    fn unread_output_encoder_moves_no_set_point() {
        let set_point = SetPoint::Position { now: Motion { position: 0.25 * TAU, ..Motion::default() }, ahead: None };
        let place = |reads_output| {
            let translator = Translator::new(1000, [1 << 14, 1 << 17], &EncoderZeros::draw(1), reads_output);
            let Command::Position { now, .. } = translator.command(&set_point) else { panic!("a position") };
            (now.position.turns, now.position.fraction)
        };
        assert_eq!(place(false), (0, 0.25));
        assert_ne!(place(true), (0, 0.25));
    }
}

//! Wire form of the messages between a motor controller and observer with compensation: samples and set-points here,
//! answers in `answer`. Times are ticks of the samples' clock; every field is SI.

mod answer;

pub use answer::{Answered, WireEstimate, WireEstimates, WireProbed, WireShaped};
use model_core::compensation::{self, ImpedancePoint, Position};
use model_core::observer::{Reading, Samples};
use serde::{Deserialize, Serialize};

/// Most exchanges in one schedule; an exchange is one control period.
pub const EXCHANGES_PER_SCHEDULE: usize = 4;

/// Samples and set-point of one control period of a motor controller.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Exchange {
    /// Number of the control period, from 0.
    pub tick: u32,
    /// Present time.
    pub time: u32,
    /// Counts of the motor encoder and time of the reading.
    pub motor: (u32, u32),
    /// Counts of the output encoder and time of the reading, if there is a reading.
    pub output: Option<(u32, u32)>,
    /// Last commanded torque [N m].
    pub torque: f32,
    /// Set-point.
    pub set_point: SetPoint,
    /// Requests all estimates in the answer; torque and digest are always sent.
    pub wants_estimates: bool,
}

/// Set-point of one control period.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum SetPoint {
    /// Follow a motion.
    Position {
        /// Present time.
        now: Motion,
        /// Motion one lead time of the compensation later.
        ahead: Option<Motion>,
    },
    /// Act as a spring and damper.
    Impedance(Impedance),
    /// Probe the width; the link is held.
    Probe,
}

/// Motion at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Position: whole turns and fraction.
    pub position: (i32, f32),
    /// Speed [rad/s].
    pub speed: f32,
    /// Acceleration [rad/s^2].
    pub acceleration: f32,
}

/// Spring and damper about a moving point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Impedance {
    /// Position: whole turns and fraction.
    pub position: (i32, f32),
    /// Speed [rad/s].
    pub speed: f32,
    /// Feedforward torque [N m].
    pub torque: f32,
    /// Stiffness [N m/rad].
    pub stiffness: f32,
    /// Damping [N m s/rad].
    pub damping: f32,
}

impl Exchange {
    /// Samples and set-point of a control period, with a request for all estimates.
    pub fn new(tick: u32, samples: &Samples<f32>, command: &compensation::Command<f32>) -> Self {
        Self::asking(tick, samples, SetPoint::from(command))
    }

    /// Samples of a control period of a width probe.
    pub fn probing(tick: u32, samples: &Samples<f32>) -> Self {
        Self::asking(tick, samples, SetPoint::Probe)
    }

    fn asking(tick: u32, samples: &Samples<f32>, set_point: SetPoint) -> Self {
        let reading = |reading: Reading| (reading.counts, reading.time);
        Self {
            tick,
            time: samples.time,
            motor: reading(samples.motor),
            output: samples.output.map(reading),
            torque: samples.torque,
            set_point,
            wants_estimates: true,
        }
    }

    /// Drops the request for estimates, which are most of the answer's bytes.
    pub fn without_estimates(self) -> Self {
        Self { wants_estimates: false, ..self }
    }

    /// Samples of the period.
    pub fn samples(&self) -> Samples<f32> {
        let reading = |(counts, time)| Reading { counts, time };
        Samples { time: self.time, motor: reading(self.motor), output: self.output.map(reading), torque: self.torque }
    }

    /// Set-point of the period; `None` in a width probe.
    pub fn command(&self) -> Option<compensation::Command<f32>> {
        let motion = |of: Motion| compensation::Motion {
            position: position(of.position),
            speed: of.speed,
            acceleration: of.acceleration,
        };
        match self.set_point {
            SetPoint::Position { now, ahead } => {
                Some(compensation::Command::Position { now: motion(now), ahead: ahead.map(motion) })
            }
            SetPoint::Impedance(point) => Some(compensation::Command::Impedance(point.into())),
            SetPoint::Probe => None,
        }
    }
}

fn place(position: Position<f32>) -> (i32, f32) {
    (position.turns, position.fraction)
}

fn position((turns, fraction): (i32, f32)) -> Position<f32> {
    Position { turns, fraction }
}

impl From<ImpedancePoint<f32>> for Impedance {
    fn from(point: ImpedancePoint<f32>) -> Self {
        let ImpedancePoint { position, speed, torque, stiffness, damping } = point;
        Self { position: place(position), speed, torque, stiffness, damping }
    }
}

impl From<Impedance> for ImpedancePoint<f32> {
    fn from(wire: Impedance) -> Self {
        let Impedance { speed, torque, stiffness, damping, .. } = wire;
        Self { position: position(wire.position), speed, torque, stiffness, damping }
    }
}

impl From<&compensation::Command<f32>> for SetPoint {
    fn from(command: &compensation::Command<f32>) -> Self {
        let motion = |of: &compensation::Motion<f32>| Motion {
            position: place(of.position),
            speed: of.speed,
            acceleration: of.acceleration,
        };
        match command {
            compensation::Command::Position { now, ahead } => {
                Self::Position { now: motion(now), ahead: ahead.as_ref().map(motion) }
            }
            compensation::Command::Impedance(point) => Self::Impedance((*point).into()),
        }
    }
}

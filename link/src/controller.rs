//! Messages between a motor controller and observer with compensation, in the wire's own form: samples and set-points here,
//! the answers in `answer`. Times are ticks of the samples' clock; every field is SI.

mod answer;

pub use answer::{Answered, WireEstimate, WireEstimates, WireProbed, WireShaped};
use model_core::compensation::{self, ImpedancePoint, Position};
use model_core::observer::{Reading, Samples};
use serde::{Deserialize, Serialize};

/// Most exchanges in one schedule: one control period each.
pub const EXCHANGES_PER_SCHEDULE: usize = 4;

/// One control period as a motor controller sees it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Exchange {
    /// The control period, counted from 0.
    pub tick: u32,
    /// Now.
    pub time: u32,
    /// Counts of the motor's encoder and when they were read.
    pub motor: (u32, u32),
    /// Likewise of the output's, if there are any.
    pub output: Option<(u32, u32)>,
    /// Torque that was commanded last [N m].
    pub torque: f32,
    /// What is asked for.
    pub set_point: SetPoint,
    /// The answer shall contain all estimates; torque and digest come in any case.
    pub wants_estimates: bool,
}

/// What is asked for in one control period.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum SetPoint {
    /// Follow a motion.
    Position {
        /// Now.
        now: Motion,
        /// Ahead by the compensation's lead.
        ahead: Option<Motion>,
    },
    /// Act as a spring and damper.
    Impedance(Impedance),
    /// Probe the width: the load is held.
    Probe,
}

/// A motion at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Whole turns and the rest.
    pub position: (i32, f32),
    /// [rad/s].
    pub speed: f32,
    /// [rad/s^2].
    pub acceleration: f32,
}

/// A spring and damper about a moving point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Impedance {
    /// Whole turns and the rest.
    pub position: (i32, f32),
    /// [rad/s].
    pub speed: f32,
    /// [N m].
    pub torque: f32,
    /// [N m/rad].
    pub stiffness: f32,
    /// [N m s/rad].
    pub damping: f32,
}

impl Exchange {
    /// A control period's samples and set-point, to be answered with all estimates.
    pub fn new(tick: u32, samples: &Samples<f32>, command: &compensation::Command<f32>) -> Self {
        Self::asking(tick, samples, SetPoint::from(command))
    }

    /// A control period of a width probe.
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

    /// The same without estimates in the answer, which are most of its bytes.
    pub fn without_estimates(self) -> Self {
        Self { wants_estimates: false, ..self }
    }

    /// The samples.
    pub fn samples(&self) -> Samples<f32> {
        let reading = |(counts, time)| Reading { counts, time };
        Samples { time: self.time, motor: reading(self.motor), output: self.output.map(reading), torque: self.torque }
    }

    /// The set-point; none in a period of a width probe.
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

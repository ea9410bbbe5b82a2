//! What passes between a host and a board that runs the whole loop: the motion asked for as polynomials over stretches of
//! time, so that a slow line can carry it, and what joint and controller did.

use heapless::Vec;
use model_core::controller::course::{Demand, POWERS, Stretch};
use model_core::virtual_joint::upset::{Kind, Shaft, Upset};
use serde::{Deserialize, Serialize};

use crate::controller::Impedance;

/// Most knots in one schedule.
pub const KNOTS_PER_SCHEDULE: usize = 6;
/// Most samples in one [`LoopBatch`].
pub const LOOP_SAMPLES_PER_BATCH: usize = 4;

/// What is asked for from a tick on, until the next knot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Knot {
    /// First control period that it is for.
    pub tick: u32,
    /// Torque that brakes the link, beside its friction and weight [N m].
    pub load_torque: f32,
    /// What the controller is asked for.
    pub demand: WireDemand,
}

/// Whole turns and the powers of a motion over a stretch of time.
pub type WireStretch = (i32, [f32; POWERS]);

/// What is asked for over a stretch of time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum WireDemand {
    /// Follow a motion: now, and ahead by the compensation's lead.
    Position(WireStretch, Option<WireStretch>),
    /// Be a spring and damper.
    Impedance(Impedance),
}

impl From<&Demand<f32>> for WireDemand {
    fn from(demand: &Demand<f32>) -> Self {
        let stretch = |of: &Stretch<f32>| (of.turns, of.powers);
        match demand {
            Demand::Position { now, ahead } => Self::Position(stretch(now), ahead.as_ref().map(stretch)),
            Demand::Impedance(point) => Self::Impedance((*point).into()),
        }
    }
}

impl From<WireDemand> for Demand<f32> {
    fn from(wire: WireDemand) -> Self {
        let stretch = |(turns, powers)| Stretch { turns, powers };
        match wire {
            WireDemand::Position(now, ahead) => Self::Position { now: stretch(now), ahead: ahead.map(stretch) },
            WireDemand::Impedance(point) => Self::Impedance(point.into()),
        }
    }
}

impl Knot {
    /// Nothing in it is infinite or no number.
    pub fn is_finite(&self) -> bool {
        let stretch = |(_, powers): &WireStretch| powers.iter().all(|power| power.is_finite());
        self.load_torque.is_finite()
            && match &self.demand {
                WireDemand::Position(now, ahead) => stretch(now) && ahead.as_ref().is_none_or(stretch),
                WireDemand::Impedance(point) => {
                    let Impedance { position, speed, torque, stiffness, damping } = *point;
                    [position.1, speed, torque, stiffness, damping].iter().all(|value| value.is_finite())
                }
            }
    }
}

/// Joint and controller after a control period.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LoopSample {
    /// Control periods done.
    pub tick: u32,
    /// Running digest over joint and answers after every period so far.
    pub digest: u64,
    /// Carrier as a rigid body: whole turns and 2^-32 turns.
    pub carrier: (i32, u32),
    /// Link angle less that [rad].
    pub link_offset: f32,
    /// Gap coordinate as it is, and as the observer has it [m].
    pub gaps: (f32, f32),
    /// Whether the observer stands by it.
    pub gap_valid: bool,
    /// Half-backlash as learnt [m].
    pub half_backlash: f32,
    /// Torque that was commanded [N m].
    pub torque: f32,
    /// What brakes the link, as it is and as the observer has it [N m].
    pub loads: (f32, f32),
    /// Share of the compensation.
    pub trust: f32,
    /// Computation time of this period, in timer counts.
    pub computation: u16,
}

/// Consecutive samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoopBatch {
    /// Rises by one with every batch of a run, from 0 after a reset.
    pub sequence: u16,
    /// The samples, oldest first.
    pub samples: Vec<LoopSample, LOOP_SAMPLES_PER_BATCH>,
}

/// A fault between the virtual joint and its controller.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WireUpset {
    /// First control period in which it acts.
    pub start: u32,
    /// First in which it acts no more.
    pub end: u32,
    /// Begins its random numbers.
    pub seed: u64,
    /// What goes wrong.
    pub kind: WireKind,
}

/// What goes wrong, where `true` is the link's encoder; angles in 2^-32 turns, shares in 2^-32, torques in N m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum WireKind {
    /// Counts stand still.
    Frozen(bool),
    /// Counts are off.
    Offset(bool, i32),
    /// Counts scatter by a standard deviation.
    Noise(bool, u32),
    /// A share of the motion is not counted.
    MissingCounts(bool, u32),
    /// An error that comes once a turn.
    Eccentric(bool, f32),
    /// A share of the readings does not come.
    LostFrames(bool, u32),
    /// Torque beyond the command: a ratio of it, and a torque.
    TorqueBias(f32, f32),
    /// The motor gives no more than this.
    Saturation(f32),
}

impl From<&Upset<f32>> for WireUpset {
    fn from(upset: &Upset<f32>) -> Self {
        let link = |shaft: Shaft| shaft == Shaft::Link;
        let Upset { start, end, seed, kind } = *upset;
        let kind = match kind {
            Kind::Frozen(shaft) => WireKind::Frozen(link(shaft)),
            Kind::Offset(shaft, angle) => WireKind::Offset(link(shaft), angle),
            Kind::Noise(shaft, deviation) => WireKind::Noise(link(shaft), deviation),
            Kind::MissingCounts(shaft, share) => WireKind::MissingCounts(link(shaft), share),
            Kind::Eccentric(shaft, amplitude) => WireKind::Eccentric(link(shaft), amplitude),
            Kind::LostFrames(shaft, share) => WireKind::LostFrames(link(shaft), share),
            Kind::TorqueBias(ratio, torque) => WireKind::TorqueBias(ratio, torque),
            Kind::Saturation(torque) => WireKind::Saturation(torque),
        };
        Self { start, end, seed, kind }
    }
}

impl From<WireUpset> for Upset<f32> {
    fn from(wire: WireUpset) -> Self {
        let shaft = |link: bool| if link { Shaft::Link } else { Shaft::Motor };
        let WireUpset { start, end, seed, kind } = wire;
        let kind = match kind {
            WireKind::Frozen(link) => Kind::Frozen(shaft(link)),
            WireKind::Offset(link, angle) => Kind::Offset(shaft(link), angle),
            WireKind::Noise(link, deviation) => Kind::Noise(shaft(link), deviation),
            WireKind::MissingCounts(link, share) => Kind::MissingCounts(shaft(link), share),
            WireKind::Eccentric(link, amplitude) => Kind::Eccentric(shaft(link), amplitude),
            WireKind::LostFrames(link, share) => Kind::LostFrames(shaft(link), share),
            WireKind::TorqueBias(ratio, torque) => Kind::TorqueBias(ratio, torque),
            WireKind::Saturation(torque) => Kind::Saturation(torque),
        };
        Self { start, end, seed, kind }
    }
}

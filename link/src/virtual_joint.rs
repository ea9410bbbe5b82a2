//! What passes between a host and a board that runs the whole loop: the motion asked for as polynomials over stretches of
//! time, so that a slow line can carry it, and what joint and controller did.

use heapless::Vec;
use model_core::controller::course::{Demand, POWERS, Stretch};
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

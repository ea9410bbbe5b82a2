//! Messages between a host and a board in the role `loop`: the trajectory as polynomials over time segments, which
//! suits a slow line, and samples of joint and controller.

use heapless::Vec;
use model_core::controller::trajectory::{POWERS, Segment, Trajectory};
use serde::{Deserialize, Serialize};

use crate::controller::Impedance;

/// Most knots in one schedule.
pub const KNOTS_PER_SCHEDULE: usize = 6;
/// Most samples in one [`LoopBatch`].
pub const LOOP_SAMPLES_PER_BATCH: usize = 4;

/// Trajectory from a tick on, until the next knot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Knot {
    /// First control period of the segment.
    pub tick: u32,
    /// External torque that brakes the link, without friction and weight [N m].
    pub load_torque: f32,
    /// Set-points of the segment.
    pub trajectory: WireTrajectory,
}

/// Whole turns and polynomial coefficients of a motion over a time segment.
pub type WireSegment = (i32, [f32; POWERS]);

/// Set-points over a time segment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum WireTrajectory {
    /// Follow a motion: present motion, and the motion one lead time of the compensation later.
    Position(WireSegment, Option<WireSegment>),
    /// Act as a spring and damper.
    Impedance(Impedance),
}

impl From<&Trajectory<f32>> for WireTrajectory {
    fn from(trajectory: &Trajectory<f32>) -> Self {
        let segment = |of: &Segment<f32>| (of.turns, of.powers);
        match trajectory {
            Trajectory::Position { now, ahead } => Self::Position(segment(now), ahead.as_ref().map(segment)),
            Trajectory::Impedance(point) => Self::Impedance((*point).into()),
        }
    }
}

impl From<WireTrajectory> for Trajectory<f32> {
    fn from(wire: WireTrajectory) -> Self {
        let segment = |(turns, powers)| Segment { turns, powers };
        match wire {
            WireTrajectory::Position(now, ahead) => Self::Position { now: segment(now), ahead: ahead.map(segment) },
            WireTrajectory::Impedance(point) => Self::Impedance(point.into()),
        }
    }
}

impl Knot {
    /// Returns `true` if every number of the knot is finite.
    pub fn is_finite(&self) -> bool {
        let segment = |(_, powers): &WireSegment| powers.iter().all(|power| power.is_finite());
        self.load_torque.is_finite()
            && match &self.trajectory {
                WireTrajectory::Position(now, ahead) => segment(now) && ahead.as_ref().is_none_or(segment),
                WireTrajectory::Impedance(point) => {
                    let Impedance { position, speed, torque, stiffness, damping } = *point;
                    [position.1, speed, torque, stiffness, damping].iter().all(|value| value.is_finite())
                }
            }
    }
}

/// State of joint and controller after a control period.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LoopSample {
    /// Completed control periods.
    pub tick: u32,
    /// Running digest over joint and answers after every period so far.
    pub digest: u64,
    /// Angle of the rigid-body carrier: whole turns and 2^-32 turns.
    pub carrier: (i32, u32),
    /// Link angle less rigid-body carrier angle [rad].
    pub link_offset: f32,
    /// Gap coordinate, true and estimated [m].
    pub gaps: (f32, f32),
    /// Validity of the estimated gap coordinate.
    pub gap_valid: bool,
    /// Estimated half-backlash [m].
    pub half_backlash: f32,
    /// Commanded torque [N m].
    pub torque: f32,
    /// Torque that brakes the link, true and estimated [N m].
    pub loads: (f32, f32),
    /// Share of the compensation in the torque, 0 to 1.
    pub trust: f32,
    /// Computation time of this period [timer counts].
    pub computation: u16,
}

/// Consecutive samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoopBatch {
    /// Sequence number; rises by one per batch of a run, from 0 after a reset.
    pub sequence: u16,
    /// Samples, oldest first.
    pub samples: Vec<LoopSample, LOOP_SAMPLES_PER_BATCH>,
}

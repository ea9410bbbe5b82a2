//! The joint model inside a drive train, and its step: the reference, or another model of the same joint to be compared with
//! it under the same torques and sensors.

use crate::joint::{Observation, Reference, ReferenceError};

/// How the joint model is integrated over a part of time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Stepping {
    /// Adaptive steps of order 8 that end at every contact event.
    #[default]
    Adaptive,
    /// Fixed fine steps, many times faster: for closed loops, whose feedback forgives what a step loses.
    Fixed,
}

/// A joint in motion.
pub trait JointModel {
    /// Moves on to `time` [s] under constant torques: `drive` on the sun, `load` braking the link [N m].
    fn advance(&mut self, time: f64, drive: f64, load: f64, stepping: Stepping) -> Result<(), ReferenceError>;

    /// Outputs now.
    fn observe(&self) -> Observation;
}

impl JointModel for Reference {
    fn advance(&mut self, time: f64, drive: f64, load: f64, stepping: Stepping) -> Result<(), ReferenceError> {
        match stepping {
            Stepping::Adaptive => Reference::advance(self, time, drive, load),
            Stepping::Fixed => {
                self.advance_by_fixed_steps(time, drive, load);
                Ok(())
            }
        }
    }

    fn observe(&self) -> Observation {
        Reference::observe(self)
    }
}

impl<I: JointModel + ?Sized> JointModel for Box<I> {
    fn advance(&mut self, time: f64, drive: f64, load: f64, stepping: Stepping) -> Result<(), ReferenceError> {
        (**self).advance(time, drive, load, stepping)
    }

    fn observe(&self) -> Observation {
        (**self).observe()
    }
}

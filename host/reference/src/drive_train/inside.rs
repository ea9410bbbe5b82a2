//! What moves inside a drive train: the reference, or another model of the same joint that is to be held against it.
//! Torques and sensors are the drive train's, so that both get the same ones.

use super::Stepping;
use crate::joint::{Observation, Reference, ReferenceError};

/// A joint in motion.
pub trait Inside {
    /// Moves on to `time` [s] under constant torques: `drive_torque` on the sun, `load_torque` braking the link [N m].
    fn advance(
        &mut self,
        time: f64,
        drive_torque: f64,
        load_torque: f64,
        stepping: Stepping,
    ) -> Result<(), ReferenceError>;

    /// What can be read off now.
    fn observe(&self) -> Observation;
}

impl Inside for Reference {
    fn advance(
        &mut self,
        time: f64,
        drive_torque: f64,
        load_torque: f64,
        stepping: Stepping,
    ) -> Result<(), ReferenceError> {
        match stepping {
            Stepping::Adaptive => Reference::advance(self, time, drive_torque, load_torque),
            Stepping::Fixed => {
                self.advance_by_fixed_steps(time, drive_torque, load_torque);
                Ok(())
            }
        }
    }

    fn observe(&self) -> Observation {
        Reference::observe(self)
    }
}

impl<I: Inside + ?Sized> Inside for Box<I> {
    fn advance(
        &mut self,
        time: f64,
        drive_torque: f64,
        load_torque: f64,
        stepping: Stepping,
    ) -> Result<(), ReferenceError> {
        (**self).advance(time, drive_torque, load_torque, stepping)
    }

    fn observe(&self) -> Observation {
        (**self).observe()
    }
}

//! Interface of the joint model inside a drive train, and its integration. The model is the reference, or another model
//! of the joint for a comparison under equal torques and sensors.

use crate::joint::{Observation, Reference, ReferenceError};

/// Integration of the joint model over a part of a period.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Stepping {
    /// Adaptive steps of order 8 that end at every contact event.
    #[default]
    Adaptive,
    /// Fixed fine steps, many times faster: for closed loops, whose feedback compensates the smaller accuracy.
    Fixed,
}

/// Joint model with its state.
pub trait JointModel {
    /// Advances to `time` [s] under constant torques: `drive` on the sun, `load` braking the link [N m].
    fn advance(&mut self, time: f64, drive: f64, load: f64, stepping: Stepping) -> Result<(), ReferenceError>;

    /// Returns the present outputs.
    fn observe(&self) -> Observation;

    /// Multiplies the half-backlash of every mesh by a factor that holds until it is changed.
    fn scale_half_backlash(&mut self, factor: f64);

    /// Sets the inertia of the link [kg m^2].
    fn set_link_inertia(&mut self, link_inertia: f64);
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

    fn scale_half_backlash(&mut self, factor: f64) {
        Reference::scale_half_backlash(self, factor);
    }

    fn set_link_inertia(&mut self, link_inertia: f64) {
        Reference::set_link_inertia(self, link_inertia);
    }
}

impl<I: JointModel + ?Sized> JointModel for Box<I> {
    fn advance(&mut self, time: f64, drive: f64, load: f64, stepping: Stepping) -> Result<(), ReferenceError> {
        (**self).advance(time, drive, load, stepping)
    }

    fn observe(&self) -> Observation {
        (**self).observe()
    }

    fn scale_half_backlash(&mut self, factor: f64) {
        (**self).scale_half_backlash(factor);
    }

    fn set_link_inertia(&mut self, link_inertia: f64) {
        (**self).set_link_inertia(link_inertia);
    }
}

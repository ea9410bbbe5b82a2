//! A joint together with its surroundings.

use crate::{JointParameters, Surroundings};

/// Joint and surroundings: the whole plant of a controller.
#[derive(Debug, Clone, Copy)]
pub struct PlantParameters<'p> {
    /// Gears and bodies of the joint.
    pub joint: &'p JointParameters,
    /// Motor, friction, weight, encoders and rate of the controller.
    pub surroundings: &'p Surroundings,
}

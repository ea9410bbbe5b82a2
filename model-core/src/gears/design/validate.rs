//! Whether tables can be designed from parameters: their own limits, and those that follow from the gears' laws.

use parameters::{JointParameters, MESH_KINDS};

use crate::gears::design::error::DesignError;
use crate::gears::stiffness_series::StiffnessSeries;

/// Checks everything that the tables rest on.
pub fn validate(parameters: &JointParameters) -> Result<(), DesignError> {
    parameters.validate()?;
    for kind in MESH_KINDS {
        let swing = parameters.mesh(kind).stiffness_wave.swing();
        if swing.is_nan() || swing >= 1.0 {
            let what = "the sum of the stiffness ripple's harmonics over the mean";
            return Err(DesignError::OutOfRange { what, given: swing, must_be: "below 1: stiffness stays positive" });
        }
    }
    Ok(())
}

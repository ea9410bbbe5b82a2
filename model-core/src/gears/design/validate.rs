//! Checks of parameters before the design: limits of the parameters and limits by the laws of the gears.

use parameters::{JointParameters, MESH_KINDS};

use crate::gears::design::error::DesignError;
use crate::gears::stiffness_series::StiffnessSeries;

/// Checks all parameters that the tables use.
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

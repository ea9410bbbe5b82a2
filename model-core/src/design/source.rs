//! Tables as Rust source, for a build script: what a board links into its flash. Numbers are printed so that they
//! read back to the same bits.

use std::format;
use std::string::String;

use crate::design::{DesignError, design};
use crate::joint::JointParameters;

/// `PLANETS`, `JOINT_NAME` and the static `TABLES` of a joint at a tick rate, as a module's text.
pub fn rust_source(parameters: &JointParameters, tick_rate: u32) -> Result<String, DesignError> {
    match parameters.geometry.planets {
        3 => source::<3>(parameters, tick_rate),
        4 => source::<4>(parameters, tick_rate),
        5 => source::<5>(parameters, tick_rate),
        given => Err(DesignError::PlanetCount { given }),
    }
}

fn source<const N: usize>(parameters: &JointParameters, tick_rate: u32) -> Result<String, DesignError> {
    let tables = design::<f32, N>(parameters, tick_rate)?;
    let name = &parameters.name;
    Ok(format!(
        "use model_core::mesh::DampingLaw::*;\n\
         use model_core::tables::{{Scheme::*, *}};\n\n\
         /// Number of planets.\n\
         pub const PLANETS: usize = {N};\n\
         /// Name of the joint.\n\
         pub const JOINT_NAME: &str = {name:?};\n\
         /// Tables of the joint.\n\
         pub static TABLES: Tables<f32, {N}> = {tables:#?};\n"
    ))
}

//! Rust source of tables and certificate, which a build script writes and a board links into flash. The printed numbers
//! read back with equal bits.

use std::format;
use std::string::String;

use crate::gears::design::certificate::certificate;
use crate::gears::design::error::DesignError;
use crate::gears::design::processor::Processor;
use crate::gears::design::step_size::Effort;
use crate::gears::design::tables::design_scheme;
use crate::gears::tables::{Scheme, Tables};
use parameters::{JointParameters, ParameterError};

/// Returns a module with `PLANETS`, `JOINT_NAME`, `CERTIFICATE` and the static `TABLES` of a joint at a tick rate, designed
/// for an STM32F405.
///
/// Example of a build script for a board:
///
/// ```
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap().parameters;
/// let module = model_core::gears::design::rust_source(&q1, 20_000)?;
/// assert!(module.contains("pub static TABLES: Tables<f32, 3>"));
/// assert!(module.contains("tick_rate: 20000") && module.contains("JOINT_NAME: &str = \"Q1\""));
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
pub fn rust_source(parameters: &JointParameters, tick_rate: u32) -> Result<String, DesignError> {
    rust_source_for(parameters, tick_rate, &Processor::STM32F405)
}

/// Returns the module of [`rust_source`], designed for a given processor.
pub fn rust_source_for(
    parameters: &JointParameters,
    tick_rate: u32,
    processor: &Processor,
) -> Result<String, DesignError> {
    match parameters.geometry.planets {
        1 => source::<1>(parameters, tick_rate, processor),
        3 => source::<3>(parameters, tick_rate, processor),
        4 => source::<4>(parameters, tick_rate, processor),
        5 => source::<5>(parameters, tick_rate, processor),
        given => Err(ParameterError::PlanetCount { given }.into()),
    }
}

fn source<const N: usize>(
    parameters: &JointParameters,
    tick_rate: u32,
    processor: &Processor,
) -> Result<String, DesignError> {
    let effort = Effort::Within(*processor);
    let tables: Tables<f32, N> = design_scheme(parameters, tick_rate, Scheme::Realtime, effort)?;
    let certificate = certificate(parameters, tick_rate, effort)?;
    let name = &parameters.name;
    let (most, bytes) = (certificate.instructions.all_crossing, certificate.table_bytes);
    Ok(format!(
        "use model_core::gears::certificate::{{Substeps::*, *}};\n\
         use model_core::gears::tables::{{DampingLaw::*, Scheme::*, *}};\n\n\
         /// Number of planets.\n\
         pub const PLANETS: usize = {N};\n\
         /// Name of the joint.\n\
         pub const JOINT_NAME: &str = {name:?};\n\
         /// Certificate: {most} instructions when every mesh crosses twice; {bytes} bytes of tables.\n\
         pub const CERTIFICATE: Certificate = {certificate:#?};\n\
         /// Tables of the joint.\n\
         pub static TABLES: Tables<f32, {N}> = {tables:#?};\n"
    ))
}

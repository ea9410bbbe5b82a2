//! Tables of observer, compensation and a virtual joint's surroundings as Rust source, for a build script: what the roles
//! that control link into their flash. Numbers are printed so that they read back to the same bits.

use std::format;
use std::string::String;

use crate::compensation::CompensationTables;
use crate::compensation::design::{compensation_settings, design_compensation};
use crate::gears::design::{DesignError, Effort, Processor, design_scheme};
use crate::gears::{Scheme, Tables};
use crate::numbers::digest;
use crate::observer::design::{observer_settings, observer_statics};
use crate::virtual_joint::SurroundingsTable;
use crate::virtual_joint::design::design_surroundings;
use parameters::{JointParameters, ParameterError, Surroundings};

/// Where the digest of a controller's tables starts: after the import lines of its first version. It is taken over the
/// statics alone, so that a controller keeps its digest wherever types live.
const DIGEST_START: u64 = 0xdae8_511f_fc23_8683;

/// What a controller is made for besides the joint and its surroundings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlWish {
    /// Bandwidth of the loop [rad/s].
    pub bandwidth: f64,
    /// Whether the observer is shown the output encoder.
    pub output_encoder: bool,
}

/// What a controller is told, and what is wanted of it.
#[derive(Debug, Clone, Copy)]
pub struct Told<'t> {
    /// The joint; its backlash may be a guess.
    pub joint: &'t JointParameters,
    /// What surrounds it.
    pub surroundings: &'t Surroundings,
    /// What is wanted.
    pub wish: ControlWish,
}

/// Tables as Rust source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControlSource {
    /// The statics `OBSERVER`, `PROBE`, `COMPENSATION` and `SURROUNDINGS` and the constant `CONTROL_DIGEST`, as a module's text.
    pub text: String,
    /// The constant: a digest over the statics.
    pub digest: u64,
}

/// Tables of a controller, and of what truly surrounds the joint, as source.
pub fn control_source(
    joint: &JointParameters,
    around: &Surroundings,
    told: &Told<'_>,
    processor: &Processor,
) -> Result<ControlSource, DesignError> {
    let mut settings = observer_settings(told.surroundings);
    if !told.wish.output_encoder {
        settings.output_encoder = None;
    }
    let observer = observer_statics(told.joint, &settings)?;
    let compensation: CompensationTables<f32> =
        design_compensation(told.joint, &compensation_settings(told.surroundings, told.wish.bandwidth))?;
    let surroundings: SurroundingsTable<f32> = match joint.geometry.planets {
        3 => surroundings::<3>(joint, around, processor)?,
        4 => surroundings::<4>(joint, around, processor)?,
        5 => surroundings::<5>(joint, around, processor)?,
        given => return Err(ParameterError::PlanetCount { given }.into()),
    };
    let statics = format!(
        "{observer}\n\
         /// Tables of the compensation.\n\
         pub static COMPENSATION: CompensationTables<f32> = {compensation:#?};\n\
         /// What surrounds the virtual joint.\n\
         pub static SURROUNDINGS: SurroundingsTable<f32> = {surroundings:#?};\n"
    );
    let digest = statics.bytes().fold(DIGEST_START, |running, byte| digest::chain(running, byte.into()));
    let text = format!(
        "use model_core::compensation::tables::*;\n\
         use model_core::observer::tables::*;\n\
         use model_core::virtual_joint::tables::*;\n\n\
         {statics}\
         /// Digest over these tables.\n\
         pub const CONTROL_DIGEST: u64 = {digest:#x};\n"
    );
    Ok(ControlSource { text, digest })
}

fn surroundings<const N: usize>(
    joint: &JointParameters,
    of: &Surroundings,
    processor: &Processor,
) -> Result<SurroundingsTable<f32>, DesignError> {
    let tables: Tables<f32, N> = design_scheme(joint, of.control_rate, Scheme::Realtime, Effort::Within(*processor))?;
    design_surroundings(joint, of, &tables)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_starts_after_the_imports_of_its_first_version() {
        let imports = ["compensation", "virtual_joint", "observer"]
            .map(|subject| format!("use model_core::tables::{subject}::*;\n"))
            .concat();
        let start =
            imports.bytes().chain(*b"\n").fold(digest::START, |running, byte| digest::chain(running, byte.into()));
        assert_eq!(start, DIGEST_START);
    }
}

//! Tables of observer, compensation and a virtual joint's surroundings as Rust source, for a build script: what the roles
//! that control link into their flash. Numbers are printed so that they read back to the same bits.

use std::format;
use std::string::String;

use super::compensation::design_compensation;
use super::observer::observer_source;
use super::virtual_joint::{compensation_settings, design_surroundings, observer_settings};
use super::{Effort, Processor, design_scheme};
use crate::digest;
use crate::error::DesignError;
use crate::joint::JointParameters;
use crate::surroundings::Surroundings;
use crate::tables::compensation::CompensationTables;
use crate::tables::virtual_joint::SurroundingsTable;
use crate::tables::{Scheme, Tables};

/// What a controller is made for besides the joint and its surroundings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlWish {
    /// Bandwidth of the loop [rad/s].
    pub bandwidth: f64,
    /// Whether the observer is shown the output encoder.
    pub output_encoder: bool,
}

/// The statics `OBSERVER`, `COMPENSATION` and `SURROUNDINGS` and `CONTROL_DIGEST`, a digest over this very text, as a
/// module's text.
pub fn control_source(
    joint: &JointParameters,
    of: &Surroundings,
    wish: &ControlWish,
    processor: &Processor,
) -> Result<String, DesignError> {
    let mut settings = observer_settings(of);
    if !wish.output_encoder {
        settings.output_encoder = None;
    }
    let observer = observer_source(joint, &settings)?;
    let compensation: CompensationTables<f32> = design_compensation(joint, &compensation_settings(of, wish.bandwidth))?;
    let surroundings: SurroundingsTable<f32> = match joint.geometry.planets {
        3 => surroundings::<3>(joint, of, processor)?,
        4 => surroundings::<4>(joint, of, processor)?,
        5 => surroundings::<5>(joint, of, processor)?,
        given => return Err(DesignError::PlanetCount { given }),
    };
    let text = format!(
        "use model_core::tables::compensation::*;\n\
         use model_core::tables::virtual_joint::*;\n\
         {observer}\n\
         /// Tables of the compensation.\n\
         pub static COMPENSATION: CompensationTables<f32> = {compensation:#?};\n\
         /// What surrounds the virtual joint.\n\
         pub static SURROUNDINGS: SurroundingsTable<f32> = {surroundings:#?};\n"
    );
    let digest = text.bytes().fold(digest::START, |running, byte| digest::chain(running, byte.into()));
    Ok(format!("{text}/// Digest over all of it.\npub const CONTROL_DIGEST: u64 = {digest:#x};\n"))
}

fn surroundings<const N: usize>(
    joint: &JointParameters,
    of: &Surroundings,
    processor: &Processor,
) -> Result<SurroundingsTable<f32>, DesignError> {
    let tables: Tables<f32, N> = design_scheme(joint, of.control_rate, Scheme::Realtime, Effort::Within(*processor))?;
    design_surroundings(joint, of, &tables)
}

//! The tables of observer and width probe as Rust source, for a build script: what a board links into its flash. Numbers are printed so
//! that they read back to the same bits.

use std::format;
use std::string::String;

use super::{ObserverSettings, design_observer, design_usual_probe};
use crate::error::DesignError;
use crate::joint::JointParameters;
use crate::tables::observer::{ObserverTables, ProbeTable};

/// The statics `OBSERVER` and `PROBE` of a joint, as a module's text.
pub fn observer_source(joint: &JointParameters, settings: &ObserverSettings) -> Result<String, DesignError> {
    let tables: ObserverTables<f32> = design_observer(joint, settings)?;
    let probe: Option<ProbeTable<f32>> = design_usual_probe(joint, settings)?;
    Ok(format!(
        "use model_core::tables::observer::*;\n\n\
         /// Tables of the observer.\n\
         pub static OBSERVER: ObserverTables<f32> = {tables:#?};\n\
         /// Table of the width probe, where one can be.\n\
         pub static PROBE: Option<ProbeTable<f32>> = {probe:#?};\n"
    ))
}

//! Tables of observer and width probe as Rust source for a build script, to be linked into a board's flash. Printed
//! numbers read back to equal bits.

use std::format;
use std::string::String;

use super::probe::design_usual_probe;
use super::settings::ObserverSettings;
use super::tables::design_observer;
use crate::gears::design::DesignError;
use crate::observer::tables::{ObserverTables, ProbeTable};
use parameters::JointParameters;

/// Returns the source text of a module with the statics `OBSERVER` and `PROBE` of a joint.
pub fn observer_source(joint: &JointParameters, settings: &ObserverSettings) -> Result<String, DesignError> {
    let tables: ObserverTables<f32> = design_observer(joint, settings)?;
    let probe: Option<ProbeTable<f32>> = design_usual_probe(joint, settings)?;
    Ok(observer_text(&tables, probe.as_ref()))
}

/// Returns the source text for given tables.
pub(crate) fn observer_text(tables: &ObserverTables<f32>, probe: Option<&ProbeTable<f32>>) -> String {
    format!(
        "/// Tables of the observer.\n\
         pub static OBSERVER: model_core::observer::tables::ObserverTables<f32> = {{\n\
         use model_core::observer::tables::*;\n{tables:#?}\n}};\n\
         /// Table of the width probe, where one can be.\n\
         pub static PROBE: Option<model_core::observer::tables::ProbeTable<f32>> = {{\n\
         use model_core::observer::tables::*;\n{probe:#?}\n}};\n"
    )
}

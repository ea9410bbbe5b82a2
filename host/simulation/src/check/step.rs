//! What the tables take of a board's flash, and the number of sub-steps in a tick, from `model_core::gears::design`.

use model_core::gears::Tables;
use model_core::gears::design::{DesignError, design};
use parameters::JointParameters;

/// The fixed step at one rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// Parts of a tick while contacts change.
    pub substeps: u32,
    /// Bytes of the f32 tables.
    pub table_bytes: usize,
    /// Digest of the tables.
    pub digest: u64,
}

/// The step at `rate` [Hz].
pub(super) fn step(parameters: &JointParameters, rate: u32) -> Result<Step, DesignError> {
    match parameters.geometry.planets {
        1 => of_size::<1>(parameters, rate),
        3 => of_size::<3>(parameters, rate),
        4 => of_size::<4>(parameters, rate),
        _ => of_size::<5>(parameters, rate),
    }
}

fn of_size<const N: usize>(parameters: &JointParameters, rate: u32) -> Result<Step, DesignError> {
    let tables = design::<f32, N>(parameters, rate)?;
    Ok(Step { substeps: tables.substeps, table_bytes: size_of::<Tables<f32, N>>(), digest: tables.digest })
}

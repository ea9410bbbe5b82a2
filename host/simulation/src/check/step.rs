//! Size and digest of the tables, from `model_core::gears::design`.

use model_core::gears::design::{DesignError, Effort, Processor, design_scheme};
use model_core::gears::{Scheme, Tables};
use parameters::JointParameters;

/// The fixed step at one rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// Size of the f32 tables [bytes].
    pub table_bytes: usize,
    /// Digest of the tables.
    pub digest: u64,
}

/// Designs the step for a processor at `rate` [Hz].
pub(super) fn step(parameters: &JointParameters, processor: Processor, rate: u32) -> Result<Step, DesignError> {
    match parameters.geometry.planets {
        1 => step_of_size::<1>(parameters, processor, rate),
        3 => step_of_size::<3>(parameters, processor, rate),
        4 => step_of_size::<4>(parameters, processor, rate),
        _ => step_of_size::<5>(parameters, processor, rate),
    }
}

fn step_of_size<const N: usize>(
    parameters: &JointParameters,
    processor: Processor,
    rate: u32,
) -> Result<Step, DesignError> {
    let tables = design_scheme::<f32, N>(parameters, rate, Scheme::Realtime, Effort::Within(processor))?;
    Ok(Step { table_bytes: size_of::<Tables<f32, N>>(), digest: tables.digest })
}

//! Record of a comparison with its provenance, written as JSON in the schema `joint-bench/1`.

use serde::Serialize;

use crate::{in_a_sample, libraries, method_results, verdicts};

/// Version of the schema; rises when a field changes its meaning or is removed.
pub const SCHEMA: &str = "joint-bench/1";

/// Results of a comparison.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct BenchmarkRecord {
    /// `joint-bench/1`.
    pub schema: &'static str,
    /// Origin of the figures.
    pub origin: Origin,
    /// Cases.
    pub cases: Vec<method_results::CaseRecord>,
    /// Fixed-step methods: error and instructions.
    pub methods: Vec<method_results::MethodResult>,
    /// Instructions at equal error.
    pub at_equal_error: Vec<verdicts::AtError>,
    /// Robot joints: every method at equal cost.
    pub in_a_sample: Vec<in_a_sample::InASample>,
    /// Least error within half a board.
    pub in_budget: Vec<verdicts::InBudget>,
    /// f32 against f64.
    pub rounding: Vec<verdicts::Rounding>,
    /// Host times, unless left out.
    pub host: Option<libraries::Times>,
    /// Host times at equal error.
    pub host_at_equal_error: Vec<verdicts::AtError>,
}

/// Origin of the figures.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Origin {
    /// Commit of the sources.
    pub commit: String,
    /// Date.
    pub date: String,
    /// Compiler of the image.
    pub compiler: String,
    /// Flags of the image.
    pub flags: String,
    /// Emulator and machine.
    pub emulator: String,
    /// The host's processor.
    pub host: String,
}

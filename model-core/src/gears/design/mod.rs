//! The offline half of the gears, f64: from parameters to the tables of a fixed step. `dynamics` is eq. 19,
//! `hamiltonian` eq. 20, `exponential` the precise integration, `flow_tables` its sorting into in-phase and deviating
//! motion; `tables` puts them together, `step_size` chooses the sub-steps, `certificate` states their error and cost.

mod certificate;
mod cost;
pub mod dynamics;
mod equivalent;
mod error;
pub mod exponential;
mod flow_tables;
pub mod hamiltonian;
pub mod modes;
mod processor;
mod source;
mod stability;
mod step_size;
mod tables;
mod validate;
pub mod verlet_tables;

pub use certificate::certificate;
pub use cost::Cost;
pub use error::{BandwidthLimit, DesignError};
pub use processor::Processor;
pub use source::{rust_source, rust_source_for};
pub use step_size::{Effort, StepSize, Substeps};
pub use tables::{design, design_scheme};
pub(crate) use validate::validate;

//! Design of the gear tables (offline, f64) from parameters. `dynamics` is eq. 19 and (S4), `hamiltonian` eq. 20,
//! `exponential` the precise integration, `kalman` the steady-state filter of any linear system; `flow_tables` splits
//! the flow into in-phase motion and deviations. `tables` assembles all tables, `step_size` chooses the sub-steps,
//! `certificate` states their cost and stability.

mod certificate;
mod cost;
pub mod dynamics;
mod equivalent;
mod error;
pub mod exponential;
mod flow_tables;
pub mod hamiltonian;
pub(crate) mod kalman;
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

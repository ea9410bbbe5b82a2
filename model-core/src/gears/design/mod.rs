//! The offline half of the gears, f64: from parameters to the tables of a fixed step. `dynamics` is eq. 19,
//! `hamiltonian` eq. 20, `exponential` the precise integration, `flow_tables` its sorting into in-phase and deviating
//! motion; `tables` puts them together, `pace` says in how many sub-steps, `certificate` what is promised of them.

mod certificate;
mod cost;
pub mod dynamics;
mod error;
pub mod exponential;
mod flow_tables;
pub mod hamiltonian;
pub mod light_tables;
pub mod modes;
mod pace;
mod processor;
mod source;
mod stability;
mod tables;
mod validate;

pub use certificate::certificate;
pub use cost::Cost;
pub use error::DesignError;
pub use pace::{Effort, Pace, Parts};
pub use processor::Processor;
pub use source::{rust_source, rust_source_for};
pub use tables::{design, design_scheme};
pub(crate) use validate::validate;

//! The offline half of the compensation: settings, and from them and a joint the tables.

mod body;
mod settings;
mod tables;

pub use settings::{CompensationSettings, compensation_settings};
pub use tables::design_compensation;

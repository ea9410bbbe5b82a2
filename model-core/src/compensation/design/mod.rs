//! The offline half of the compensation: settings, and from them and a joint the tables.

mod body;
mod damping;
mod settings;
mod stability;
mod tables;

pub use settings::{CompensationSettings, compensation_settings};
pub use tables::design_compensation;

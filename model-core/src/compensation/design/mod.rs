//! Offline part of the compensation: computes the tables from settings and a joint.

mod body;
mod damping;
#[cfg(test)]
mod demand_tests;
#[cfg(test)]
mod integral_tests;
#[cfg(test)]
mod inverse_tests;
#[cfg(test)]
mod load_swing_tests;
mod settings;
mod stability;
mod tables;
#[cfg(test)]
mod watch_tests;

pub use settings::{CompensationSettings, compensation_settings};
pub use stability::{BandwidthRange, bandwidth_range, good_bandwidth};
pub use tables::design_compensation;

//! Offline part of the compensation: computes the tables from settings and a joint.

mod body;
mod damping;
#[cfg(test)]
mod demand_estimator_tests;
#[cfg(test)]
mod integral_tests;
#[cfg(test)]
mod inverse_tests;
#[cfg(test)]
mod monitor_tests;
#[cfg(test)]
mod payload_swing_tests;
mod settings;
mod stability;
mod tables;

pub use settings::{CompensationSettings, compensation_settings};
pub use stability::{BandwidthRange, bandwidth_range, good_bandwidth};
pub use tables::design_compensation;

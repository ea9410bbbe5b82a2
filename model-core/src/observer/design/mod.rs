//! Offline design of the observer: settings, and tables computed from settings and joint.

pub(crate) mod body;
mod cogging;
#[cfg(test)]
mod dwell_noise_tests;
#[cfg(test)]
mod gap_variation_tests;
mod inertia;
mod probe;
mod settings;
mod sides;
mod source;
mod tables;
pub(crate) mod thresholds;

pub use probe::{design_probe, design_usual_probe};
pub(crate) use settings::NO_LIMIT;
pub use settings::{CLOCK_TICKS, EncoderSettings, ObserverSettings, observer_settings};
pub use source::observer_source;
pub(crate) use source::observer_text;
pub use tables::design_observer;

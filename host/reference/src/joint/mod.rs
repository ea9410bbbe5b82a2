//! Reference joint: eqs 1-6 of the paper in f64 and absolute coordinates with the sharp dead zone, integrated by an
//! adaptive method of order 8 that restarts at every contact event. It shares no matrix, force law or phase with the
//! core and reads parameters as plain data; the smoothed dead zone of eq. 13 is refused.
//!
//! `reference` advances the joint by `equations`, with parameters from `assembly` and mesh forces from `mesh_law`;
//! `start` defines initial states, `reading` computes an `observation`, `fixed_step` is a faster integration,
//! `hysteresis` is a slipping spring, `wear` changes teeth and link.

mod assembly;
mod equations;
mod fixed_step;
mod hysteresis;
mod mesh_law;
mod observation;
mod reading;
mod reference;
mod start;
mod validity;
mod wear;

pub use observation::{Observation, Work};
pub use reference::Reference;
pub use start::{RelativeState, Start};
pub use validity::ReferenceError;
pub use wear::mean_half_backlash;

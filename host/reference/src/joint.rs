//! The reference: eqs 1-6 of the paper in f64 and absolute coordinates with the sharp dead zone, integrated by an
//! adaptive method of order 8 that restarts at every contact event. It shares no matrix, force law or phase with the
//! core, whose parameters it reads as plain data; eq. 13's smoothed dead zone is refused.
//!
//! `reference` moves the joint by `equations`, with parameters from `assembly` and mesh forces from `mesh_law`; `start` has its
//! initial states, `reading` computes an `observation`, `fixed_step` is a faster integration, `hysteresis` is a spring that slips,
//! `wear` changes teeth and link.

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

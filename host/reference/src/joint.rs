//! The reference: eqs 1-6 of the paper in f64 and absolute coordinates with the sharp dead zone, integrated by an
//! adaptive method of order 8 that restarts at every contact event. It shares no matrix, force law or phase with the
//! core, whose parameters it reads as plain data; eq. 13's smoothed dead zone is refused.
//!
//! `reference` is the joint in motion by `equations`, whose numbers are by `assembly` and whose teeth are by `mesh_law`;
//! `start` is where it begins, `reading` makes an `observation` of it, `fixed_step` and `wear` move and change it in
//! other ways.

mod assembly;
mod equations;
mod fixed_step;
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

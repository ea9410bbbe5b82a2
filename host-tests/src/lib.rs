//! What the core is judged against: an independent f64 reference of the paper's equations, a drive train around it,
//! named scenarios, closed loops and every bound with its reason. But for the one controller in `closed_loop` that is
//! there to be judged, the core is never called from this library: its parameters are read as plain data, so that one
//! mistake cannot sit in both.

pub mod closed_loop;
pub mod drive_train;
pub mod integrator;
pub mod reference;
pub mod scenarios;
pub mod tolerance;

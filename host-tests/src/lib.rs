//! What the core is judged against: an independent f64 reference of the paper's equations, a drive train around it,
//! named scenarios and every bound with its reason. The core itself is never called from this library: its parameters
//! are read as plain data, so that one mistake cannot sit in both.

pub mod closed_loop;
pub mod drive_train;
pub mod integrator;
pub mod reference;
pub mod scenarios;
pub mod tolerance;

//! Reference for tests of the core: the paper's equations in f64, a drive train around them, rival controllers and
//! named scenarios. This crate reads parameters as plain data and never calls the core, so that both cannot share a
//! bug.

pub mod closed_loop;
pub mod drive_train;
pub mod integrator;
pub mod joint;
pub mod scenarios;

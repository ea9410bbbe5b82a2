//! What the core is judged against: an independent f64 reference of the paper's equations, a drive train around it,
//! rival controllers and named scenarios. It reads parameters as plain data and never calls the core, so that one mistake
//! cannot sit in both.

pub mod closed_loop;
pub mod drive_train;
pub mod integrator;
pub mod joint;
pub mod scenarios;

//! What follows from a joint file: masses, natural frequencies, lost motion, wind-up, the fixed step. Nothing is
//! simulated here.
//!
//! `derive` computes the `summary`, `step` asks the design for the fixed step, `layout` prints it.

mod derive;
mod layout;
mod step;
mod summary;
#[cfg(test)]
mod tests;

pub use derive::summary;
pub use layout::layout;
pub use summary::CheckSummary;

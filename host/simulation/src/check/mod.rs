//! Derived quantities of a joint file: masses, natural frequencies, lost motion, wind-up, the fixed step. Nothing is
//! simulated.
//!
//! `derive` computes the `summary`, `step` designs the fixed step, `layout` prints the summary.

mod derive;
mod layout;
mod step;
mod summary;
#[cfg(test)]
mod tests;

pub use derive::summary;
pub use layout::layout;
pub use summary::CheckSummary;

//! What follows from a joint file: masses, natural frequencies, lost motion, wind-up, the fixed step. Nothing is run here.
//!
//! `derive` computes the `figures`, `step` asks the design for the fixed step, `layout` puts them in order.

mod derive;
mod figures;
mod layout;
mod step;
#[cfg(test)]
mod tests;

pub use derive::figures;
pub use figures::Figures;
pub use layout::layout;

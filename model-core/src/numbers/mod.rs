//! Arithmetic with equal bits on every host and board: scalar trait of the core, sine and cosine of phases, clamp and dead
//! band, integer division, digests, random words, state as words, declaration of
//! thresholds.

pub(crate) mod arithmetic;
#[cfg(feature = "design")]
pub(crate) mod count_weights;
pub mod digest;
pub(crate) mod integers;
pub mod phase;
pub mod random;
mod real;
#[cfg(feature = "sensitivity")]
pub mod sensitivity;
pub mod state_words;
mod thresholds;

pub use real::Real;
pub(crate) use thresholds::thresholds;

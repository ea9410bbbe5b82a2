//! Arithmetic that gives the same bits on every host and board: the numbers that the step is written for, phases,
//! bounds, digests and random words.

pub(crate) mod arithmetic;
pub mod digest;
pub mod phase;
pub mod random;
mod real;

pub use real::Real;

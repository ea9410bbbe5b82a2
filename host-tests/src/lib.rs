//! Tolerances of all tests, each with its reason, the extent of long tests, and packages of other languages for tests. The
//! tests are in `tests/`.

pub mod extent;
pub mod packages;
pub mod tolerance;

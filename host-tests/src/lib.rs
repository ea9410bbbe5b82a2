//! Tolerances of all tests, each with its reason, and the extent of long tests. The tests are in `tests/`.

pub mod extent;
pub mod tolerance;

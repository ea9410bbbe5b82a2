//! Tolerances of all tests, each with its reason. The tests are in `tests/`.

pub mod tolerance;

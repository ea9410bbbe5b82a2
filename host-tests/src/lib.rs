//! Every bound that tests hold a number against, with its reason. The tests themselves are in `tests/`.

pub mod tolerance;

//! Behaviour of a joint, computed on the host: `check` derives figures from its file, `budget` predicts error and cost
//! of its fixed step on a board (`accuracy` measures, `verdicts` decides), `bandwidth` gives the widest bandwidth for
//! both, `sim` simulates a joint by a named scheme, `sweep` simulates every joint of a grid; `random`,
//! `encoder_zeros` and `recorded` are random values and recorded motions of tests.

pub mod accuracy;
pub mod bandwidth;
pub mod budget;
pub mod check;
pub mod encoder_zeros;
pub mod random;
pub mod recorded;
#[cfg(test)]
mod schema;
pub mod sim;
pub mod sweep;
pub mod verdicts;

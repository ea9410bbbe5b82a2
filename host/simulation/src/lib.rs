//! What a joint will do, computed on the host: `check` derives figures from its file, `budget` says error and cost of
//! its fixed step on a board (`accuracy` measures, `verdicts` judge), `bandwidth` says for both how fast its control may be, `sim` moves it
//! by a named scheme, `sweep` moves every joint of a grid.

pub mod accuracy;
pub mod bandwidth;
pub mod budget;
pub mod check;
#[cfg(test)]
mod schema;
pub mod sim;
pub mod sweep;
pub mod verdicts;

//! Budget of a joint's fixed step on a board at a rate: instructions, memory, limits, measured error, and a verdict on
//! the board's time. `summary` is the result as data, `layout` prints it.

mod layout;
mod summary;
#[cfg(test)]
mod tests;

pub use layout::layout;
pub use summary::{BudgetSummary, summary};

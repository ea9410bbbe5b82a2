//! The certificate of a joint's fixed step on a board at a rate: predicted error, instructions and memory, and whether
//! the board has time for it. Nothing is measured here.
//!
//! `verdict` judges, `summary` is the result as data, `layout` prints it.

mod layout;
mod summary;
#[cfg(test)]
mod tests;
mod verdict;

pub use layout::layout;
pub use summary::{BudgetSummary, summary};
pub use verdict::refuse;

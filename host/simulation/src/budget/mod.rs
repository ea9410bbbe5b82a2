//! What is promised of a joint's fixed step on a board at a rate, before anything is built or run, and whether the board has
//! time for it. Nothing is measured here.
//!
//! `verdict` judges, `figures` is the result as data, `layout` puts it in order.

mod figures;
mod layout;
#[cfg(test)]
mod tests;
mod verdict;

pub use figures::{Figures, figures};
pub use layout::layout;
pub use verdict::refuse;

//! `joint tables`: a joint's tables for programs in C.

pub use c_library::tables::Arguments;
use report::failure::Outcome;
use report::output;

/// Writes the tables and prints their path.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::print(&c_library::tables::run(arguments)?)
}

//! `joint tables`: a joint's tables for programs in C.

pub use c_library::tables::Arguments;
use report::failure::Outcome;
use report::output;

/// Writes them, and says where they are.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::print(&c_library::tables::run(arguments)?)
}

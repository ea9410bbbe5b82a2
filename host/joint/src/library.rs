//! `joint library`: the library for programs in C.

pub use c_library::package::Arguments;
use report::failure::Outcome;
use report::output;

/// Builds it, and says where it is.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::print(&c_library::package::run(arguments)?)
}

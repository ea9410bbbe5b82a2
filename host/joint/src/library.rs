//! `joint library`: the library for programs in C.

pub use c_library::package::Arguments;
use report::failure::Outcome;
use report::output;

/// Builds the library and prints the path of the archive.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::print(&c_library::package::run(arguments)?)
}

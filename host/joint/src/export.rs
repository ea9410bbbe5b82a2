//! `joint export`: a joint for other simulators.

pub use fmu::export::Arguments;
use report::failure::Outcome;
use report::output;

/// Writes the export and prints its path.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::print(&fmu::export::run(arguments)?)
}

//! `joint new`: writes a joint file from the numbers of a data sheet.

pub use data_sheet::Arguments;
use report::failure::Outcome;
use report::output;

/// Writes the joint file and prints the assumptions that it rests on.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::print(&data_sheet::run(arguments, true)?)
}

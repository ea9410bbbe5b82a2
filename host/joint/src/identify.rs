//! `joint identify`: estimates a joint's parameters from a recorded test.

pub use identify::Arguments;
use identify::run as identify;
use report::failure::Outcome;
use report::output;
use report::progress::Progress;

/// Identifies a joint, or simulates a log, and prints the result.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::keep_for_json(arguments.json.as_deref());
    Progress::during(|progress| output::print(&identify(arguments, progress)?))
}

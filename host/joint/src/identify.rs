//! `joint identify`: finds a joint's parameters in a recorded test.

pub use identify::Arguments;
use identify::run as identify;
use report::failure::Outcome;
use report::output;
use report::progress::Progress;

/// Identifies a joint, or makes a log of one, and prints what was found.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::keep_for_json(arguments.json.as_deref());
    Progress::during(|progress| output::print(&identify(arguments, progress)?))
}

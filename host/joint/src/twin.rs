//! `joint twin`: joints behind drives that clients of other makers command.

use report::failure::Outcome;
use report::output;
use report::progress::Progress;
pub use twin::Arguments;

/// Runs the twin until its time is over or the user ends it.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::keep_for_json(arguments.json.as_deref());
    Progress::during(|progress| twin::run(arguments, progress))
}

//! `joint replay`: runs an observer over a log.

pub use replay::ReplayArguments as Arguments;
use replay::run as replay;
use report::failure::Outcome;
use report::output;
use report::progress::Progress;

/// Replays a log and prints the result.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::keep_for_json(arguments.json.as_deref());
    Progress::during(|progress| output::print(&replay(arguments, progress)?))
}

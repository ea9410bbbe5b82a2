//! `joint sweep`: simulates every joint of a grid.

use report::failure::Outcome;
use report::output;
use report::progress::Progress;
use simulation::sweep;
pub use simulation::sweep::Arguments;

/// Runs a sweep and prints the path of the result, or the number of points that are left.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    Progress::during(|progress| output::print(&sweep::run(arguments, progress)?))
}

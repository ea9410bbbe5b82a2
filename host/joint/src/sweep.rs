//! `joint sweep`: simulates every joint of a grid.

use report::failure::Outcome;
use report::output;
use report::progress::Progress;
use simulation::sweep;
pub use simulation::sweep::Arguments;

/// Sweeps a grid and says where the result is, or what is left.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    Progress::during(|progress| output::print(&sweep::run(arguments, progress)?))
}

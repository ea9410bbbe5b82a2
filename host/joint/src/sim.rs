//! `joint sim`: simulates a joint on the host by a named scheme.

use report::failure::Outcome;
use report::output;
use report::progress::Progress;
use simulation::sim;
pub use simulation::sim::Arguments;

/// Simulates a joint and prints its figures.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    output::keep_for_json(arguments.json.as_deref());
    let done = Progress::during(|progress| sim::run(arguments, progress))?;
    arguments.json.as_ref().map_or(Ok(()), |path| output::write_json(path, &done.figures))?;
    let [csv, log] = done.history.each_ref().map(|path| path.display());
    let report = done.report.display();
    output::print(&format!("{}\nreport: {report}\nhistory: {csv}, {log}\n", done.summary))
}

//! `joint sim`: simulates a joint on the host by a named scheme.

use report::failure::Outcome;
use report::output;
use report::progress::Progress;
use report::write::write_text;
use simulation::sim;
pub use simulation::sim::Arguments;

/// Simulates a joint and tells its figures; with `--json -` as JSON.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    let done = Progress::during(|progress| sim::run(arguments, progress))?;
    match &arguments.json {
        Some(path) if path.as_os_str() == "-" => return output::print(&done.figures),
        Some(path) => write_text(path, &done.figures)?,
        None => {}
    }
    let [csv, log] = done.history.each_ref().map(|path| path.display());
    let report = done.report.display();
    output::print(&format!("{}\nreport: {report}\nhistory: {csv}, {log}\n", done.summary))
}

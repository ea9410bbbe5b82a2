//! Report of a recorded run, as HTML page, terminal lines or a picture for a document. Blocks and plots come from the
//! crate `report`; nothing is measured or judged here.

mod close_up;
mod motion;
mod origin;
mod sections;
mod timing;
mod whole;

pub use close_up::crossing;

use std::path::Path;

use report::plot::Figure;

use crate::record::RunRecord;
use report::document;
use report::failure::{Failure, Outcome};
use report::write::write_text;

/// Report as one HTML page without network access or scripts.
pub fn render(record: &RunRecord) -> String {
    document::html(&whole::document(record))
}

/// Checks as lines for a terminal, below a line that names the run.
pub fn render_lines(record: &RunRecord) -> String {
    document::terminal(&whole::document(record))
}

/// Picture of a reversal through the gap for a document; `None` if the run has no reversal.
pub fn picture(record: &RunRecord) -> Option<String> {
    let view = close_up::view(record)?;
    let note = origin::in_one_line(record);
    Some(Figure { note, ..close_up::figure(&view) }.to_file())
}

/// Writes [`picture`] to a file.
pub fn write_picture(record: &RunRecord, path: &Path) -> Outcome<()> {
    let svg = picture(record).ok_or_else(|| {
        Failure::new(format!("there is nothing to draw in {}: the gap was not crossed", path.display()))
            .with_help("choose a profile in which the load changes its sign, such as `--profile reversals`")
    })?;
    write_text(path, &svg)
}

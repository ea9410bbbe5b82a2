//! A log's file, CSV or MCAP, read into columns under the names that are known here.

use std::path::Path;

use super::columns::Columns;
use super::mcap_log;
use report::failure::{Failure, Outcome};
use report::input;

/// Reads a file by what it is; `renamed` holds pairs of a name here and one in the log.
pub fn read(path: &Path, topic: Option<&str>, renamed: &[(String, String)]) -> Outcome<Columns> {
    let failed = |what: &str| {
        Failure::new(format!("cannot read the log {}: {what}", path.display()))
            .with_help("`joint identify LOG --simulate` makes one without hardware")
    };
    let bytes = input::bytes(path, input::LARGEST_RECORDED).map_err(|why| failed(&why))?;
    let columns = if mcap_log::is_mcap(&bytes) {
        mcap_log::read(&bytes, topic, |columns| columns.heads().renamed(renamed).is_ok_and(|own| own.will_do()))
    } else if let Some(topic) = topic {
        let message = format!("it is no MCAP log, so it has no topic `{topic}`");
        Err(Failure::new(message).with_help("leave --topic out"))
    } else {
        let text =
            String::from_utf8(bytes).map_err(|_| failed("it is neither MCAP nor text (UTF-8): export it as CSV"))?;
        Columns::parse(&text)
    };
    columns.and_then(|columns| columns.renamed(renamed)).map_err(|failure| failure.while_doing(path.display()))
}

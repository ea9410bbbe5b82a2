//! A log's file, CSV or MCAP, read into columns under the names that are known here.

use std::path::Path;

use super::columns::Columns;
use super::mcap_log;
use report::failure::{Failure, Outcome};

/// Larger files are taken for a mistake.
const LARGEST_FILE: u64 = 2 << 30;

/// Reads a file by what it is; `renamed` holds pairs of a name here and one in the log.
pub fn read(path: &Path, topic: Option<&str>, renamed: &[(String, String)]) -> Outcome<Columns> {
    let failed = |what: &str| {
        Failure::new(format!("cannot read the log {}: {what}", path.display()))
            .with_help("`joint identify LOG --simulate` makes one without hardware")
    };
    let data = std::fs::metadata(path).map_err(|error| failed(&error.to_string()))?;
    if data.is_dir() {
        return Err(failed("it is a folder"));
    }
    if data.len() > LARGEST_FILE {
        return Err(failed("it is larger than 2 GB"));
    }
    let bytes = std::fs::read(path).map_err(|error| failed(&error.to_string()))?;
    let columns = if mcap_log::is_mcap(&bytes) {
        mcap_log::read(&bytes, topic, |columns| columns.clone().renamed(renamed).is_ok_and(|own| own.will_do()))
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

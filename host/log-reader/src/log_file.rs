//! File of a log, text in columns or MCAP, read into canonical columns in SI.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::column_map::ColumnMap;
use super::columns::Columns;
use super::{mcap_file, mcap_log, text_table, units};
use report::failure::{Failure, Outcome};
use report::input;
use report::log::REMARKS;

/// Reads a log of any kind; `accepts` accepts its columns, `ratio` is motor over output.
pub fn read(
    path: &Path,
    topic: Option<&str>,
    map: &ColumnMap,
    ratio: f64,
    accepts: impl Fn(&Columns) -> bool,
) -> Outcome<Columns> {
    LogFile::open(path)?.columns(topic, map, ratio, accepts)
}

/// File of a log.
pub struct LogFile {
    path: PathBuf,
    bytes: Vec<u8>,
}

impl LogFile {
    /// Reads the file's bytes.
    pub fn open(path: &Path) -> Outcome<Self> {
        let bytes = input::bytes(path, input::LARGEST_RECORDED).map_err(|why| unreadable(path, &why))?;
        Ok(Self { path: path.to_owned(), bytes })
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Remarks of the program that wrote the log; empty unless it is one of ours.
    pub fn remarks(&self) -> BTreeMap<String, String> {
        if mcap_log::is_mcap(&self.bytes) { mcap_file::metadata(&self.bytes, REMARKS) } else { BTreeMap::new() }
    }

    /// Columns of an MCAP topic under their own names.
    pub fn topic(&self, topic: &str) -> Outcome<Columns> {
        mcap_log::read(&self.bytes, Some(topic), |_| true, |_| true)
    }

    /// Canonical columns of the file.
    pub fn columns(
        &self,
        topic: Option<&str>,
        map: &ColumnMap,
        ratio: f64,
        accepts: impl Fn(&Columns) -> bool,
    ) -> Outcome<Columns> {
        let path = self.path.as_path();
        let columns = if mcap_log::is_mcap(&self.bytes) {
            let heads = |columns: &Columns| columns.without_rows().renamed(&map.columns);
            let [has_what_is_wanted, has_counts]: [&dyn Fn(&Columns) -> bool; 2] = [
                &|columns| heads(columns).is_ok_and(|own| accepts(&own)),
                // Topics with encoder counts take precedence: a simulated run also logs the true angles.
                &|columns| heads(columns).is_ok_and(|own| own.have_counts()),
            ];
            mcap_log::read(&self.bytes, topic, has_what_is_wanted, has_counts)
        } else if let Some(topic) = topic {
            let message = format!("it is not an MCAP log, so it has no topic `{topic}`");
            Err(Failure::new(message).with_help("leave --topic out"))
        } else {
            let text = std::str::from_utf8(&self.bytes)
                .map_err(|_| unreadable(path, "it is neither MCAP nor text (UTF-8): export it as CSV"))?;
            text_table::columns(text)
        };
        columns
            .and_then(|columns| under_known_names(columns, map, ratio))
            .map_err(|failure| failure.while_doing(path.display()))
    }
}

fn unreadable(path: &Path, why: &str) -> Failure {
    Failure::new(format!("cannot read the log {}: {why}", path.display()))
        .with_help("`joint identify LOG --simulate` makes a log without hardware")
}

fn under_known_names(columns: Columns, map: &ColumnMap, ratio: f64) -> Outcome<Columns> {
    // Without a header the columns' names are their numbers.
    if map.columns.is_empty() && columns.names().all(|name| name.parse::<usize>().is_ok()) {
        let message = format!("the log has no header that names its {} columns", columns.names().count());
        return Err(Failure::new(message).with_help(
            "name them by their numbers: --column time_s=1 --column motor_counts=2 --column output_counts=3",
        ));
    }
    units::convert(columns.renamed(&map.columns)?, &map.units, ratio)
}

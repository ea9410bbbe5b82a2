//! A log's file, text in columns or MCAP, read into columns under the names that are known here, in SI.

use std::path::Path;

use super::column_map::ColumnMap;
use super::columns::Columns;
use super::{mcap_log, text_table, units};
use report::failure::{Failure, Outcome};
use report::input;

/// Reads a file by what it is; `will_do` says whether columns are those that are wanted, `ratio` is motor over output.
pub fn read(
    path: &Path,
    topic: Option<&str>,
    map: &ColumnMap,
    ratio: f64,
    will_do: impl Fn(&Columns) -> bool,
) -> Outcome<Columns> {
    let failed = |what: &str| {
        Failure::new(format!("cannot read the log {}: {what}", path.display()))
            .with_help("`joint identify LOG --simulate` makes one without hardware")
    };
    let bytes = input::bytes(path, input::LARGEST_RECORDED).map_err(|why| failed(&why))?;
    let columns = if mcap_log::is_mcap(&bytes) {
        mcap_log::read(&bytes, topic, |columns| columns.heads().renamed(&map.columns).is_ok_and(|own| will_do(&own)))
    } else if let Some(topic) = topic {
        let message = format!("it is no MCAP log, so it has no topic `{topic}`");
        Err(Failure::new(message).with_help("leave --topic out"))
    } else {
        let text =
            String::from_utf8(bytes).map_err(|_| failed("it is neither MCAP nor text (UTF-8): export it as CSV"))?;
        text_table::columns(&text)
    };
    columns
        .and_then(|columns| under_known_names(columns, map, ratio))
        .map_err(|failure| failure.while_doing(path.display()))
}

fn under_known_names(columns: Columns, map: &ColumnMap, ratio: f64) -> Outcome<Columns> {
    // Without a header columns are called by their numbers.
    if map.columns.is_empty() && columns.names().all(|name| name.parse::<usize>().is_ok()) {
        let message = format!("the log has no header: which of its {} columns are what?", columns.names().count());
        return Err(Failure::new(message).with_help(
            "name them by their numbers: --column time_s=1 --column motor_counts=2 --column output_counts=3",
        ));
    }
    units::convert(columns.renamed(&map.columns)?, &map.units, ratio)
}

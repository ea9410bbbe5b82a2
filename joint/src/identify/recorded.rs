//! Reads the MCAP logs that `joint hil` and `joint sim` leave, by the names in their schema. Logs of other programs are
//! left out: they are exported as CSV.

use super::columns::Columns;
use crate::failure::{Failure, Outcome};

/// An MCAP file begins so.
pub const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Head of a CDR message: little endian.
const HEAD: [u8; 4] = [0, 1, 0, 0];

/// Numbers that stand first in every message, under the schema's names.
pub fn columns(bytes: &[u8]) -> Outcome<Columns> {
    let failed = |what: &str| {
        Failure::new(format!("the MCAP log cannot be used: {what}"))
            .with_help("logs of `joint hil FILE --host` are understood; export others as CSV")
    };
    let stream = mcap::MessageStream::new(bytes).map_err(|error| failed(&error.to_string()))?;
    let (mut names, mut rows): (Vec<String>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    for message in stream {
        let message = message.map_err(|error| failed(&error.to_string()))?;
        let schema = message.channel.schema.as_ref().ok_or_else(|| failed("it has no schema"))?;
        if names.is_empty() {
            let text = String::from_utf8_lossy(&schema.data).into_owned();
            let fields = text.lines().map_while(|line| line.strip_prefix("float64 "));
            names = fields.filter_map(|line| line.split_whitespace().next()).map(ToOwned::to_owned).collect();
        }
        let numbers = message.data.strip_prefix(&HEAD).ok_or_else(|| failed("its messages are not CDR"))?;
        let row: Vec<f64> =
            numbers.chunks_exact(8).filter_map(|bytes| Some(f64::from_le_bytes(bytes.try_into().ok()?))).collect();
        if row.len() < names.len() {
            return Err(failed("a message is shorter than its schema"));
        }
        rows.push(row);
    }
    if names.is_empty() || rows.is_empty() {
        return Err(failed("there is no message in it"));
    }
    Ok(Columns::of_messages(names, &rows))
}

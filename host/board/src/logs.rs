//! Decodes the board's log: defmt frames, with the image that wrote them. Without the image the bytes are kept
//! undecoded.

use std::path::Path;

use defmt_decoder::{DecodeError, Table};

use report::failure::{Failure, Outcome};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A decoded log line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct LogLine {
    /// The board's own time stamp, as printed.
    pub timestamp: String,
    /// `error`, `warn`, `info`, `debug`, `trace`, or empty.
    pub level: String,
    /// The message.
    pub text: String,
}

/// Decoded log of a board.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Log {
    /// Decoded lines, oldest first.
    pub lines: Vec<LogLine>,
    /// Entries that could not be decoded, for example after a lost frame.
    pub malformed: u32,
}

/// Decodes a log with the image that wrote it.
pub fn decode(bytes: &[u8], image: &Path) -> Outcome<Log> {
    let failure =
        |what: String| Failure::new(format!("cannot decode the board's log with {}: {what}", image.display()));
    let elf = std::fs::read(image).map_err(|error| failure(error.to_string()))?;
    let table = Table::parse(&elf).map_err(|error| failure(error.to_string()))?;
    let table = table.ok_or_else(|| failure("the image holds no defmt table".to_owned()))?;
    let mut decoder = table.new_stream_decoder();
    decoder.received(bytes);
    let mut log = Log::default();
    loop {
        match decoder.decode() {
            Ok(frame) => log.lines.push(LogLine {
                timestamp: frame.display_timestamp().map(|time| time.to_string()).unwrap_or_default(),
                level: frame.level().map(|level| level.as_str().to_owned()).unwrap_or_default(),
                text: frame.display_message().to_string(),
            }),
            Err(DecodeError::UnexpectedEof) => return Ok(log),
            Err(DecodeError::Malformed) if table.encoding().can_recover() => log.malformed += 1,
            Err(DecodeError::Malformed) => return Err(failure("it was written by another image".to_owned())),
        }
    }
}

/// Text file of the log.
pub fn text(lines: &[LogLine]) -> String {
    lines.iter().map(|line| format!("{} {:5} {}\n", line.timestamp, line.level, line.text)).collect()
}

//! Messages of an MCAP file in order. A file may be damaged or malicious: lengths are checked against the bytes present
//! before memory is reserved, and the unpacked size of chunks against the file's size.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::Arc;

use mcap::read::ChannelAccumulator;
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{Channel, MAGIC, McapError, parse_record};

/// Bytes of opcode and length before a record's content.
const RECORD_HEADER_SIZE: usize = 1 + 8;
/// Largest unpacked size over the file's size, plus UNPACKED_BASE bytes: joint states pack to a tenth at best.
const UNPACKED_FACTOR_MAX: u64 = 256;
const UNPACKED_BASE: u64 = 1 << 20;
/// Longest name of a topic [bytes].
const TOPIC_LENGTH_MAX: usize = 1024;

/// Message of a file.
pub struct Message<'m> {
    /// Channel of the message.
    pub channel: Arc<Channel<'static>>,
    /// Time of recording [ns].
    pub log_time: u64,
    /// Content of the message.
    pub data: &'m [u8],
}

/// Callback for each message; its error ends the reading.
pub type MessageCallback<'t, E> = dyn FnMut(&Message<'_>) -> Result<(), E> + 't;

/// Reason why reading ended early.
pub enum ReadEnd<E> {
    /// Place and kind of the damage.
    Damaged(String),
    /// Error of the callback.
    Callback(E),
}

/// State of reading a file.
struct FileReader<'r, E> {
    channels: ChannelAccumulator<'static>,
    /// Remaining unpacked size of chunks [bytes].
    room: u64,
    on_message: &'r mut MessageCallback<'r, E>,
}

/// Metadata of a name, joined over all records; empty for a file that is damaged before its end.
pub fn metadata(bytes: &[u8], name: &str) -> BTreeMap<String, String> {
    let options = LinearReaderOptions::default().with_emit_chunks(true).with_record_length_limit(bytes.len());
    let mut found = BTreeMap::new();
    let read = each_record(
        options,
        bytes,
        |_| (),
        |opcode, data| {
            if opcode == op::METADATA && check_texts(opcode, data).is_ok() {
                match parse_record(opcode, data) {
                    Ok(Record::Metadata(known)) if known.name == name => found.extend(known.metadata),
                    _ => {}
                }
            }
            Ok(())
        },
    );
    if read.is_ok() { found } else { BTreeMap::new() }
}

/// Passes all messages of a file to `on_message`.
pub fn read<'r, E>(bytes: &'r [u8], on_message: &'r mut MessageCallback<'r, E>) -> Result<(), ReadEnd<E>> {
    let room = UNPACKED_FACTOR_MAX.saturating_mul(bytes.len() as u64).saturating_add(UNPACKED_BASE);
    let mut reading = FileReader { channels: ChannelAccumulator::default(), room, on_message };
    let options = LinearReaderOptions::default()
        .with_emit_chunks(true)
        .with_validate_data_section_crc(true)
        .with_record_length_limit(bytes.len());
    let (at, mut ended) = (Cell::new(MAGIC.len()), false);
    let damaged = |error: McapError| ReadEnd::Damaged(format!("record at byte {}: {error}", at.get()));
    each_record(options, bytes, damaged, |opcode, data| {
        let here = at.get();
        at.set(here + RECORD_HEADER_SIZE + data.len());
        // The summary behind the data section repeats records.
        ended |= opcode == op::DATA_END;
        let one = match opcode {
            _ if ended => Ok(()),
            op::CHUNK => reading.read_chunk(data, bytes.get(here..at.get()).unwrap_or_default()),
            _ => reading.read_record(opcode, data),
        };
        one.map_err(|broken| match broken {
            ReadEnd::Damaged(why) => ReadEnd::Damaged(format!("{} at byte {here}: {why}", word(opcode))),
            refused => refused,
        })
    })
}

impl<E> FileReader<'_, E> {
    /// Handles a record of the file or of a chunk; records irrelevant to messages are skipped unread.
    fn read_record(&mut self, opcode: u8, data: &[u8]) -> Result<(), ReadEnd<E>> {
        if ![op::SCHEMA, op::CHANNEL, op::MESSAGE].contains(&opcode) {
            return Ok(());
        }
        check_texts(opcode, data).map_err(ReadEnd::Damaged)?;
        match parse_record(opcode, data)? {
            Record::Schema { header, data } => self.channels.add_schema_from_slice(header, &data)?,
            Record::Channel(channel) if channel.topic.len() > TOPIC_LENGTH_MAX => {
                let why = format!("the name of a topic has {} letters", channel.topic.len());
                return Err(ReadEnd::Damaged(why));
            }
            Record::Channel(channel) => self.channels.add_channel(channel)?,
            Record::Message { header, data } => {
                let known = self.channels.get(header.channel_id);
                let channel = known.ok_or(McapError::UnknownChannel(header.sequence, header.channel_id))?;
                let message = Message { channel, log_time: header.log_time, data: &data };
                (self.on_message)(&message).map_err(ReadEnd::Callback)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Handles a chunk: its content, and the whole record of the file.
    fn read_chunk(&mut self, content: &[u8], whole: &[u8]) -> Result<(), ReadEnd<E>> {
        check_texts(op::CHUNK, content).map_err(ReadEnd::Damaged)?;
        let Record::Chunk { header, data } = parse_record(op::CHUNK, content)? else { return Ok(()) };
        let ChunkHeader { uncompressed_size: size, compression, .. } = header;
        self.room = self.room.checked_sub(size).ok_or_else(|| {
            ReadEnd::Damaged(format!(
                "its stated unpacked size is {size} bytes, far more than a file of this size holds"
            ))
        })?;
        if compression.is_empty() {
            check_plain(&data, size).map_err(ReadEnd::Damaged)?;
        }
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(usize::try_from(size).unwrap_or(usize::MAX).max(whole.len()));
        each_record(options, whole, ReadEnd::from, |opcode, data| self.read_record(opcode, data))
    }
}

impl<E> From<McapError> for ReadEnd<E> {
    fn from(error: McapError) -> Self {
        Self::Damaged(error.to_string())
    }
}

/// Checks that an uncompressed chunk holds whole records and nothing else, which the library assumes.
fn check_plain(data: &[u8], size: u64) -> Result<(), String> {
    if data.len() as u64 != size {
        return Err(format!("its stated size is {size} bytes, but it has {}", data.len()));
    }
    let mut rest = data;
    while !rest.is_empty() {
        let length =
            rest.get(1..RECORD_HEADER_SIZE).and_then(|length| Some(u64::from_le_bytes(length.try_into().ok()?)));
        let whole = length.and_then(|length| usize::try_from(length).ok()?.checked_add(RECORD_HEADER_SIZE));
        rest = whole.and_then(|whole| rest.get(whole..)).ok_or("a record extends beyond its end")?;
    }
    Ok(())
}

/// Checks the lengths of a record's texts against its bytes: the library reserves memory by these lengths before it
/// reads.
fn check_texts(opcode: u8, data: &[u8]) -> Result<(), String> {
    let whole = || {
        // Bytes before the first text, and number of consecutive texts.
        let (before, texts) = match opcode {
            op::SCHEMA => (2, 2),
            op::CHANNEL => (4, 2),
            op::CHUNK => (28, 1),
            op::METADATA => (0, 1),
            _ => return Some(()),
        };
        let mut rest = data.get(before..)?;
        for _ in 0..texts {
            rest = behind_text(rest)?;
        }
        if [op::CHANNEL, op::METADATA].contains(&opcode) {
            // Pairs of texts, preceded by their length in bytes.
            let (length, pairs) = rest.split_first_chunk()?;
            let mut pairs = pairs.get(..usize::try_from(u32::from_le_bytes(*length)).ok()?)?;
            while !pairs.is_empty() {
                pairs = behind_text(behind_text(pairs)?)?;
            }
        }
        Some(())
    };
    whole().ok_or_else(|| "a text extends beyond its end".to_owned())
}

/// Bytes behind a text that is preceded by its length.
fn behind_text(bytes: &[u8]) -> Option<&[u8]> {
    let (length, text) = bytes.split_first_chunk()?;
    text.get(usize::try_from(u32::from_le_bytes(*length)).ok()?..)
}

/// Passes the records of the bytes to `on_message`.
fn each_record<B>(
    options: LinearReaderOptions,
    mut bytes: &[u8],
    damaged: impl Fn(McapError) -> B,
    mut on_message: impl FnMut(u8, &[u8]) -> Result<(), B>,
) -> Result<(), B> {
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event.map_err(&damaged)? {
            LinearReadEvent::ReadRequest(wanted) => {
                let (now, later) = bytes.split_at(wanted.min(bytes.len()));
                reader.insert(now.len()).copy_from_slice(now);
                reader.notify_read(now.len());
                bytes = later;
            }
            LinearReadEvent::Record { opcode, data } => on_message(opcode, data)?,
        }
    }
    Ok(())
}

fn word(opcode: u8) -> String {
    match opcode {
        op::SCHEMA => "schema".to_owned(),
        op::CHANNEL => "channel".to_owned(),
        op::MESSAGE => "message".to_owned(),
        op::CHUNK => "chunk".to_owned(),
        other => format!("record of kind {other}"),
    }
}

#[cfg(test)]
mod tests;

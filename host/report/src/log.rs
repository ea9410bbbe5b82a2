//! Logs as MCAP, which Foxglove and PlotJuggler open: ROS 2 message text as the schema of a topic, CDR as its encoding.
//! Chunks are written as a whole, so a truncated log is readable up to its last chunk. Numbers are in SI under the
//! names of CSV and JSON in lower case, as ROS 2 requires; states are words.

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Compression, McapError, WriteOptions, Writer};

/// Size of a chunk before compression [bytes]: the largest loss in a crash.
const CHUNK_BYTES: u64 = 128 << 10;
/// Name of the metadata with the origin of a log.
pub const REMARKS: &str = "joint";
/// Header of a message in CDR: little endian.
const CDR_HEADER: [u8; 4] = [0, 1, 0, 0];

/// A log with any number of topics.
pub struct Log<W: Write> {
    writer: Writer<NoSeek<W>>,
}

/// Channel for messages of one schema.
#[derive(Debug)]
pub struct Topic {
    channel: u16,
    sequence: u32,
}

impl<W: Write> Log<W> {
    /// Starts a log; `remarks` state its origin.
    pub fn begin(out: W, remarks: BTreeMap<String, String>) -> io::Result<Self> {
        let options = WriteOptions::new()
            .compression(Some(Compression::Zstd))
            .chunk_size(Some(CHUNK_BYTES))
            .library(concat!("joint ", env!("CARGO_PKG_VERSION")))
            .disable_seeking(true);
        let mut writer = Writer::with_options(NoSeek::new(out), options).map_err(cause)?;
        writer.write_metadata(&Metadata { name: REMARKS.into(), metadata: remarks }).map_err(cause)?;
        Ok(Self { writer })
    }

    /// Adds a topic; `schema` is ROS 2 message text.
    pub fn topic(&mut self, topic: &str, name: &str, schema: &str) -> io::Result<Topic> {
        let schema = self.writer.add_schema(name, "ros2msg", schema.as_bytes()).map_err(cause)?;
        let channel = self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).map_err(cause)?;
        Ok(Topic { channel, sequence: 0 })
    }

    /// Writes a message at a time of the run [s].
    pub fn write(&mut self, topic: &mut Topic, time: f64, message: &Message) -> io::Result<()> {
        let nanoseconds = (time * 1e9).round() as u64;
        let header = MessageHeader {
            channel_id: topic.channel,
            sequence: topic.sequence,
            log_time: nanoseconds,
            publish_time: nanoseconds,
        };
        topic.sequence = topic.sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, &message.0).map_err(cause)
    }

    /// Writes the index and the end marker, without which readers report a damaged log.
    pub fn finish(mut self) -> io::Result<W> {
        self.writer.finish().map_err(cause)?;
        let mut out = self.writer.into_inner().into_inner();
        out.flush()?;
        Ok(out)
    }
}

/// A log with one topic.
pub struct Channel<W: Write> {
    log: Log<W>,
    topic: Topic,
}

impl<W: Write> Channel<W> {
    /// Starts a log; `schema` is ROS 2 message text, `remarks` state its origin.
    pub fn begin(out: W, topic: &str, name: &str, schema: &str, remarks: BTreeMap<String, String>) -> io::Result<Self> {
        let mut log = Log::begin(out, remarks)?;
        let topic = log.topic(topic, name, schema)?;
        Ok(Self { log, topic })
    }

    /// Writes a message at a time of the run [s].
    pub fn write(&mut self, time: f64, message: &Message) -> io::Result<()> {
        self.log.write(&mut self.topic, time, message)
    }

    /// Finishes the log.
    pub fn finish(self) -> io::Result<W> {
        self.log.finish()
    }
}

/// Extracts the system's error, if there is one.
fn cause(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}

/// A message in CDR: every value is aligned to its size, counted after the header.
#[derive(Debug)]
pub struct Message(Vec<u8>);

impl Default for Message {
    fn default() -> Self {
        Self(CDR_HEADER.to_vec())
    }
}

impl Message {
    /// Appends a `float64`.
    pub fn number(&mut self, value: f64) {
        self.align(8);
        self.0.extend(value.to_le_bytes());
    }

    /// Appends a `float32`.
    pub fn single(&mut self, value: f32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    /// Appends a `uint32`.
    pub fn whole(&mut self, value: u32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    /// Appends a `bool`.
    pub fn flag(&mut self, set: bool) {
        self.0.push(set.into());
    }

    /// Appends a `float64[]`.
    pub fn numbers(&mut self, values: impl ExactSizeIterator<Item = f64>) {
        self.count(values.len());
        values.for_each(|value| self.number(value));
    }

    /// Appends a `string`.
    pub fn word(&mut self, word: &str) {
        self.count(word.len() + 1);
        self.0.extend(word.as_bytes());
        self.0.push(0);
    }

    /// Appends a `string[]`.
    pub fn words<'w>(&mut self, words: impl ExactSizeIterator<Item = &'w str>) {
        self.count(words.len());
        words.for_each(|word| self.word(word));
    }

    /// Bytes of the message with their header.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }

    fn count(&mut self, count: usize) {
        self.whole(count as u32);
    }

    /// Pads to a multiple of a size, counted after the header.
    fn align(&mut self, size: usize) {
        self.0.resize(CDR_HEADER.len() + (self.0.len() - CDR_HEADER.len()).next_multiple_of(size), 0);
    }
}

/// Line of a field in a message's schema.
pub fn field(kind: &str, name: &str, meaning: &str) -> String {
    format!("{kind} {}  # {meaning}\n", name.to_ascii_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_aligned_to_their_size() {
        let mut message = Message::default();
        message.words(["ab", "c"].into_iter());
        message.number(1.0);
        message.numbers([2.0].into_iter());
        message.flag(true);
        message.whole(5);
        message.single(0.5);
        let mut expected = vec![0, 1, 0, 0];
        expected.extend([2, 0, 0, 0, 3, 0, 0, 0, b'a', b'b', 0, 0, 2, 0, 0, 0, b'c', 0, 0, 0, 0, 0, 0, 0]);
        expected.extend(1.0_f64.to_le_bytes());
        expected.extend([1, 0, 0, 0, 0, 0, 0, 0]);
        expected.extend(2.0_f64.to_le_bytes());
        expected.extend([1, 0, 0, 0, 5, 0, 0, 0]);
        expected.extend(0.5_f32.to_le_bytes());
        assert_eq!(message.0, expected);
    }

    #[test]
    fn field_names_follow_ros_rules() {
        assert_eq!(field("float64", "drive_torque_Nm", "[N m]"), "float64 drive_torque_nm  # [N m]\n");
    }
}

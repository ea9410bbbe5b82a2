//! The history of a run as an MCAP log, which Foxglove and PlotJuggler open: one topic, ROS 2 message text as its schema,
//! CDR as its encoding. Chunks are written whole, so that a log that was cut off can be read up to its last chunk.

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Compression, McapError, WriteOptions, Writer};
use parameters::JointParameters;

use super::quantities::{QUANTITIES, code};
use super::snapshot::Snapshot;

/// Topic of the motion.
pub const TOPIC: &str = "/joint/motion";
/// Name of its schema.
pub const SCHEMA_NAME: &str = "joint_msgs/msg/Motion";
/// Bytes of a chunk before compression: what a crash may cost at most.
const CHUNK: u64 = 128 << 10;

/// Fields that hold one number for each planet.
const LISTS: [(&str, &str); 6] = [
    ("sun_planet_deflection_um", "[um]"),
    ("ring_planet_deflection_um", "[um]"),
    ("sun_planet_force_n", "[N]"),
    ("ring_planet_force_n", "[N]"),
    ("sun_planet_contact", "0 parted, 1 drive side, 2 back side"),
    ("ring_planet_contact", "likewise"),
];

/// The message as ROS 2 writes it down.
pub fn schema() -> String {
    let numbers = QUANTITIES.iter().map(|quantity| (quantity.field, quantity.meaning));
    let numbers = numbers.chain([("time_s", "since the start [s]")]);
    let numbers = numbers.map(|(name, meaning)| format!("float64 {name}  # {meaning}\n"));
    let lists = LISTS.iter().map(|(name, meaning)| format!("float64[] {name}  # {meaning}, one for each planet\n"));
    numbers.chain(lists).collect()
}

/// Writes messages of one schema to one topic.
pub struct Channel<W: Write> {
    writer: Writer<NoSeek<W>>,
    channel: u16,
    sequence: u32,
}

impl<W: Write> Channel<W> {
    /// Begins a log; `schema` is ROS 2 message text, `remarks` say where it comes from.
    pub fn begin(out: W, topic: &str, name: &str, schema: &str, remarks: BTreeMap<String, String>) -> io::Result<Self> {
        let options = WriteOptions::new()
            .compression(Some(Compression::Lz4))
            .chunk_size(Some(CHUNK))
            .library(concat!("joint ", env!("CARGO_PKG_VERSION")))
            .disable_seeking(true);
        let mut writer = Writer::with_options(NoSeek::new(out), options).map_err(cause)?;
        let schema = writer.add_schema(name, "ros2msg", schema.as_bytes()).map_err(cause)?;
        let channel = writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).map_err(cause)?;
        writer.write_metadata(&Metadata { name: "joint".into(), metadata: remarks }).map_err(cause)?;
        Ok(Self { writer, channel, sequence: 0 })
    }

    /// One message in CDR, at a time of the run [s].
    pub fn write(&mut self, time: f64, message: &[u8]) -> io::Result<()> {
        let nanoseconds = (time * 1e9).round() as u64;
        let header = MessageHeader {
            channel_id: self.channel,
            sequence: self.sequence,
            log_time: nanoseconds,
            publish_time: nanoseconds,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, message).map_err(cause)
    }

    /// Writes the index and the end, without which readers call a log damaged.
    pub fn finish(mut self) -> io::Result<W> {
        self.writer.finish().map_err(cause)?;
        let mut out = self.writer.into_inner().into_inner();
        out.flush()?;
        Ok(out)
    }
}

/// The system's error, if it was one.
fn cause(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}

/// A moment as a message in CDR: little endian, numbers on multiples of their size behind a head of four bytes.
pub fn encoded(joint: &JointParameters, snapshot: &Snapshot) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    let number = |bytes: &mut Vec<u8>, value: f64| bytes.extend(value.to_le_bytes());
    let micro = |value: f64| 1e6 * value;
    for quantity in &QUANTITIES {
        number(&mut bytes, quantity.scale * (quantity.value)(snapshot, joint));
    }
    number(&mut bytes, snapshot.time);
    let (sun, ring) = snapshot.teeth.split_at(snapshot.teeth.len() / 2);
    let lists: [Vec<f64>; LISTS.len()] = [
        sun.iter().map(|teeth| micro(teeth.deflection)).collect(),
        ring.iter().map(|teeth| micro(teeth.deflection)).collect(),
        sun.iter().map(|teeth| teeth.force).collect(),
        ring.iter().map(|teeth| teeth.force).collect(),
        sun.iter().map(|teeth| code(teeth.contact).into()).collect(),
        ring.iter().map(|teeth| code(teeth.contact).into()).collect(),
    ];
    for list in lists {
        bytes.extend((list.len() as u32).to_le_bytes());
        // The head does not count for alignment.
        bytes.resize(4 + (bytes.len() - 4).next_multiple_of(8), 0);
        list.into_iter().for_each(|value| number(&mut bytes, value));
    }
    bytes
}

//! MCAP logs by content: topics with their schemas and metadata, and every message by its fields. Chunks, compression and index do not
//! count.

use std::collections::BTreeMap;

use mcap::read::ChunkFlattener;
use mcap::records::{MessageHeader, Record};

use crate::ignored::ignored_key;
use crate::listing::{Listing, Row};
use crate::ros::MessageLayout;

/// One topic.
struct Topic {
    name: String,
    layout: Option<MessageLayout>,
    /// Rows: the first describes the topic, all others are messages.
    rows: Vec<Row>,
}

/// Reads a log; fails if it cannot be read.
pub fn read(log: &[u8]) -> Result<Listing, String> {
    let (mut listing, mut about) = (Listing::default(), Row::default());
    let (mut schemas, mut topics) = (BTreeMap::new(), BTreeMap::new());
    for record in ChunkFlattener::new(log).map_err(|error| error.to_string())? {
        match record.map_err(|error| error.to_string())? {
            Record::Header(header) => {
                remark(&mut about, "profile", &header.profile, &mut listing);
                remark(&mut about, "library", &header.library, &mut listing);
            }
            Record::Schema { header, data } => {
                schemas.insert(header.id, (header, String::from_utf8_lossy(&data).into_owned()));
            }
            // The index at a log's end repeats each topic.
            Record::Channel(channel) if !topics.contains_key(&channel.id) => {
                let mut row = Row::at(&channel.topic);
                channel.metadata.iter().for_each(|(key, value)| remark(&mut row, key, value, &mut listing));
                remark(&mut row, "message encoding", &channel.message_encoding, &mut listing);
                let schema = schemas.get(&channel.schema_id);
                if let Some((header, text)) = schema {
                    remark(&mut row, "schema name", &header.name, &mut listing);
                    remark(&mut row, "schema encoding", &header.encoding, &mut listing);
                    remark(&mut row, "schema", text, &mut listing);
                }
                let layout = schema.and_then(|(_, text)| MessageLayout::from_schema(text));
                topics.insert(channel.id, Topic { name: channel.topic, layout, rows: vec![row] });
            }
            Record::Message { header, data } => {
                let topic = topics.get_mut(&header.channel_id).ok_or("a message has no topic")?;
                topic.rows.push(message(topic, &header, &data));
            }
            Record::Metadata(metadata) => {
                for (key, value) in &metadata.metadata {
                    remark(&mut about, &format!("{}.{key}", metadata.name), value, &mut listing);
                }
            }
            Record::Attachment { header, data, .. } => {
                remark(&mut about, &format!("attachment {}", header.name), &format!("{:?}", &*data), &mut listing);
            }
            _ => {}
        }
    }
    // Topics are matched by name, whatever the order of their messages.
    let mut topics: Vec<Topic> = topics.into_values().collect();
    topics.sort_by(|a, b| a.name.cmp(&b.name));
    listing.rows = std::iter::once(about).chain(topics.into_iter().flat_map(|topic| topic.rows)).collect();
    Ok(listing)
}

fn remark(row: &mut Row, key: &str, value: &str, listing: &mut Listing) {
    match ignored_key(key) {
        Some(rule) => listing.hidden.push((rule, value.to_owned())),
        None => row.push(key, listing.masked(value)),
    }
}

fn message(topic: &Topic, header: &MessageHeader, data: &[u8]) -> Row {
    let mut row = Row::at(format!("{} message {}", topic.name, topic.rows.len() - 1));
    row.push("topic", &*topic.name);
    let times = [("log time", header.log_time), ("publish time", header.publish_time)];
    times.into_iter().for_each(|(name, time)| row.push(name, time.to_string()));
    row.push("sequence", header.sequence.to_string());
    match topic.layout.as_ref().and_then(|layout| layout.decode(data)) {
        Some(fields) => fields.into_iter().for_each(|(name, numbers)| row.push(name, number_list(&numbers))),
        None => row.push("bytes", data.escape_ascii().to_string()),
    }
    row
}

/// Text of some numbers, different for any two different lists of bits.
fn number_list(numbers: &[f64]) -> String {
    let text = |number: &f64| match number.is_nan() {
        true => format!("NaN {:x}", number.to_bits()),
        false => format!("{number:?}"),
    };
    format!("[{}]", numbers.iter().map(text).collect::<Vec<_>>().join(", "))
}

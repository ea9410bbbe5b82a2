//! MCAP logs by what is in them: topics with their schemas and remarks, and every message by its fields. How a log is cut
//! into chunks, compressed and indexed does not count.

use std::collections::BTreeMap;

use mcap::read::ChunkFlattener;
use mcap::records::{MessageHeader, Record};

use crate::findings::Findings;
use crate::ignored::ignored_key;
use crate::mask::masked;
use crate::ros::decoded;

/// A message, and when it was written.
type Message = (MessageHeader, Vec<u8>);

/// One topic.
#[derive(Debug, Default)]
struct Topic {
    /// What it is: encodings, name and text of its schema.
    about: BTreeMap<String, String>,
    schema: String,
    messages: Vec<Message>,
}

/// A whole log.
#[derive(Debug, Default)]
struct Log {
    about: BTreeMap<String, String>,
    topics: BTreeMap<String, Topic>,
}

/// Compares two logs; fails if one cannot be read.
pub fn compare(old: &[u8], new: &[u8], findings: &mut Findings) -> Result<(), String> {
    let (old, new) = (read(old)?, read(new)?);
    compare_remarks("", &old.about, &new.about, findings);
    for (name, topic) in &old.topics {
        match new.topics.get(name) {
            Some(other) => compare_topics(name, topic, other, findings),
            None => findings.differs(name, Some(format!("{} messages", topic.messages.len())), None),
        }
    }
    for (name, topic) in new.topics.iter().filter(|(name, _)| !old.topics.contains_key(*name)) {
        findings.differs(name, None, Some(format!("{} messages", topic.messages.len())));
    }
    Ok(())
}

fn read(log: &[u8]) -> Result<Log, String> {
    let mut found = Log::default();
    let (mut schemas, mut names) = (BTreeMap::new(), BTreeMap::new());
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    for record in ChunkFlattener::new(log).map_err(|error| error.to_string())? {
        match record.map_err(|error| error.to_string())? {
            Record::Header(header) => {
                found.about.insert("profile".into(), header.profile);
                found.about.insert("library".into(), header.library);
            }
            Record::Schema { header, data } => {
                schemas.insert(header.id, (header.name, header.encoding, text(&data)));
            }
            Record::Channel(channel) => {
                let topic = found.topics.entry(channel.topic.clone()).or_default();
                topic.about = channel.metadata;
                topic.about.insert("message encoding".into(), channel.message_encoding);
                if let Some((name, encoding, schema)) = schemas.get(&channel.schema_id) {
                    topic.about.insert("schema name".into(), name.clone());
                    topic.about.insert("schema encoding".into(), encoding.clone());
                    topic.about.insert("schema".into(), schema.clone());
                    topic.schema.clone_from(schema);
                }
                names.insert(channel.id, channel.topic);
            }
            Record::Message { header, data } => {
                let name: &String = names.get(&header.channel_id).ok_or("a message has no topic")?;
                found.topics.entry(name.clone()).or_default().messages.push((header, data.into_owned()));
            }
            Record::Metadata(metadata) => {
                let name = metadata.name;
                found.about.extend(metadata.metadata.into_iter().map(|(key, value)| (format!("{name}.{key}"), value)));
            }
            Record::Attachment { header, data, .. } => {
                found.about.insert(format!("attachment {}", header.name), format!("{:?}", &*data));
            }
            _ => {}
        }
    }
    Ok(found)
}

fn compare_remarks(
    place: &str,
    old: &BTreeMap<String, String>,
    new: &BTreeMap<String, String>,
    findings: &mut Findings,
) {
    let keys: std::collections::BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    for key in keys {
        let (a, b) = (old.get(key), new.get(key));
        let words = |text: Option<&String>| text.map(|text| masked(text).words);
        match ignored_key(&key.split('.').collect::<Vec<_>>()) {
            Some(rule) => findings.leave_out(rule, a != b),
            None if words(a) == words(b) => findings.same(1),
            None => findings.differs(format!("{place}{key}"), a.cloned(), b.cloned()),
        }
    }
}

fn compare_topics(name: &str, old: &Topic, new: &Topic, findings: &mut Findings) {
    compare_remarks(&format!("{name} "), &old.about, &new.about, findings);
    for (place, (a, b)) in old.messages.iter().zip(&new.messages).enumerate() {
        let place = format!("{name} message {place}");
        let times = |message: &Message| (message.0.log_time, message.0.publish_time, message.0.sequence);
        match times(a) == times(b) {
            true => findings.same(1),
            false => findings.differs(
                format!("{place}, log time, publish time, sequence"),
                Some(format!("{:?}", times(a))),
                Some(format!("{:?}", times(b))),
            ),
        }
        compare_messages(&place, [&a.1, &b.1], [&old.schema, &new.schema], findings);
    }
    let (count, now) = (old.messages.len(), new.messages.len());
    if count != now {
        findings.differs(format!("{name}, messages"), Some(count.to_string()), Some(now.to_string()));
    }
}

fn compare_messages(place: &str, [old, new]: [&[u8]; 2], [schema, new_schema]: [&str; 2], findings: &mut Findings) {
    let (Some(a), Some(b)) = (decoded(schema, old), decoded(new_schema, new)) else {
        match old == new {
            true => findings.same(1),
            false => {
                let at = old.iter().zip(new).take_while(|(a, b)| a == b).count();
                let bytes = |message: &[u8]| Some(format!("{:02x?}", &message[at..message.len().min(at + 8)]));
                findings.differs(format!("{place}, byte {at}"), bytes(old), bytes(new));
            }
        }
        return;
    };
    let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
    let said = |numbers: &[f64]| Some(format!("{numbers:?}"));
    for (field, numbers) in &a {
        match b.iter().find(|(name, _)| name == field) {
            Some((_, others)) if bits(numbers) == bits(others) => findings.same(numbers.len() as u64),
            Some((_, others)) => findings.differs(format!("{place}, {field}"), said(numbers), said(others)),
            None => findings.differs(format!("{place}, {field}"), said(numbers), None),
        }
    }
    for (field, numbers) in b.iter().filter(|(field, _)| !a.iter().any(|(name, _)| name == field)) {
        findings.differs(format!("{place}, {field}"), None, said(numbers));
    }
}

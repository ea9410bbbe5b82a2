//! Columns of an MCAP log: the numbers of one topic, each under its path, from ROS 2 messages in CDR or JSON. The topic
//! is stated, or is the only one with the wanted columns; topics are not merged.

use std::collections::BTreeMap;
use std::rc::Rc;

use mcap::Channel;
use serde_json::Value;

use super::columns::Columns;
use super::mcap_file::{self, Message, ReadEnd};
use super::numbers::{self, Numbers};
use super::ros_message::MessageDefinition;
use report::failure::{Failure, Outcome};

/// First bytes of every MCAP file.
const MAGIC: &[u8] = b"\x89MCAP";
/// Topics and fields named in a message at most.
const NAMES_SHOWN: usize = 12;
/// Memory of columns over the file's size, plus MEMORY_BASE bytes: other topics than a joint's may be packed much
/// tighter.
const MEMORY_FACTOR_MAX: u64 = 256;
const MEMORY_BASE: u64 = 64 << 20;

/// Returns true for an MCAP file.
pub fn is_mcap(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Decoder of a channel's messages.
enum Reader {
    Ros(Rc<MessageDefinition>),
    Json,
    /// Unreadable, with the reason.
    Unknown(String),
}

/// Message definitions by the number of their schema.
type MessageDefinitions = BTreeMap<u16, Result<Rc<MessageDefinition>, String>>;

impl Reader {
    /// Decoder of a channel; channels of one schema share its definition.
    fn for_channel(channel: &Channel<'_>, forms: &mut MessageDefinitions) -> Self {
        let schema = channel.schema.as_ref();
        let form = schema.map_or("", |schema| schema.encoding.as_str());
        match (channel.message_encoding.as_str(), form) {
            ("json", _) => Self::Json,
            ("cdr", "ros2msg") => {
                let (id, text) = schema.map_or((0, &[][..]), |schema| (schema.id, &schema.data));
                let read = || MessageDefinition::read(&String::from_utf8_lossy(text)).map(Rc::new);
                match forms.entry(id).or_insert_with(read) {
                    Ok(form) => Self::Ros(Rc::clone(form)),
                    Err(why) => Self::Unknown(why.clone()),
                }
            }
            (encoding, form) => {
                Self::Unknown(format!("its messages are encoded as `{encoding}` and defined as `{form}`"))
            }
        }
    }

    fn numbers(&self, message: &[u8]) -> Result<Numbers, String> {
        match self {
            Self::Ros(form) => form.numbers(message),
            Self::Json => {
                let value: Value = serde_json::from_slice(message).map_err(|error| error.to_string())?;
                let mut numbers = Numbers::default();
                flatten(&value, String::new(), &mut numbers)?;
                Ok(numbers)
            }
            Self::Unknown(why) => Err(why.clone()),
        }
    }
}

fn flatten(value: &Value, path: String, numbers: &mut Numbers) -> Result<(), String> {
    match value {
        Value::Number(number) => number.as_f64().map_or(Ok(()), |number| numbers.push(path, number)),
        Value::Bool(set) => numbers.push(path, f64::from(u8::from(*set))),
        Value::Array(list) => {
            let mut places = list.iter().enumerate();
            places.try_for_each(|(place, value)| flatten(value, numbers::element(&path, place)?, numbers))
        }
        Value::Object(map) => {
            map.iter().try_for_each(|(name, value)| flatten(value, numbers::field(&path, name)?, numbers))
        }
        Value::Null | Value::String(_) => Ok(()),
    }
}

/// Reads the stated topic, or else the only one accepted by `accepts`; of several accepted topics the only one
/// preferred by `is_better`.
pub fn read(
    bytes: &[u8],
    topic: Option<&str>,
    accepts: impl Fn(&Columns) -> bool,
    is_better: impl Fn(&Columns) -> bool,
) -> Outcome<Columns> {
    let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
    let (mut forms, mut messages) = (MessageDefinitions::new(), 0);
    let mut room = MEMORY_FACTOR_MAX.saturating_mul(bytes.len() as u64).saturating_add(MEMORY_BASE);
    let mut on_message = |message: &Message<'_>| {
        messages += 1;
        let name = &message.channel.topic;
        if !topics.contains_key(name) {
            topics.insert(name.clone(), Topic::new(&message.channel, &mut forms));
        } else if topic.is_some_and(|topic| topic != name) {
            return Ok(());
        }
        let Some(known) = topics.get_mut(name) else { return Ok(()) };
        let before = known.columns.size();
        known.add_message(message);
        room = room.checked_sub(known.columns.size() - before).ok_or_else(|| {
            Failure::new(format!("the numbers of its topics need more than {MEMORY_FACTOR_MAX} times the log's size"))
                .with_help("name the topic with --topic, or write a log of this topic alone")
        })?;
        Ok(())
    };
    mcap_file::read(bytes, &mut on_message).map_err(|broken| match broken {
        ReadEnd::Damaged(why) => {
            Failure::new(format!("the MCAP log is damaged or cut off after {messages} messages: {why}"))
                .with_help("`mcap recover` keeps what can be read of it")
        }
        ReadEnd::Callback(failure) => failure,
    })?;
    let chosen = match topic {
        Some(name) => topics.remove(name).ok_or_else(|| {
            let near = joint_file::nearest(name, topics.keys().map(String::as_str));
            let meant = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
            Failure::new(format!("there is no topic `{name}`{meant}")).with_help(list(&topics))
        })?,
        None => {
            let good: Vec<&String> =
                topics.iter().filter(|(_, topic)| accepts(&topic.columns)).map(|(name, _)| name).collect();
            let better: Vec<&String> = good.iter().copied().filter(|name| is_better(&topics[*name].columns)).collect();
            match if better.len() == 1 { better } else { good }.as_slice() {
                [one] => {
                    let one = (*one).clone();
                    topics.remove(&one).ok_or_else(|| Failure::new("the log is empty"))?
                }
                // A single topic is read anyway: its failure names the missing columns.
                [] if topics.len() == 1 => {
                    topics.pop_first().map(|(_, topic)| topic).ok_or_else(|| Failure::new("the log is empty"))?
                }
                [] => {
                    let help = format!(
                        "name the topic with --topic and its fields with --column, as in --column motor_counts=position; \
                         {}",
                        list(&topics)
                    );
                    return Err(Failure::new("no topic has motor, output and torque").with_help(help));
                }
                many => {
                    let names: Vec<String> = many.iter().map(|name| format!("`{name}`")).collect();
                    let message = format!("several topics have motor, output and torque: {}", names.join(", "));
                    return Err(Failure::new(message).with_help("choose one with --topic"));
                }
            }
        }
    };
    chosen.into_columns()
}

/// Topics with their numbers, up to the limit.
fn list(topics: &BTreeMap<String, Topic>) -> String {
    if topics.is_empty() {
        return "the log has no messages".to_owned();
    }
    let one = |(name, topic): (&String, &Topic)| match &topic.defect {
        Some(why) => format!("{name} (cannot be read: {why})"),
        None => format!("{name} ({})", topic.columns.names().take(NAMES_SHOWN).collect::<Vec<_>>().join(", ")),
    };
    format!("the log has {}", topics.iter().take(NAMES_SHOWN).map(one).collect::<Vec<_>>().join("; "))
}

/// Content of a topic.
struct Topic {
    name: String,
    reader: Reader,
    columns: Columns,
    /// Reason why the topic is unusable.
    defect: Option<String>,
    messages: usize,
}

impl Topic {
    fn new(channel: &Channel<'_>, forms: &mut MessageDefinitions) -> Self {
        let name = channel.topic.clone();
        Self {
            reader: Reader::for_channel(channel, forms),
            name,
            columns: Columns::new("message"),
            defect: None,
            messages: 0,
        }
    }

    fn add_message(&mut self, message: &Message<'_>) {
        self.messages += 1;
        if self.defect.is_some() {
            return;
        }
        let stamped = self.reader.numbers(message.data).and_then(|mut numbers| {
            stamp(&mut numbers, message.log_time)?;
            Ok(numbers)
        });
        match stamped {
            Ok(numbers) if self.columns.push(self.messages, numbers.as_slice()) => {}
            Ok(_) => self.defect = Some(format!("message {} has other fields than those before it", self.messages)),
            Err(why) => self.defect = Some(format!("message {}: {why}", self.messages)),
        }
    }

    fn into_columns(self) -> Outcome<Columns> {
        match self.defect {
            None => Ok(self.columns),
            Some(why) => Err(Failure::new(format!("topic `{}` cannot be read: {why}", self.name))
                .with_help("ROS 2 messages in CDR and JSON are supported; export other messages as CSV")),
        }
    }
}

/// Adds a time to a message without one: its header's, or else the recorder's.
fn stamp(numbers: &mut Numbers, log_time: u64) -> Result<(), String> {
    if ["time_s", "time_ms", "time_us"].into_iter().any(|name| numbers.value(name).is_some()) {
        return Ok(());
    }
    let own = numbers.value("header.stamp.sec").zip(numbers.value("header.stamp.nanosec"));
    let time = own.map_or(1e-9 * log_time as f64, |(seconds, nano)| seconds + 1e-9 * nano);
    numbers.push("time_s".to_owned(), time)
}

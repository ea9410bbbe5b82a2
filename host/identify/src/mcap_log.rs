//! Columns out of an MCAP log: the numbers of one topic, each under its path, ROS 2 messages in CDR or JSON. Which topic is
//! told, or is the one that has what is wanted; topics are not put together.

use std::collections::BTreeMap;
use std::sync::Arc;

use mcap::{Channel, Message, MessageStream};
use serde_json::Value;

use super::columns::Columns;
use super::ros_message::Form;
use report::failure::{Failure, Outcome};

/// What every MCAP file begins with.
const MAGIC: &[u8] = b"\x89MCAP";
/// Topics and fields that a message names at most.
const NAMED: usize = 12;

/// Whether a file is one.
pub fn is_mcap(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// How messages of a channel are read.
enum Reader {
    Ros(Form),
    Json,
    /// Not at all, for a reason.
    Unknown(String),
}

impl Reader {
    fn of(channel: &Channel<'_>) -> Self {
        let schema = channel.schema.as_ref();
        let form = schema.map_or("", |schema| schema.encoding.as_str());
        match (channel.message_encoding.as_str(), form) {
            ("json", _) => Self::Json,
            ("cdr", "ros2msg") => {
                let text = schema.map(|schema| String::from_utf8_lossy(&schema.data).into_owned());
                match Form::read(&text.unwrap_or_default()) {
                    Ok(form) => Self::Ros(form),
                    Err(why) => Self::Unknown(why),
                }
            }
            (encoding, form) => Self::Unknown(format!("its messages are `{encoding}` by `{form}`")),
        }
    }

    fn numbers(&self, message: &[u8]) -> Result<Vec<(String, f64)>, String> {
        match self {
            Self::Ros(form) => form.numbers(message),
            Self::Json => {
                let value: Value = serde_json::from_slice(message).map_err(|error| error.to_string())?;
                let mut numbers = Vec::new();
                flatten(&value, String::new(), &mut numbers);
                Ok(numbers)
            }
            Self::Unknown(why) => Err(why.clone()),
        }
    }
}

fn flatten(value: &Value, path: String, numbers: &mut Vec<(String, f64)>) {
    match value {
        Value::Number(number) => numbers.extend(number.as_f64().map(|number| (path, number))),
        Value::Bool(set) => numbers.push((path, f64::from(u8::from(*set)))),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(place, value)| flatten(value, format!("{path}[{place}]"), numbers));
        }
        Value::Object(map) => map.iter().for_each(|(name, value)| {
            let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            flatten(value, path, numbers);
        }),
        Value::Null | Value::String(_) => {}
    }
}

/// Reads the topic that is named, or else the only one whose columns will do.
pub fn read(bytes: &[u8], topic: Option<&str>, will_do: impl Fn(&Columns) -> bool) -> Outcome<Columns> {
    let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
    for (index, message) in stream(bytes)?.enumerate() {
        let message = message.map_err(|error| cut_off(index, &error))?;
        let name = &message.channel.topic;
        if topic.is_some_and(|topic| topic != name) && topics.contains_key(name) {
            continue;
        }
        topics.entry(name.clone()).or_insert_with(|| Topic::new(message.channel.clone())).take(&message);
    }
    let chosen = match topic {
        Some(name) => topics.remove(name).ok_or_else(|| {
            let near = joint_file::nearest(name, topics.keys().map(String::as_str));
            let meant = near.map_or(String::new(), |near| format!("; was `{near}` meant?"));
            Failure::new(format!("there is no topic `{name}`{meant}")).with_help(list(&topics))
        })?,
        None => {
            let good: Vec<&String> =
                topics.iter().filter(|(_, topic)| will_do(&topic.columns)).map(|(name, _)| name).collect();
            match good.as_slice() {
                [one] => {
                    let one = (*one).clone();
                    topics.remove(&one).ok_or_else(|| Failure::new("the log is empty"))?
                }
                // The only topic there is says best itself what it lacks.
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
    chosen.finish()
}

fn stream(bytes: &[u8]) -> Outcome<MessageStream<'_>> {
    MessageStream::new(bytes).map_err(|error| cut_off(0, &error))
}

fn cut_off(messages: usize, error: &mcap::McapError) -> Failure {
    Failure::new(format!("the MCAP log is damaged or cut off after {messages} messages: {error}"))
        .with_help("`mcap recover` keeps what can be read of it")
}

/// Topics with their numbers, as far as there is room.
fn list(topics: &BTreeMap<String, Topic>) -> String {
    if topics.is_empty() {
        return "the log has no messages".to_owned();
    }
    let one = |(name, topic): (&String, &Topic)| match &topic.trouble {
        Some(why) => format!("{name} (cannot be read: {why})"),
        None => format!("{name} ({})", topic.columns.names().take(NAMED).collect::<Vec<_>>().join(", ")),
    };
    format!("the log has {}", topics.iter().take(NAMED).map(one).collect::<Vec<_>>().join("; "))
}

/// What was read of a topic.
struct Topic {
    name: String,
    reader: Reader,
    columns: Columns,
    /// Why it cannot be used.
    trouble: Option<String>,
    messages: usize,
}

impl Topic {
    fn new(channel: Arc<Channel<'_>>) -> Self {
        let name = channel.topic.clone();
        Self { reader: Reader::of(&channel), name, columns: Columns::of("message"), trouble: None, messages: 0 }
    }

    fn take(&mut self, message: &Message<'_>) {
        self.messages += 1;
        if self.trouble.is_some() {
            return;
        }
        match self.reader.numbers(&message.data) {
            Ok(mut numbers) => {
                stamp(&mut numbers, message.log_time);
                if !self.columns.push(self.messages, &numbers) {
                    self.trouble = Some(format!("message {} has other fields than those before it", self.messages));
                }
            }
            Err(why) => self.trouble = Some(format!("message {}: {why}", self.messages)),
        }
    }

    fn finish(self) -> Outcome<Columns> {
        match self.trouble {
            None => Ok(self.columns),
            Some(why) => Err(Failure::new(format!("topic `{}` cannot be read: {why}", self.name))
                .with_help("ROS 2 messages in CDR and JSON are understood; export anything else as CSV")),
        }
    }
}

/// A message without a time of its own has that of its header, or at last the recorder's.
fn stamp(numbers: &mut Vec<(String, f64)>, log_time: u64) {
    let value = |wanted: &str| numbers.iter().find(|(name, _)| name == wanted).map(|(_, value)| *value);
    if ["time_s", "time_ms", "time_us"].into_iter().any(|name| value(name).is_some()) {
        return;
    }
    let own = value("header.stamp.sec").zip(value("header.stamp.nanosec"));
    let time = own.map_or(1e-9 * log_time as f64, |(seconds, nano)| seconds + 1e-9 * nano);
    numbers.push(("time_s".to_owned(), time));
}

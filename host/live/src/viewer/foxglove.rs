//! Foxglove's WebSocket protocol, version 1: a topic for each joint, with the schema language and encoding of the logs.
//!
//! The viewer reads only: the server offers no parameters, services or published topics of clients.

use report::contacts::families;
use report::log::{Message as Cdr, field};
use serde::Deserialize;
use serde_json::{Value, json};
use tungstenite::Message;

use super::View;
use crate::sample::{LISTS, NUMBERS, Sample};
use crate::shared::Batch;
use crate::source::Source;

/// Name of the schema.
const SCHEMA_NAME: &str = "joint_msgs/msg/Live";
/// Subscriptions of a viewer at a time.
const MAX_SUBSCRIPTIONS: usize = 256;
/// First byte of a message of a subscription.
const MESSAGE_DATA: u8 = 1;
/// Level of a status: error.
const ERROR: u8 = 2;

/// Foxglove as a viewer.
pub struct Foxglove {
    title: String,
    /// Identifiers of the joints whose channels were advertised, and the number of planets of their schema.
    advertised: Vec<(u8, usize)>,
    /// Subscription and channel.
    subscriptions: Vec<(u32, u32)>,
}

/// Request of a viewer.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Request {
    op: String,
    #[serde(default)]
    subscriptions: Vec<Subscription>,
    #[serde(default)]
    subscription_ids: Vec<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Subscription {
    id: u32,
    channel_id: u32,
}

impl Foxglove {
    /// Foxglove with the name of the server.
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), advertised: Vec::new(), subscriptions: Vec::new() }
    }
}

fn text(value: &Value) -> Vec<Message> {
    vec![Message::text(value.to_string())]
}

fn schema(planets: usize) -> String {
    let numbers = NUMBERS.iter().map(|(name, meaning, _)| field("float64", name, meaning));
    let lists = families(planets).into_iter().flat_map(|family| {
        LISTS.iter().map(move |(name, meaning)| field("float64[]", &format!("{family}_{name}"), meaning))
    });
    numbers.chain(lists).collect()
}

fn message(sample: &Sample) -> Cdr {
    let mut message = Cdr::default();
    NUMBERS.iter().for_each(|(_, _, value)| message.number(value(sample)));
    sample.meshes.lists().into_iter().flatten().for_each(|list| message.numbers(list.into_iter()));
    message
}

impl View for Foxglove {
    fn greet(&mut self) -> Vec<Message> {
        text(&json!({
            "op": "serverInfo", "name": self.title, "capabilities": [], "supportedEncodings": [], "metadata": {}
        }))
    }

    fn source(&mut self, source: &Source) -> Vec<Message> {
        let (id, planets) = (source.description.id, source.description.planets);
        if self.advertised.contains(&(id, planets)) {
            return Vec::new();
        }
        let mut messages = Vec::new();
        // A later run of another joint has other fields.
        if self.advertised.iter().any(|(known, _)| *known == id) {
            messages.extend(text(&json!({ "op": "unadvertise", "channelIds": [id] })));
            self.subscriptions.retain(|(_, channel)| *channel != u32::from(id));
        }
        self.advertised.retain(|(known, _)| *known != id);
        self.advertised.push((id, planets));
        messages.extend(text(&json!({
            "op": "advertise",
            "channels": [{
                "id": id, "topic": format!("/joint/{id}"), "encoding": "cdr", "schemaName": SCHEMA_NAME,
                "schema": schema(planets), "schemaEncoding": "ros2msg"
            }]
        })));
        messages
    }

    fn batch(&mut self, batch: &Batch, _: u64) -> Vec<Message> {
        let channel = u32::from(batch.source.description.id);
        let wanted = |(_, of): &&(u32, u32)| *of == channel;
        let subscriptions: Vec<u32> = self.subscriptions.iter().filter(wanted).map(|(id, _)| *id).collect();
        let mut messages = Vec::with_capacity(subscriptions.len() * batch.samples.len());
        if subscriptions.is_empty() {
            return messages;
        }
        for sample in &batch.samples {
            let cdr = message(sample);
            let nanoseconds = ((batch.source.epoch + sample.time).max(0.0) * 1e9) as u64;
            for subscription in &subscriptions {
                let mut bytes = vec![MESSAGE_DATA];
                bytes.extend(subscription.to_le_bytes());
                bytes.extend(nanoseconds.to_le_bytes());
                bytes.extend(cdr.bytes());
                messages.push(Message::binary(bytes));
            }
        }
        messages
    }

    fn receive(&mut self, request: &str) -> Vec<Message> {
        let request: Request = match serde_json::from_str(request) {
            Ok(request) => request,
            Err(error) => {
                let message = format!("the request is malformed: {error}");
                return text(&json!({ "op": "status", "level": ERROR, "message": message }));
            }
        };
        match request.op.as_str() {
            "subscribe" => {
                for Subscription { id, channel_id } in request.subscriptions {
                    let is_known = self.subscriptions.iter().any(|(known, _)| *known == id);
                    if !is_known && self.subscriptions.len() < MAX_SUBSCRIPTIONS {
                        self.subscriptions.push((id, channel_id));
                    }
                }
            }
            "unsubscribe" => self.subscriptions.retain(|(id, _)| !request.subscription_ids.contains(id)),
            // The server offers nothing else.
            _ => {}
        }
        Vec::new()
    }

    fn end(&mut self) -> Vec<Message> {
        let channels: Vec<u8> = self.advertised.iter().map(|(id, _)| *id).collect();
        text(&json!({ "op": "unadvertise", "channelIds": channels }))
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::source::Description;

    /// Names that follow a prefix in a layout, without the index of a list.
    fn names(file: &str, prefix: &str) -> Vec<String> {
        let path = format!("{}/../../examples/live/{file}", env!("CARGO_MANIFEST_DIR"));
        let text = fs::read_to_string(path).expect("a layout");
        let rest = |part: &str| part.split(['"', '[']).next().unwrap_or_default().to_owned();
        text.split(prefix).skip(1).map(rest).collect()
    }

    /// Names of the fields in the schema of a planetary joint.
    fn fields() -> Vec<String> {
        let name = |line: &str| line.split_whitespace().nth(1).unwrap_or_default().to_owned();
        schema(3).lines().map(name).collect()
    }

    #[test]
    fn layouts_name_existing_fields() {
        let fields = fields();
        for (file, prefix) in [("foxglove.json", "\"/joint/1."), ("plotjuggler.xml", "\"/joint/1/")] {
            let names = names(file, prefix);
            assert!(names.len() > 10, "{file}: {names:?}");
            let unknown: Vec<&String> =
                names.iter().filter(|name| !fields.contains(&name.to_ascii_lowercase())).collect();
            assert!(unknown.is_empty(), "{file}: {unknown:?} are not in {fields:?}");
        }
    }

    #[test]
    fn source_with_other_teeth_is_advertised_anew() {
        let mut view = Foxglove::new("test");
        let source = |number, planets| {
            let description = Description { id: 1, name: "q1".to_owned(), planets, ratio: 9.0, rated_torque: 8.0 };
            Source::starting(description, number)
        };
        assert_eq!(view.source(&source(0, 3)).len(), 1);
        assert_eq!(view.source(&source(1, 3)).len(), 0, "the next run of the joint has the same channel");
        view.receive(r#"{"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]}"#);
        assert_eq!(view.source(&source(2, 1)).len(), 2, "unadvertise and advertise");
        assert!(view.subscriptions.is_empty());
    }
}

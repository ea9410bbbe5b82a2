//! Messages of the page: descriptions and answers as JSON, samples as packed numbers.

use serde_json::json;
use tungstenite::Message;

use super::View;
use crate::sample::NUMBERS;
use crate::shared::{Batch, Commands};
use crate::source::Source;

/// The page as a viewer.
pub struct Page {
    title: String,
    commands: Option<Commands>,
    is_near: bool,
}

impl Page {
    /// Page with a title. Only a page on this machine may command.
    pub fn new(title: &str, commands: Option<Commands>, is_near: bool) -> Self {
        Self { title: title.to_owned(), commands, is_near }
    }

    fn answer(&self, line: &str) -> String {
        let refuse = |error: &str, help: &str| json!({ "error": error, "help": help }).to_string();
        match &self.commands {
            Some(_) if !self.is_near => {
                refuse("commands are taken from this machine only", "open the page where the twin runs")
            }
            Some(commands) => {
                commands(line.to_owned()).unwrap_or_else(|| refuse("the run is over", "start the twin again"))
            }
            None => refuse("this run takes no commands", "use joint twin --live"),
        }
    }
}

fn text(value: &serde_json::Value) -> Vec<Message> {
    vec![Message::text(value.to_string())]
}

impl View for Page {
    fn greet(&mut self) -> Vec<Message> {
        let names = NUMBERS.map(|(name, ..)| name);
        let commands = self.commands.is_some() && self.is_near;
        text(&json!({ "type": "hello", "title": self.title, "commands": commands, "numbers": names }))
    }

    fn source(&mut self, source: &Source) -> Vec<Message> {
        let description = &source.description;
        text(&json!({
            "type": "source", "number": source.number, "id": description.id, "name": description.name,
            "planets": description.planets, "ratio": description.ratio, "rated_torque_N_m": description.rated_torque
        }))
    }

    /// A header (number of the source, lost samples, samples, time of the first) and a row of f32 for each sample: the
    /// numbers, with the time from the first, then the lists of each mesh family.
    fn batch(&mut self, batch: &Batch, lost: u64) -> Vec<Message> {
        let start = batch.samples.first().map_or(0.0, |sample| sample.time);
        let mut bytes = Vec::with_capacity(20 + batch.samples.len() * 4 * 40);
        for whole in [batch.source.number, lost.min(u32::MAX.into()) as u32, batch.samples.len() as u32] {
            bytes.extend(whole.to_le_bytes());
        }
        bytes.extend(start.to_le_bytes());
        for sample in &batch.samples {
            let mut put = |value: f64| bytes.extend((value as f32).to_le_bytes());
            put(sample.time - start);
            NUMBERS.iter().skip(1).for_each(|(_, _, value)| put(value(sample)));
            sample.meshes.lists().iter().flatten().flatten().for_each(|value| put(*value));
        }
        vec![Message::binary(bytes)]
    }

    fn receive(&mut self, line: &str) -> Vec<Message> {
        // The answer of the run is JSON already.
        vec![Message::text(format!("{{\"type\":\"answer\",\"answer\":{}}}", self.answer(line)))]
    }

    fn end(&mut self) -> Vec<Message> {
        text(&json!({ "type": "end" }))
    }
}

//! Topic of a run's log with the inputs and outputs of the controller in every control period: counts and times as
//! received, torques, and a digest over all estimates. From this topic an observer repeats the run.

use std::collections::BTreeMap;
use std::fmt::Write;

use model_core::observer::{Estimates, MEMORY_BYTES, Memory, Reading, Samples};
use report::log::{Message, field};

use super::estimate_fields::estimates_digest;

/// Topic of every control period.
pub const TOPIC: &str = "/joint/controller";
/// Name of the topic's schema.
pub const SCHEMA_NAME: &str = "joint_msgs/msg/Controller";

/// Number of the control period, in this and other topics of the log.
pub const PERIOD: &str = "period";
/// Digest of the estimates.
pub const ESTIMATES_DIGEST: &str = "estimates_digest";
/// Torque given to the observer.
pub const OBSERVER_TORQUE: &str = "shown_torque_Nm";
/// Flag of a new reading of the output encoder.
pub const OUTPUT_READ: &str = "output_read";
/// Fields of 32 bits that form the samples.
pub const SAMPLE_FIELDS: [&str; 5] =
    ["clock_ticks", "motor_counts", "motor_read_at_ticks", "output_counts", "output_read_at_ticks"];

/// One control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControllerPeriod {
    /// Inputs of the controller.
    pub samples: Samples<f32>,
    /// Commanded torque [N m].
    pub torque: f32,
    /// Estimates of the observer, if the controller has one.
    pub estimates: Option<Estimates<f32>>,
}

/// Data that an observer needs to repeat a run, stored in the log's remarks.
#[derive(Debug, Clone, PartialEq)]
pub struct ObserverOrigin {
    /// Text of the joint file of the observer's design.
    pub joint_file: String,
    /// True if the observer had the output encoder.
    pub output_encoder: bool,
    /// Memory that the observer started from.
    pub memory: Option<Memory>,
}

/// Names of the remarks.
const JOINT_FILE: &str = "observer_joint_file";
const OUTPUT_ENCODER: &str = "observer_output_encoder";
const MEMORY: &str = "observer_memory";

/// Schema of the message in the text form of ROS 2.
pub fn schema() -> String {
    let meanings = [
        "now, by the clock of all readings",
        "raw counts, which wrap",
        "when they were read",
        "raw counts; the last ones while none come",
        "when they were read",
    ];
    let mut text = field("float64", "time_s", "beginning of the period [s]");
    text += &field("uint32", PERIOD, "number of the control period");
    text.extend(SAMPLE_FIELDS.iter().zip(meanings).map(|(name, meaning)| field("uint32", name, meaning)));
    text += &field("bool", OUTPUT_READ, "whether the output encoder gave a reading in this period");
    text += &field(
        "float32",
        OBSERVER_TORQUE,
        "asked of the motor in the period before, as the observer is shown it [N m]",
    );
    text += &field("float32", "motor_torque_Nm", "asked of the motor from now on [N m]");
    text += &field("uint32", ESTIMATES_DIGEST, "digest over every bit of all estimates, 0 without them");
    text
}

/// Builds the messages of a run.
#[derive(Debug, Default)]
pub struct ControllerMessages {
    /// Last reading of the output encoder.
    output: Reading,
}

impl ControllerMessages {
    /// Message of the next period.
    pub fn message(&mut self, time: f64, period: usize, of: &ControllerPeriod) -> Message {
        let ControllerPeriod { samples, torque, estimates } = of;
        self.output = samples.output.unwrap_or(self.output);
        let mut message = Message::default();
        message.number(time);
        message.whole(period as u32);
        for value in [samples.time, samples.motor.counts, samples.motor.time, self.output.counts, self.output.time] {
            message.whole(value);
        }
        message.flag(samples.output.is_some());
        message.single(samples.torque);
        message.single(*torque);
        message.whole(estimates.as_ref().map_or(0, estimates_digest));
        message
    }
}

impl ObserverOrigin {
    /// Remarks for the log.
    pub fn remarks(&self) -> BTreeMap<String, String> {
        let hexadecimal = |memory: &Memory| {
            memory.iter().fold(String::new(), |mut text, byte| {
                let _ = write!(text, "{byte:02x}");
                text
            })
        };
        let memory = self.memory.as_ref().map(|memory| (MEMORY, hexadecimal(memory)));
        let both = [(JOINT_FILE, self.joint_file.clone()), (OUTPUT_ENCODER, self.output_encoder.to_string())];
        both.into_iter().chain(memory).map(|(name, text)| (name.to_owned(), text)).collect()
    }

    /// Parses remarks; `None` if they are incomplete.
    pub fn from_remarks(remarks: &BTreeMap<String, String>) -> Option<Self> {
        let bytes = |text: &String| -> Option<Memory> {
            let byte = |place: usize| u8::from_str_radix(text.get(2 * place..2 * place + 2)?, 16).ok();
            let bytes: Option<Vec<u8>> = (0..MEMORY_BYTES).map(byte).collect();
            bytes.filter(|_| text.len() == 2 * MEMORY_BYTES)?.try_into().ok()
        };
        let memory = match remarks.get(MEMORY) {
            Some(text) => Some(bytes(text)?),
            None => None,
        };
        Some(Self {
            joint_file: remarks.get(JOINT_FILE)?.clone(),
            output_encoder: remarks.get(OUTPUT_ENCODER)?.parse().ok()?,
            memory,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origin_round_trips_through_remarks() {
        let mut memory = [0_u8; MEMORY_BYTES];
        memory[3] = 0xa7;
        for memory in [None, Some(memory)] {
            let origin = ObserverOrigin { joint_file: "name = \"J\"\n".to_owned(), output_encoder: false, memory };
            assert_eq!(ObserverOrigin::from_remarks(&origin.remarks()), Some(origin.clone()));
            let mut damaged = origin.remarks();
            damaged.insert(MEMORY.to_owned(), "a7".to_owned());
            assert_eq!(ObserverOrigin::from_remarks(&damaged), None);
        }
        assert_eq!(ObserverOrigin::from_remarks(&BTreeMap::new()), None);
    }
}

//! Estimates of a replay as CSV and as MCAP, with the names, units and words of a run's log.

use std::collections::BTreeMap;
use std::io::{self, Write};

use model_core::observer::{MAPPED, Observer};
use scenario::estimate_fields::{self, NOTICES_FIELD, WORD_FIELDS, fields, notices};

use crate::samples::ReplaySamples;
use report::log::{Channel, Message, field};

/// Topic of the estimates.
const TOPIC: &str = "/joint/estimates";
/// Name of the topic's schema.
const SCHEMA_NAME: &str = "joint_msgs/msg/Estimates";

/// Writes one of `every` rows as CSV.
pub fn write_csv(
    out: &mut impl Write,
    samples: &ReplaySamples,
    mut observer: Observer<'_, f32, MAPPED>,
    every: usize,
) -> io::Result<()> {
    let names: Vec<&str> = fields()
        .map(|field| field.name)
        .chain(WORD_FIELDS.iter().map(|word| word.name))
        .chain([NOTICES_FIELD.0])
        .collect();
    writeln!(out, "time_s,motor_torque_Nm,{}", names.join(","))?;
    for index in 0..samples.len() {
        let estimates = observer.step(&samples.at(index));
        if !index.is_multiple_of(every) {
            continue;
        }
        write!(out, "{:?},{:?}", samples.time[index], samples.torque[index])?;
        for field in fields() {
            let value = field.value(estimates);
            if field.is_flag() { write!(out, ",{value}")? } else { write!(out, ",{value:?}")? }
        }
        for word in WORD_FIELDS {
            write!(out, ",{}", (word.word)(estimates))?;
        }
        writeln!(out, ",{}", notices(estimates).join(" "))?;
    }
    out.flush()
}

/// Writes one of `every` rows as MCAP.
pub fn write_mcap(
    out: &mut impl Write,
    samples: &ReplaySamples,
    mut observer: Observer<'_, f32, MAPPED>,
    every: usize,
    remarks: BTreeMap<String, String>,
) -> io::Result<()> {
    let schema = field("float64", "time_s", "since the first row [s]")
        + &field("float64", "motor_torque_Nm", "asked of the motor [N m]")
        + &estimate_fields::schema();
    let mut channel = Channel::begin(out, TOPIC, SCHEMA_NAME, &schema, remarks)?;
    for index in 0..samples.len() {
        let estimates = observer.step(&samples.at(index));
        if index.is_multiple_of(every) {
            let mut message = Message::default();
            message.number(samples.time[index]);
            message.number(samples.torque[index]);
            estimate_fields::add(&mut message, Some(estimates));
            channel.write(samples.time[index], &message)?;
        }
    }
    channel.finish().map(drop)
}

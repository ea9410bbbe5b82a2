//! Samples of a run as a log for viewers of robot data, with the names, units and states of the record, and the torques
//! of the profile.

use std::collections::BTreeMap;
use std::io::{self, Write};

use report::contacts::{Contact, families};
use report::log::{Channel, Message, field};

use crate::record::RunRecord;

/// Topic of the motion.
const TOPIC: &str = "/joint/run";
/// Name of the topic's schema.
const SCHEMA_NAME: &str = "joint_msgs/msg/Run";
/// Numeric fields with their meanings.
const NUMBERS: [(&str, &str); 9] = [
    ("time_s", "board time since the reset [s]"),
    ("motor_angle_rad", "[rad]"),
    ("link_angle_rad", "[rad]"),
    ("twist_rad", "motor angle over ratio, less link angle [rad]"),
    ("carrier_speed_rad_per_s", "of the rigid body [rad/s]"),
    ("gap_m", "gap coordinate along the line of action [m]"),
    ("wind_up_m", "carrier less link along the line of action [m]"),
    ("drive_torque_Nm", "that drives the gears at the motor, as the profile has it in this tick [N m]"),
    ("load_torque_Nm", "that brakes the link, likewise [N m]"),
];
/// Fields of both families of meshes, with an entry per planet.
const LISTS: [(&str, &str, &str); 2] =
    [("float64[]", "deflection_m", "[m]"), ("string[]", "contact", "separated, drive_side or back_side")];

/// Writes all samples of the board.
pub fn write(out: &mut impl Write, record: &RunRecord) -> io::Result<()> {
    let numbers = NUMBERS.iter().map(|(name, meaning)| field("float64", name, meaning));
    let planets = record.samples.deflection_m.len() / 2;
    let of_each = if planets == 1 { "of the one contact" } else { "one for each planet" };
    let lists = families(planets).into_iter().flat_map(|family| {
        let list = move |(kind, name, meaning): &(&str, &str, &str)| {
            field(kind, &format!("{family}_{name}"), &format!("{meaning}, {of_each}"))
        };
        LISTS.iter().map(list)
    });
    let identity = &record.identity;
    let remarks = [
        ("joint", identity.joint.clone()),
        ("joint_file", identity.joint_file.clone()),
        ("transport", identity.transport.clone()),
        ("date", identity.date.clone()),
        ("command", record.settings.replay.clone()),
        ("version", identity.host_version.clone()),
    ];
    let remarks: BTreeMap<String, String> = remarks.into_iter().map(|(name, text)| (name.to_owned(), text)).collect();
    let schema: String = numbers.chain(lists).collect();
    let mut channel = Channel::begin(out, TOPIC, SCHEMA_NAME, &schema, remarks)?;
    for place in 0..record.samples.len() {
        channel.write(record.samples.time_s[place], &message(record, place))?;
    }
    channel.finish().map(drop)
}

fn message(record: &RunRecord, place: usize) -> Message {
    let samples = &record.samples;
    // A command acts from its tick on; a sample is taken after the step of the tick before its own.
    let acting = record.schedule.iter().rev().find(|command| command.tick < samples.tick[place]);
    let mut message = Message::default();
    for column in [&samples.time_s, &samples.motor_angle_rad, &samples.link_angle_rad, &samples.twist_rad] {
        message.number(column[place]);
    }
    for column in [&samples.carrier_speed, &samples.gap_m, &samples.wind_up_m] {
        message.number(column[place].into());
    }
    message.number(acting.map_or(0.0, |command| command.drive_torque.into()));
    message.number(acting.map_or(0.0, |command| command.load_torque.into()));
    let planets = samples.deflection_m.len() / 2;
    for meshes in [0..planets, planets..2 * planets] {
        message.numbers(samples.deflection_m[meshes.clone()].iter().map(|column| f64::from(column[place])));
        message.words(samples.contact[meshes].iter().map(|column: &Vec<Contact>| column[place].word()));
    }
    message
}

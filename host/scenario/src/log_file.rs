//! A run as an MCAP log, which Foxglove and PlotJuggler open: truth, estimates and torque a thousand times a second.
//! For the full rate, run it again: runs repeat bit for bit.

use std::collections::BTreeMap;
use std::io::{self, Write};

use super::run_history::RunHistory;
use report::contacts::Contact;
use report::failure::Outcome;
use report::folder::Folder;
use report::log::{Channel, Message, field};

/// Folder of all logs, in that of the results.
pub const FOLDER: &str = "runs";
/// Topic of a run.
pub const TOPIC: &str = "/joint/trial";
/// Name of its schema.
const SCHEMA_NAME: &str = "joint_msgs/msg/Trial";
/// Messages a second [Hz].
const RATE: f64 = 1000.0;

/// Fields that are numbers, in SI, with what they mean.
const NUMBERS: [(&str, &str); 17] = [
    ("time_s", "since the start [s]"),
    ("wanted_rad", "where the link was to be [rad]"),
    ("link_rad", "where it is [rad]"),
    ("error_rad", "wanted less link [rad]"),
    ("link_speed_rad_per_s", "[rad/s]"),
    ("motor_rad", "[rad]"),
    ("gap_m", "gap coordinate [m]"),
    ("half_backlash_m", "of every mesh, now [m]"),
    ("mesh_force_N", "net force of the sun's meshes [N]"),
    ("peak_mesh_force_N", "largest of them since the last message [N]"),
    ("load_torque_Nm", "what brakes the link [N m]"),
    ("motor_torque_Nm", "asked of the motor [N m]"),
    ("estimated_gap_m", "by the observer [m]"),
    ("estimated_half_backlash_m", "[m]"),
    ("estimated_load_torque_Nm", "[N m]"),
    ("trust", "share of the compensation in the torque"),
    ("short_of_torque", "1: the law asks for more torque than there is, or brakes early because of that"),
];
/// The field that is a word.
const SIDE: (&str, &str) =
    ("estimated_side", "flank that carries, by the observer: separated, drive_side or back_side; none without it");

/// Writes a run to a file of this name, and says where that is in the folder of all.
pub fn write(folder: &Folder, name: &str, history: &RunHistory, remarks: BTreeMap<String, String>) -> Outcome<String> {
    let path = format!("{FOLDER}/{name}");
    folder.write_with(&path, |out| fill(out, history, remarks))?;
    Ok(path)
}

fn fill(out: &mut impl Write, history: &RunHistory, remarks: BTreeMap<String, String>) -> io::Result<()> {
    let numbers = NUMBERS.iter().map(|(name, meaning)| field("float64", name, meaning));
    let schema: String = numbers.chain([field("string", SIDE.0, SIDE.1)]).collect();
    let mut channel = Channel::begin(out, TOPIC, SCHEMA_NAME, &schema, remarks)?;
    for (sample, truth, seen, peak) in history.thinned(RATE) {
        let observed = seen.copied().unwrap_or_default();
        let numbers: [f64; NUMBERS.len()] = [
            sample.time,
            sample.wanted,
            sample.link,
            sample.wanted - sample.link,
            sample.link_speed,
            truth.motor,
            truth.gap,
            truth.half_backlash,
            sample.mesh_force,
            peak,
            truth.load_torque,
            sample.command,
            observed.gap.into(),
            observed.half_backlash.into(),
            observed.load_torque.into(),
            observed.trust.into(),
            f64::from(u8::from(observed.short_of_torque)),
        ];
        let mut message = Message::default();
        numbers.into_iter().for_each(|number| message.number(number));
        message.word(seen.map_or("none", |seen| side(seen.side).word()));
        channel.write(sample.time, &message)?;
    }
    channel.finish().map(drop)
}

/// The flank of a side.
fn side(side: i8) -> Contact {
    match side.signum() {
        0 => Contact::Separated,
        1 => Contact::DriveSide,
        _ => Contact::BackSide,
    }
}

//! A run as an MCAP log, which Foxglove and PlotJuggler open: truth, estimates and torque a thousand times a second.
//! For the full rate, run it again: runs repeat bit for bit.

use std::collections::BTreeMap;
use std::io::{self, Write};

use super::run_history::RunHistory;
use report::failure::Outcome;
use report::folder::Folder;
use simulation::sim::log_file::Channel;

/// Folder of all logs, in that of the results.
pub const FOLDER: &str = "runs";
/// Topic of a run.
pub const TOPIC: &str = "/joint/trial";
/// Name of its schema.
const SCHEMA_NAME: &str = "joint_msgs/msg/Trial";
/// Messages a second [Hz].
const RATE: f64 = 1000.0;

/// Fields, all of them numbers, with what they mean.
const FIELDS: [(&str, &str); 18] = [
    ("time_s", "since the start [s]"),
    ("wanted_rad", "where the link was to be [rad]"),
    ("link_rad", "where it is [rad]"),
    ("error_mrad", "wanted less link [mrad]"),
    ("link_speed_rad_per_s", "[rad/s]"),
    ("motor_rad", "[rad]"),
    ("gap_um", "gap coordinate [um]"),
    ("half_backlash_um", "of every mesh, now [um]"),
    ("mesh_force_n", "net force of the sun's meshes [N]"),
    ("peak_mesh_force_n", "largest of them since the last message [N]"),
    ("load_torque_nm", "what brakes the link [N m]"),
    ("motor_torque_nm", "asked of the motor [N m]"),
    ("estimated_gap_um", "by the observer [um]"),
    ("estimated_side", "1 drive side, 0 parted, -1 back side"),
    ("estimated_half_backlash_um", "[um]"),
    ("estimated_load_torque_nm", "[N m]"),
    ("trust", "share of the compensation in the torque"),
    ("short_of_torque", "1: the law asks for more torque than there is, or brakes early because of that"),
];

/// Writes a run to a file of this name, and says where that is in the folder of all.
pub fn write(folder: &Folder, name: &str, history: &RunHistory, remarks: BTreeMap<String, String>) -> Outcome<String> {
    let path = format!("{FOLDER}/{name}");
    folder.write_with(&path, |out| fill(out, history, remarks))?;
    Ok(path)
}

fn fill(out: &mut impl Write, history: &RunHistory, remarks: BTreeMap<String, String>) -> io::Result<()> {
    let schema: String = FIELDS.iter().map(|(name, meaning)| format!("float64 {name}  # {meaning}\n")).collect();
    let mut channel = Channel::begin(out, TOPIC, SCHEMA_NAME, &schema, remarks)?;
    for (sample, truth, observed, peak) in history.thinned(RATE) {
        let observed = observed.copied().unwrap_or_default();
        let numbers: [f64; FIELDS.len()] = [
            sample.time,
            sample.wanted,
            sample.link,
            1e3 * (sample.wanted - sample.link),
            sample.link_speed,
            truth.motor,
            1e6 * truth.gap,
            1e6 * truth.half_backlash,
            sample.mesh_force,
            peak,
            truth.load_torque,
            sample.command,
            1e6 * f64::from(observed.gap),
            observed.side.into(),
            1e6 * f64::from(observed.half_backlash),
            observed.load_torque.into(),
            observed.trust.into(),
            f64::from(u8::from(observed.short_of_torque)),
        ];
        // CDR: little endian behind a head of four bytes; numbers of eight bytes need no filling.
        let mut message = vec![0, 1, 0, 0];
        numbers.into_iter().for_each(|number| message.extend(number.to_le_bytes()));
        channel.write(sample.time, &message)?;
    }
    channel.finish().map(drop)
}

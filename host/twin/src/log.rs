//! Log of a twin as MCAP: truth and drive of each joint a thousand times a second, and every frame on the bus.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use report::failure::{Failure, Outcome};
use report::log::{Log, Message, Topic, field};

use crate::joint::Joint;
use wires::Packet;

/// Messages a second of each joint [Hz].
const RATE: f64 = 1000.0;

/// Numeric fields in SI, with their meanings.
const NUMBERS: [(&str, &str); 21] = [
    ("time_s", "since the start [s]"),
    ("link_rad", "true angle of the link on the scale of the output encoder [rad]"),
    ("link_speed_rad_per_s", "true speed of the link [rad/s]"),
    ("motor_rad", "true angle of the motor [rad]"),
    ("gap_m", "true gap coordinate [m]"),
    ("half_backlash_m", "true half-backlash of every mesh [m]"),
    ("mesh_force_N", "net force between the flanks at the motor's side [N]"),
    ("load_torque_Nm", "torque that brakes the link [N m]"),
    ("motor_torque_Nm", "torque in the air gap [N m]"),
    ("drive_position_rad", "angle of the output that the drive controls, by the motor encoder [rad]"),
    ("drive_velocity_rad_per_s", "its speed [rad/s]"),
    ("drive_output_rad", "angle by the output encoder, NaN without one [rad]"),
    ("drive_rotor_rad", "angle by the motor encoder [rad]"),
    ("drive_target_rad", "target of the position loop [rad]"),
    ("drive_target_velocity_rad_per_s", "speed of the target [rad/s]"),
    ("drive_torque_Nm", "torque at the output by the current [N m]"),
    ("drive_demand_Nm", "torque command at the output before limits [N m]"),
    ("drive_current_A", "torque-producing current [A]"),
    ("bus_V", "bus voltage [V]"),
    ("bus_A", "bus current [A]"),
    ("motor_temperature_C", "temperature of the winding [deg C]"),
];
/// Text fields.
const WORDS: [(&str, &str); 2] = [("state", "state of the drive"), ("fault", "fault of the drive, empty without one")];

/// Log that is being written.
pub struct TwinLog {
    log: Log<BufWriter<File>>,
    path: PathBuf,
    joints: Vec<Topic>,
    frames: Topic,
    /// Messages written for each joint.
    samples: u64,
}

impl TwinLog {
    /// Begins the log of joints.
    pub fn begin(path: &Path, joints: &[Joint<'_>], remarks: BTreeMap<String, String>) -> Outcome<Self> {
        let fill = || -> io::Result<Self> {
            let mut log = Log::begin(BufWriter::new(File::create(path)?), remarks)?;
            let joints = joints
                .iter()
                .map(|joint| log.topic(&format!("/joint/{}", joint.id), "joint_msgs/msg/Twin", &joint_schema()))
                .collect::<io::Result<_>>()?;
            let frames = log.topic("/bus", "joint_msgs/msg/Frame", &frame_schema())?;
            Ok(Self { log, path: path.to_owned(), joints, frames, samples: 0 })
        };
        fill().map_err(|error| cannot_write(path, &error))
    }

    /// Records the joints, if a message is due.
    pub fn sample(&mut self, joints: &[Joint<'_>]) -> Outcome<()> {
        let time = joints.first().map_or(0.0, Joint::time);
        if time * RATE < self.samples as f64 {
            return Ok(());
        }
        self.samples += 1;
        for (joint, topic) in joints.iter().zip(&mut self.joints) {
            self.log.write(topic, time, &message(joint)).map_err(|error| cannot_write(&self.path, &error))?;
        }
        Ok(())
    }

    /// Records a packet on the bus.
    pub fn packet(&mut self, time: f64, packet: &Packet, is_of_client: bool) -> Outcome<()> {
        let (id, data) = match packet {
            Packet::Frame(frame) => (frame.raw_id(), frame.data()),
            Packet::Bytes(bytes) => (0, bytes.as_slice()),
        };
        let mut message = Message::default();
        message.number(time);
        message.flag(is_of_client);
        message.whole(id);
        message.word(&data.iter().map(|byte| format!("{byte:02X}")).collect::<String>());
        self.log.write(&mut self.frames, time, &message).map_err(|error| cannot_write(&self.path, &error))
    }

    /// Completes the log.
    pub fn finish(self) -> Outcome<()> {
        let path = self.path;
        self.log.finish().map(drop).map_err(|error| cannot_write(&path, &error))
    }
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::new(format!("cannot write the log {}: {error}", path.display()))
        .with_help("name a --log in a folder of yours, on a disk with room")
}

fn message(joint: &Joint<'_>) -> Message {
    let (truth, feedback) = (joint.truth(), joint.drive.feedback());
    let numbers: [f64; NUMBERS.len()] = [
        joint.time(),
        truth.link,
        truth.link_speed,
        truth.motor,
        truth.gap,
        truth.half_backlash,
        truth.mesh_force,
        truth.load_torque,
        truth.motor_torque,
        feedback.position.to_rad().into(),
        feedback.velocity.into(),
        feedback.output_position.map_or(f64::NAN, |position| position.to_rad().into()),
        feedback.motor_position.to_rad().into(),
        feedback.target.to_rad().into(),
        feedback.target_velocity.into(),
        feedback.torque.into(),
        feedback.demand.into(),
        feedback.current.into(),
        feedback.sensors.bus_voltage.into(),
        feedback.sensors.bus_current.into(),
        feedback.sensors.motor_temperature.into(),
    ];
    let mut message = Message::default();
    numbers.into_iter().for_each(|number| message.number(number));
    message.word(&format!("{:?}", joint.drive.state()));
    message.word(&joint.drive.fault().map_or_else(String::new, |fault| format!("{fault:?}")));
    message
}

fn joint_schema() -> String {
    let numbers = NUMBERS.iter().map(|(name, meaning)| field("float64", name, meaning));
    numbers.chain(WORDS.iter().map(|(name, meaning)| field("string", name, meaning))).collect()
}

fn frame_schema() -> String {
    [
        field("float64", "time_s", "since the start [s]"),
        field("bool", "is_of_client", "true for a frame of the client, false for one of a drive"),
        field("uint32", "id", "identifier of a CAN frame, 0 on a serial bus"),
        field("string", "data", "bytes as hexadecimal digits"),
    ]
    .concat()
}

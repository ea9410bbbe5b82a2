//! A run as an MCAP log, which Foxglove and PlotJuggler open: truth, set-point, faults and estimates a thousand times a
//! second. For the tested controller the log also has the inputs of every control period, so that its observer can be
//! run again.

use std::collections::BTreeMap;
use std::io::{self, Write};

use super::controller_log::{self, ControllerMessages};
use super::estimate_fields;
use super::file::{Fault, fault_is_active, fault_word};
use super::run_history::RunHistory;
use report::failure::Outcome;
use report::folder::Folder;
use report::interruption;
use report::log::{Log, Message, field};

/// Folder of all logs, within the output folder.
pub const FOLDER: &str = "runs";
/// Topic of a run.
pub const TOPIC: &str = "/joint/trial";
/// Name of the topic's schema.
const SCHEMA_NAME: &str = "joint_msgs/msg/Trial";
/// Messages a second [Hz].
const RATE: f64 = 1000.0;

/// Numeric fields in SI, with their meanings.
const NUMBERS: [(&str, &str); 21] = [
    ("time_s", "since the start [s]"),
    ("wanted_rad", "where the link was to be [rad]"),
    ("link_rad", "where it is [rad]"),
    ("error_rad", "wanted less link [rad]"),
    ("link_speed_rad_per_s", "[rad/s]"),
    ("motor_rad", "[rad]"),
    ("gap_m", "gap coordinate [m]"),
    ("half_backlash_m", "of every mesh, now [m]"),
    ("mesh_force_N", "net force between the flanks at the motor's side [N]"),
    ("peak_mesh_force_N", "largest of them since the last message [N]"),
    ("load_torque_Nm", "what brakes the link [N m]"),
    ("motor_torque_Nm", "asked of the motor [N m]"),
    ("set_point_rad", "angle that the controller was asked for [rad]"),
    ("set_point_speed_rad_per_s", "[rad/s]"),
    ("set_point_acceleration_rad_per_s2", "[rad/s^2]"),
    ("set_point_torque_Nm", "torque sent along with an impedance [N m]"),
    ("set_point_stiffness_Nm_per_rad", "of an impedance [N m/rad]"),
    ("set_point_damping_Nms_per_rad", "of an impedance [N m s/rad]"),
    ("trust", "share of the compensation in the torque"),
    ("short_of_torque", "1: the law asks for more torque than there is, or brakes early because of that"),
    ("stepped_back", "1: the motor alone is controlled because the loop hunted"),
];
/// Field of the active faults.
const FAULTS: (&str, &str) = ("injected_faults", "faults of the test that act, by their words in its file");

/// A run to be logged.
pub struct LoggedRun<'r> {
    /// History of the run.
    pub history: &'r RunHistory,
    /// Faults of the test.
    pub faults: &'r [Fault],
    /// Logs every control period of the controller; such logs are much larger.
    pub every_period: bool,
    /// Origin of the run.
    pub remarks: BTreeMap<String, String>,
}

/// Writes a run to a file; returns its path relative to the output folder.
pub fn write(folder: &Folder, name: &str, run: LoggedRun<'_>) -> Outcome<String> {
    let path = format!("{FOLDER}/{name}");
    folder.write_with(&path, |out| fill(out, run))?;
    Ok(path)
}

fn fill(out: &mut impl Write, run: LoggedRun<'_>) -> io::Result<()> {
    let LoggedRun { history, faults, every_period, remarks } = run;
    let mut log = Log::begin(out, remarks)?;
    let mut trial = log.topic(TOPIC, SCHEMA_NAME, &schema())?;
    let mut controller = log.topic(controller_log::TOPIC, controller_log::SCHEMA_NAME, &controller_log::schema())?;
    let (every, mut messages) = (history.periods_per_sample(RATE), ControllerMessages::default());
    let mut thinned = history.samples_at(RATE);
    for (period, of) in history.controller.iter().enumerate() {
        if interruption::requested() {
            // Writing a log takes longer than a user waits, so an interruption stops it; the partial log is removed.
            return Err(io::ErrorKind::Interrupted.into());
        }
        let began = period as f64 * history.run.period;
        if every_period {
            log.write(&mut controller, began, &messages.message(began, period, of))?;
        }
        if (period + 1) % every != 0 {
            continue;
        }
        let Some((sample, truth, seen, peak)) = thinned.next() else { continue };
        let (observed, asked) = (seen.copied().unwrap_or_default(), &history.set_points[period]);
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
            asked.motion.position,
            asked.motion.speed,
            asked.motion.acceleration,
            asked.torque,
            asked.stiffness,
            asked.damping,
            observed.trust.into(),
            f64::from(u8::from(observed.short_of_torque)),
            f64::from(u8::from(observed.stepped_back)),
        ];
        let mut message = Message::default();
        numbers.into_iter().for_each(|number| message.number(number));
        message.whole(period as u32);
        estimate_fields::add(&mut message, of.estimates.as_ref());
        let acting: Vec<&str> = faults.iter().filter(|fault| fault_is_active(fault, began)).map(fault_word).collect();
        message.words(acting.into_iter());
        log.write(&mut trial, sample.time, &message)?;
    }
    log.finish().map(drop)
}

/// Schema of the truth, the set-point and the estimates in the text form of ROS 2.
fn schema() -> String {
    let numbers = NUMBERS.iter().map(|(name, meaning)| field("float64", name, meaning));
    let period =
        field("uint32", controller_log::PERIOD, "number of the control period, at whose beginning it was estimated");
    numbers.chain([period, estimate_fields::schema(), field("string[]", FAULTS.0, FAULTS.1)]).collect()
}

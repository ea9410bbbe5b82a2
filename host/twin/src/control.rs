//! Commands that change joints while they run: lines of JSON on a Unix socket, each answered by a line of JSON.
//!
//! | key | value | effect |
//! |---|---|---|
//! | `joint` | identifier | joint that the other keys concern; all joints without it |
//! | `load_N_m` | number | braking torque on the link |
//! | `half_backlash_um` | number | half-backlash of every mesh |
//! | `supply_V` | number | voltage of the supply without a load |
//! | `motor_temperature_C` | number | temperature of the winding |
//! | `fault` | object | fault with the keys of `[[fault]]` in test files; times count from now |
//! | `can_errors` | 0 to 1 | share of the frames that noise on the bus destroys |
//! | `bus_off` | `true` | takes the CAN controllers of the drives off the bus, as a burst of errors does |
//! | `end_faults` | `true` | ends all faults, and the noise on the bus |
//! | `mode` | object | mode of the drive in place of its client's commands |
//! | `clear_fault` | `true` | clears the fault of the drive |
//! | `status` | `true` | state of the joints |

use std::fmt::Write as _;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};
use std::thread;

use report::failure::{Failure, Outcome};
use scenario::file::{Fault, read_faults};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::bus::Bus;
use crate::bus_report::BusReport;
use crate::can::ErrorState;
use crate::event::Event;
use crate::mode::Mode;

/// Command of one line.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Order {
    joint: Option<u8>,
    #[serde(rename = "load_N_m")]
    load: Option<f64>,
    #[serde(rename = "half_backlash_um")]
    half_backlash: Option<f64>,
    #[serde(rename = "supply_V")]
    supply: Option<f32>,
    #[serde(rename = "motor_temperature_C")]
    motor_temperature: Option<f32>,
    fault: Option<Map<String, Value>>,
    can_errors: Option<f64>,
    #[serde(default)]
    bus_off: bool,
    #[serde(default)]
    end_faults: bool,
    mode: Option<Mode>,
    #[serde(default)]
    clear_fault: bool,
    #[serde(default)]
    status: bool,
}

/// Answer to a line.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub enum Reply {
    /// The command was carried out.
    Done {
        /// Simulated time [s].
        time_s: f64,
        /// States of the joints, if they were asked for.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        joints: Vec<Status>,
        /// Figures of a CAN bus, if the states were asked for.
        #[serde(skip_serializing_if = "Option::is_none")]
        bus: Option<BusReport>,
    },
    /// The command was refused as a whole.
    Refused {
        /// Reason.
        error: String,
        /// Remedy.
        help: String,
    },
}

/// State of a joint.
#[derive(Debug, Serialize)]
pub struct Status {
    joint: u8,
    name: String,
    state: String,
    fault: Option<String>,
    mode: &'static str,
    position_turns: f32,
    output_turns: Option<f32>,
    link_rad: f64,
    gap_um: f64,
    half_backlash_um: f64,
    #[serde(rename = "load_torque_Nm")]
    load_torque: f64,
    #[serde(rename = "motor_torque_Nm")]
    motor_torque: f64,
    #[serde(rename = "bus_V")]
    bus: f32,
    #[serde(rename = "motor_temperature_C")]
    motor_temperature: f32,
    #[serde(flatten)]
    can: Option<CanStatus>,
    #[serde(flatten)]
    compensated: Option<CompensatedStatus>,
}

/// State of observer and compensation in a drive.
#[derive(Debug, Serialize)]
struct CompensatedStatus {
    observer_source: String,
    observer_half_backlash_um: f32,
    compensation_stage: String,
    compensation_stepped_back: bool,
}

/// State of a drive's CAN controller.
#[derive(Debug, Serialize)]
struct CanStatus {
    can_state: ErrorState,
    transmit_errors: u16,
    receive_errors: u16,
}

/// Socket for commands, removed at the end.
pub struct Socket(PathBuf);

impl Socket {
    /// Listens at a path.
    pub fn listen(path: &Path, events: &Sender<Event>) -> Outcome<Self> {
        remove_stale_socket(path);
        let listener = UnixListener::bind(path).map_err(|error| {
            Failure::new(format!("cannot listen at {}: {error}", path.display()))
                .with_help("name a --control path in a folder of yours that is not in use")
        })?;
        let events = events.clone();
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let events = events.clone();
                thread::spawn(move || serve(&stream, &events));
            }
        });
        Ok(Self(path.to_owned()))
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// Removes a socket that an earlier run left: one that nobody answers. Any other file is kept.
fn remove_stale_socket(path: &Path) {
    let is_socket = fs::symlink_metadata(path).is_ok_and(|found| found.file_type().is_socket());
    if is_socket && UnixStream::connect(path).is_err() {
        let _ = fs::remove_file(path);
    }
}

fn serve(stream: &UnixStream, events: &Sender<Event>) {
    let Ok(mut writer) = stream.try_clone() else { return };
    for line in BufReader::new(stream).lines().map_while(Result::ok) {
        let Some(text) = ask(line, events) else { return };
        if writeln!(writer, "{text}").is_err() {
            return;
        }
    }
}

/// Hands a line to the run; returns the answer as JSON, or `None` once the run is over.
pub fn ask(line: String, events: &Sender<Event>) -> Option<String> {
    let (answer, answered) = channel();
    events.send(Event::Control(line, answer)).ok()?;
    answered.recv().ok()
}

/// Carries out a line; returns the answer as JSON.
pub fn execute(line: &str, bus: &mut Bus<'_>) -> String {
    let reply = match read(line, bus) {
        Ok((order, faults)) => apply(&order, &faults, bus),
        Err(refused) => refused,
    };
    serde_json::to_string(&reply).unwrap_or_default()
}

fn refused(error: impl Into<String>, help: impl Into<String>) -> Reply {
    Reply::Refused { error: error.into(), help: help.into() }
}

/// Order and its faults, with times from zero, if all of it makes sense.
fn read(line: &str, bus: &Bus<'_>) -> Result<(Order, Vec<Fault>), Reply> {
    let joints = &bus.joints;
    let order: Order = serde_json::from_str(line)
        .map_err(|error| refused(error.to_string(), "write one JSON object a line: docs/reference/twin.md"))?;
    let own = [
        ("load_N_m", order.load, -1e6, 1e6),
        ("half_backlash_um", order.half_backlash, 0.0, 1e4),
        ("supply_V", order.supply.map(f64::from), 0.0, 200.0),
        ("motor_temperature_C", order.motor_temperature.map(f64::from), -50.0, 500.0),
        ("can_errors", order.can_errors, 0.0, 1.0),
    ];
    let own = own.into_iter().filter_map(|(key, value, low, high)| Some((key, value?, low, high)));
    for (key, value, low, high) in own.chain(order.mode.map(Mode::numbers).unwrap_or_default()) {
        if !(low..=high).contains(&value) {
            return Err(refused(format!("`{key}` is out of range"), format!("write a number from {low} to {high}")));
        }
    }
    if let Some(id) = order.joint.filter(|id| joints.iter().all(|joint| joint.id != *id)) {
        let known: Vec<String> = joints.iter().map(|joint| joint.id.to_string()).collect();
        return Err(refused(format!("no joint has the identifier {id}"), format!("write one of {}", known.join(", "))));
    }
    if bus.can.is_none() && (order.can_errors.is_some() || order.bus_off) {
        let key = if order.bus_off { "bus_off" } else { "can_errors" };
        return Err(refused(
            format!("`{key}` concerns a CAN bus, and these drives are on a serial bus"),
            "leave it out",
        ));
    }
    let wants_plant = order.load.is_some() || order.half_backlash.is_some() || order.fault.is_some();
    if wants_plant && joints.iter().any(|joint| joint.is_of_image() && order.joint.is_none_or(|id| joint.id == id)) {
        return Err(refused(
            "the joint of an image keeps its load and backlash and has no faults",
            "start the twin without --image for changes of the joint",
        ));
    }
    let faults = match &order.fault {
        Some(fault) => read_faults(&toml(fault)?).map_err(|problems| match problems.into_iter().next() {
            Some(problem) => refused(problem.message, problem.help),
            None => refused("the fault cannot be read", "docs/reference/hil-file.md lists the faults"),
        })?,
        None => Vec::new(),
    };
    let concerned = joints.iter().filter(|joint| order.joint.is_none_or(|id| joint.id == id));
    for joint in concerned {
        joint
            .check_faults(&faults)
            .map_err(|failure| refused(failure.message(), failure.help().unwrap_or_default()))?;
    }
    Ok((order, faults))
}

/// Text of a fault as in a test file.
fn toml(fault: &Map<String, Value>) -> Result<String, Reply> {
    let mut text = "[[fault]]\n".to_owned();
    for (key, value) in fault {
        let is_plain = !key.is_empty() && key.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
        match value {
            Value::String(_) | Value::Number(_) | Value::Bool(_) if is_plain => {
                // A string of JSON is one of TOML; both escape alike.
                let _ = writeln!(text, "{key} = {value}");
            }
            _ => return Err(refused(format!("`{key}` of the fault has no plain value"), "write a number or a word")),
        }
    }
    Ok(text)
}

fn apply(order: &Order, faults: &[Fault], bus: &mut Bus<'_>) -> Reply {
    let mut states = Vec::new();
    let time_s = bus.time();
    let noise = order.can_errors.or(order.end_faults.then_some(0.0));
    if let Some(share) = noise.filter(|_| order.joint.is_none()) {
        bus.set_noise(None, share);
    }
    for index in 0..bus.joints.len() {
        if order.joint.is_some_and(|id| bus.joints[index].id != id) {
            continue;
        }
        if let Some(share) = noise {
            bus.set_noise(Some(index), share);
        }
        if order.bus_off {
            bus.force_off(index);
        }
        let joint = &mut bus.joints[index];
        let (now, seed) = (joint.time(), joint.seed());
        if let Some((rig, load)) = joint.rig().zip(order.load) {
            rig.set_external_torque(load);
        }
        if let Some((rig, half_backlash)) = joint.rig().zip(order.half_backlash) {
            rig.set_half_backlash(1e-6 * half_backlash);
        }
        if let Some(supply) = order.supply {
            joint.power.supply_voltage = supply;
        }
        if let Some(temperature) = order.motor_temperature {
            joint.power.set_motor_temperature(temperature);
        }
        if let Some(rig) = joint.rig().filter(|_| order.end_faults) {
            rig.end_faults(now);
        }
        if let Some(rig) = joint.rig() {
            for fault in faults {
                rig.inject(&Fault { start: now + fault.start, end: now + fault.end, ..*fault }, seed);
            }
        }
        if order.clear_fault {
            joint.drive.clear_fault();
        }
        if let Some(mode) = order.mode {
            joint.set_mode(mode);
        }
        if order.status {
            states.push(status(bus, index));
        }
    }
    Reply::Done { time_s, joints: states, bus: if order.status { BusReport::new(bus) } else { None } }
}

fn status(bus: &Bus<'_>, index: usize) -> Status {
    let joint = &bus.joints[index];
    let (truth, feedback) = (joint.truth(), joint.drive.feedback());
    Status {
        joint: joint.id,
        name: joint.name.clone(),
        state: format!("{:?}", joint.drive.state()),
        fault: joint.drive.fault().map(|fault| format!("{fault:?}")),
        mode: joint.mode(),
        position_turns: feedback.position.to_f32(),
        output_turns: feedback.output_position.map(|position| position.to_f32()),
        link_rad: truth.link,
        gap_um: 1e6 * truth.gap,
        half_backlash_um: 1e6 * truth.half_backlash,
        load_torque: truth.load_torque,
        motor_torque: truth.motor_torque,
        bus: feedback.sensors.bus_voltage,
        motor_temperature: feedback.sensors.motor_temperature,
        can: bus.can_state(index).map(|(can_state, (transmit_errors, receive_errors))| CanStatus {
            can_state,
            transmit_errors,
            receive_errors,
        }),
        compensated: joint.compensated().map(|state| CompensatedStatus {
            observer_source: format!("{:?}", state.source),
            observer_half_backlash_um: 1e6 * state.half_backlash,
            compensation_stage: format!("{:?}", state.stage),
            compensation_stepped_back: state.is_stepped_back,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::{Choices, Prepared};
    use scenario::plant::PlantName;

    /// Answer of a twin of one joint to a line.
    fn answer(joint: &str, plant: PlantName, line: &str) -> Value {
        let choices = Choices::of_plant(plant);
        let prepared = Prepared::load(1, Path::new(joint), &choices).expect("a preset");
        let mut bus = Bus::new(vec![prepared.start(&choices).expect("it is designed")], None, 1);
        serde_json::from_str(&execute(line, &mut bus)).expect("JSON")
    }

    #[test]
    fn broken_tooth_needs_plant_with_teeth() {
        let line = r#"{"fault": {"kind": "broken_tooth", "stiffness_ratio": 0.3}}"#;
        for (joint, plant, why) in
            [("q1", PlantName::Core, "share their stiffness"), ("c1", PlantName::Reference, "equivalent gear")]
        {
            let refused = answer(joint, plant, line);
            assert!(refused["error"].as_str().is_some_and(|error| error.contains(why)), "{joint}: {refused}");
        }
        assert!(answer("q1", PlantName::Reference, line)["time_s"].is_number());
        let other = r#"{"fault": {"kind": "encoder_frozen", "encoder": "output"}}"#;
        assert!(answer("q1", PlantName::Core, other)["time_s"].is_number());
    }
}

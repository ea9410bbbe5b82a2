//! Validated request for a simulation: joint, rate, length, torques and start are checked before the run.

use model_core::gears::{Kinematics, Mechanics};
use std::f64::consts::TAU;

use joint_file::{JointFile, Problem};
use link::messages::Command;
use model_core::gears::design::Effort;
use parameters::{Excitation, JointParameters};

use super::arguments::MotionArguments;
use super::start::StartName;
use super::stepping::SimulationSpec;
use board::device::board::Board;
use board::profile::{MAX_SPEED, MAX_TORQUE, TorqueProfile};
use joint_file::named::Loaded;
use report::failure::{Failure, Outcome};
use report::number::TYPED;

/// Rate of the board, and default rate of other runs [Hz].
const BOARD_RATE: u32 = 20_000;
/// Least number of ticks in a prescribed mesh period by default, for phase portraits and spectra.
const MIN_TICKS_PER_PERIOD: f64 = 48.0;
/// Default length under constant torques [s], and at a prescribed mesh frequency [mesh periods].
const DEFAULT_DURATION: f64 = 1.0;
const DEFAULT_MESH_PERIODS: f64 = 600.0;
/// Default speed of the carrier under constant torques: a turn a second [rad/s].
pub(crate) const DEFAULT_SPEED: f64 = TAU;
/// Largest number of ticks; more would take days at a microsecond each and are likely a typing error.
const MAX_TICKS: f64 = 2e10;

/// A validated simulation.
#[derive(Debug, Clone)]
pub struct SimulationPlan {
    /// Joint file as the user named it.
    pub name: String,
    /// Warnings of the joint file.
    pub warnings: Vec<Problem>,
    /// Simulation to run.
    pub run: SimulationSpec,
    /// Ticks before the figures.
    pub settle: u32,
    /// Torques in words, for reports.
    pub torques_name: String,
    /// True for constant torques.
    pub constant: bool,
    /// Name of the state at tick 0.
    pub start_name: StartName,
    /// Carrier speed at the start [rad/s].
    pub speed: f64,
    /// Board whose step is used; `None` if the accuracy decides.
    pub board: Option<String>,
}

impl SimulationPlan {
    /// Validates a motion of a joint.
    pub fn new(loaded: Loaded, motion: &MotionArguments) -> Outcome<Self> {
        let Loaded { name, file: joint, .. } = loaded;
        let parameters = &joint.parameters;
        let frequency = match parameters.excitation {
            Excitation::Time { mesh_frequency } => Some(mesh_frequency / TAU),
            Excitation::Angle => None,
        };
        let tick_rate = motion.rate.unwrap_or_else(|| default_rate(frequency));
        let given = |what: &str, value: Option<f64>| match value {
            Some(value) if !value.is_finite() => Err(Failure::new(format!("--{what} is {value}"))
                .with_help(format!("give a finite number, such as --{what} 1"))),
            value => Ok(value),
        };
        let within = |what: &str, value: Option<f64>, most: f64, unit: &str| match given(what, value)? {
            Some(value) if value.abs() > most => Err(Failure::new(format!("--{what} is {}", TYPED.write(value)))
                .with_help(format!("it may be from -{most} to {most} {unit}: check the unit"))),
            value => Ok(value),
        };
        let duration = given("duration", motion.duration)?;
        let (torques, ticks, torques_name) = match &motion.profile {
            Some(profile) => {
                let profile = TorqueProfile::load(profile, parameters, tick_rate, duration)?;
                (profile.commands, profile.ticks, format!("profile {}", profile.name))
            }
            None => {
                let ticks = tick_count(duration.unwrap_or_else(|| steady_duration(parameters)), tick_rate)?;
                let drive = within("drive", motion.drive, MAX_TORQUE, "N m")?;
                let load = within("load", motion.load, MAX_TORQUE, "N m")?;
                let command = constant_torques(&joint, drive, load);
                let (drive, load) = (command.drive_torque, command.load_torque);
                (vec![command], ticks, format!("constant torques of {drive} N m against {load} N m"))
            }
        };
        let constant = motion.profile.is_none();
        let settle = match given("settle", motion.settle)? {
            None if constant => ticks / 2,
            None => 0,
            Some(settle) => {
                let end = f64::from(ticks) / f64::from(tick_rate);
                if !(0.0..end).contains(&settle) {
                    let message = format!("--settle {settle} is not below the run's {end} s");
                    return Err(Failure::new(message).with_help("give 0 or more, and less than the duration"));
                }
                (settle * f64::from(tick_rate)).round() as u32
            }
        };
        let start_name = motion.start.unwrap_or(match (constant, frequency) {
            (false, _) => StartName::Rest,
            (true, Some(_)) => StartName::Centred,
            (true, None) => StartName::Seated,
        });
        let turning = if constant && frequency.is_none() { DEFAULT_SPEED } else { 0.0 };
        let speed = within("speed", motion.speed, MAX_SPEED, "rad/s")?.unwrap_or(turning);
        let first = torques.first().map_or((0.0, 0.0), |first| (first.drive_torque.into(), first.load_torque.into()));
        let start = start_name.state(parameters, speed, first);
        let board = motion.board.clone().unwrap_or_else(Board::emulated);
        let effort = if motion.accurate { Effort::Accurate } else { Effort::Within(board.processor()) };
        let board = (!motion.accurate).then(|| board.name().to_owned());
        let JointFile { parameters: joint, warnings, .. } = joint;
        let run = SimulationSpec { joint, tick_rate, ticks, torques, start, double: motion.f64, effort };
        Ok(Self { name, warnings, run, settle, torques_name, constant, start_name, speed, board })
    }

    /// Parameters of the joint.
    pub fn parameters(&self) -> &JointParameters {
        &self.run.joint
    }

    /// Length [s].
    pub fn duration(&self) -> f64 {
        f64::from(self.run.ticks) / f64::from(self.run.tick_rate)
    }

    /// Prescribed mesh frequency, or that of the initial speed [Hz].
    pub fn mesh_frequency(&self) -> f64 {
        match self.parameters().excitation {
            Excitation::Time { mesh_frequency } => mesh_frequency / TAU,
            Excitation::Angle => (self.speed / TAU * f64::from(self.parameters().geometry.ring_teeth)).abs(),
        }
    }
}

/// Default length of a run under constant torques [s].
pub(crate) fn steady_duration(joint: &JointParameters) -> f64 {
    match joint.excitation {
        Excitation::Time { mesh_frequency } => DEFAULT_MESH_PERIODS * TAU / mesh_frequency,
        Excitation::Angle => DEFAULT_DURATION,
    }
}

/// Multiple of the board's rate with enough ticks in a prescribed mesh period.
fn default_rate(frequency: Option<f64>) -> u32 {
    let wanted = frequency.unwrap_or(0.0) * MIN_TICKS_PER_PERIOD / f64::from(BOARD_RATE);
    // Beyond a thousand times the board's rate the design reports the error.
    BOARD_RATE * wanted.ceil().clamp(1.0, 1000.0) as u32
}

fn tick_count(seconds: f64, tick_rate: u32) -> Outcome<u32> {
    let ticks = seconds * f64::from(tick_rate);
    if !(1.0..=MAX_TICKS.min(f64::from(u32::MAX / 2))).contains(&ticks) {
        return Err(Failure::new(format!(
            "a run of {} s at {tick_rate} Hz is {} ticks",
            TYPED.write(seconds),
            TYPED.write(ticks)
        ))
        .with_help("give a duration of at least one tick and at most 2^31 ticks, such as --duration 1"));
    }
    Ok(ticks.round() as u32)
}

/// Stated operating point, or the requested torques; a missing torque balances the other one.
fn constant_torques(joint: &JointFile, drive: Option<f64>, load: Option<f64>) -> Command {
    let parameters = &joint.parameters;
    let ratio = parameters.geometry.ratio_by_radii();
    let (drive, load) = match (drive, load) {
        (Some(drive), Some(load)) => (drive, load),
        (Some(drive), None) => (drive, parameters.balanced_load_torque(drive)),
        (None, Some(load)) => (load / ratio, load),
        (None, None) => (joint.profile.drive_torque, parameters.balanced_load_torque(joint.profile.drive_torque)),
    };
    Command { tick: 0, drive_torque: drive as f32, load_torque: load as f32 }
}

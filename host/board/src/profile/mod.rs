//! Torque profiles on a tick grid, built in or read from a CSV file. Torques are rounded to f32 once, here, so that
//! board and twin get the same bits.

mod builtin;
mod recorded;
mod torques;

use std::path::Path;

use link::messages::Command;
use parameters::JointParameters;

use report::failure::{Failure, Outcome};
use report::number::TYPED;

pub use builtin::BUILTIN;
pub use recorded::check_time;
pub use torques::MAX_TORQUE;
use torques::Torques;

/// Largest speed of a link or carrier [rad/s].
pub const MAX_SPEED: f64 = 1e4;
/// Longest run along a recording without an explicit duration [s].
pub const LONGEST_RUN: f64 = 3600.0;
/// Rate of commands; the torques hold in between [Hz].
pub const COMMAND_RATE: u32 = 1000;

/// A torque profile on the board's tick grid.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueProfile {
    /// Name of the built-in profile, or path of the CSV.
    pub name: String,
    /// Torque changes in ascending order of ticks, from tick 0.
    pub commands: Vec<Command>,
    /// Length in ticks.
    pub ticks: u32,
}

impl TorqueProfile {
    /// Loads a built-in profile by name, or a CSV file by path. `duration` cuts the profile or extends its last torque
    /// [s].
    pub fn load(name: &str, joint: &JointParameters, tick_rate: u32, duration: Option<f64>) -> Outcome<Self> {
        if BUILTIN.contains(&name) {
            let seconds = duration.unwrap_or(builtin::DURATION);
            return Self::sampled(name, tick_rate, seconds, |from, to| builtin::reversals(joint, 0.5 * (from + to)));
        }
        let path = Path::new(name);
        if !path.exists() {
            let message = format!("there is no profile `{name}`, neither built in nor as a file");
            let help = format!(
                "built in: {}; or name a CSV file with columns {}",
                BUILTIN.join(", "),
                recorded::COLUMNS.join(", ")
            );
            return Err(Failure::new(message).with_help(help));
        }
        let recording = recorded::RecordedTorques::read(path)?;
        if duration.is_none() {
            check_length(recording.duration(), "--duration").map_err(|failure| failure.while_doing(path.display()))?;
        }
        let seconds = duration.unwrap_or(recording.duration());
        Self::sampled(name, tick_rate, seconds, |from, to| recording.mean(from, to))
    }

    /// Samples torques on the command grid; `mean(from, to)` returns the mean over an interval.
    fn sampled(name: &str, tick_rate: u32, seconds: f64, mean: impl Fn(f64, f64) -> Torques) -> Outcome<Self> {
        let ticks = seconds * f64::from(tick_rate);
        if !(1.0..=f64::from(u32::MAX / 2)).contains(&ticks) {
            return Err(Failure::new(format!(
                "a run of {} s at {tick_rate} Hz is {} ticks",
                TYPED.write(seconds),
                TYPED.write(ticks)
            ))
            .with_help("give a duration of at least one tick and at most 2^31 ticks, such as --duration 5"));
        }
        let ticks = ticks.round() as u32;
        let mut commands: Vec<Command> = Vec::new();
        for index in 0u32.. {
            let tick = grid_tick(index, tick_rate);
            if tick >= ticks {
                break;
            }
            let from = f64::from(tick) / f64::from(tick_rate);
            let to = f64::from(grid_tick(index + 1, tick_rate)) / f64::from(tick_rate);
            let Torques { drive, load } = mean(from, to);
            let command = Command { tick, drive_torque: drive as f32, load_torque: load as f32 };
            let same = |last: &Command| {
                (last.drive_torque.to_bits(), last.load_torque.to_bits())
                    == (command.drive_torque.to_bits(), command.load_torque.to_bits())
            };
            if !commands.last().is_some_and(same) {
                commands.push(command);
            }
        }
        Ok(Self { name: name.to_owned(), commands, ticks })
    }
}

/// Rejects a recording whose full length is more than [`LONGEST_RUN`]; the help names the `option` that limits it.
pub fn check_length(seconds: f64, option: &str) -> Outcome<()> {
    if seconds <= LONGEST_RUN {
        return Ok(());
    }
    Err(Failure::new(format!("the recording lasts {} s, a run at most {LONGEST_RUN} s", TYPED.write(seconds)))
        .with_help(format!("check the unit of time_s, cut the recording, or say how much of it to run by {option}")))
}

/// First tick at or after the start of a command interval.
fn grid_tick(index: u32, tick_rate: u32) -> u32 {
    (u64::from(index) * u64::from(tick_rate)).div_ceil(u64::from(COMMAND_RATE)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    const HELD: Torques = Torques { drive: 0.5, load: 3.0 };

    /// Only a change of torque becomes a command.
    #[test]
    fn constant_torque_sent_once() {
        let profile = TorqueProfile::sampled("held", 20_000, 1.0, |_, _| HELD).expect("a profile");
        assert_eq!(profile.commands, [Command { tick: 0, drive_torque: 0.5, load_torque: 3.0 }]);
        assert_eq!(profile.ticks, 20_000);
    }

    /// Commands ascend and end before the run does, at tick rates below and above the command rate.
    #[test]
    fn commands_ascend_within_run() {
        for tick_rate in [999, 1000, 20_000, 40_001] {
            let ramp = |from: f64, _| Torques { drive: from, load: -from };
            let profile = TorqueProfile::sampled("ramp", tick_rate, 0.1, ramp).expect("a profile");
            assert!(profile.commands.windows(2).all(|pair| pair[0].tick < pair[1].tick), "{tick_rate}");
            assert!(profile.commands.iter().all(|command| command.tick < profile.ticks), "{tick_rate}");
        }
    }

    /// Durations below one tick or above 2^31 ticks are rejected.
    #[test]
    fn run_without_tick_rejected() {
        for seconds in [0.0, -1.0, f64::NAN, 1e9] {
            assert!(TorqueProfile::sampled("none", 20_000, seconds, |_, _| HELD).is_err(), "{seconds}");
        }
    }
}

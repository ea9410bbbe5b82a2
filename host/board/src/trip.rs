//! Texts for the trips of a board: cause and remedy.

use link::messages::Trip;

use report::failure::Failure;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Trip that the board reported.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FaultEntry {
    /// Tick of the trip, if it has one.
    pub tick: Option<u32>,
    /// Short name, such as `command_loss`.
    pub name: String,
    /// Meaning and remedy.
    pub text: String,
}

/// Short name, tick if it has one, meaning, and remedy of a trip.
fn texts(trip: &Trip) -> (&'static str, Option<u32>, &'static str, &'static str) {
    match *trip {
        Trip::CommandLoss { tick } => (
            "command_loss",
            Some(tick),
            "no message or no command came for longer than the command timeout",
            "check the line and the load of this machine, or run on the emulated board",
        ),
        Trip::NotFinite { tick } => (
            "not_finite",
            Some(tick),
            "the simulated state is no longer finite",
            "check joint file and profile: `joint check` prints the longest stable step",
        ),
        Trip::BadCommand { tick } => {
            ("bad_command", Some(tick), "a commanded torque is not finite", "check the profile's torques")
        }
        Trip::LateCommand { tick } => (
            "late_command",
            Some(tick),
            "a command came out of order or for a tick that has passed",
            "the host or the line is too slow for --mode realtime: lower the load or run with --mode lockstep",
        ),
        Trip::BadDigest => {
            ("bad_digest", None, "the tables on the board do not match their digest", "flash the image again")
        }
        Trip::QueueFull => (
            "queue_full",
            None,
            "more commands came than the board's queue holds",
            "board and host disagree about the queue: flash this checkout's image",
        ),
        Trip::BadSettings => {
            ("bad_settings", None, "the board cannot run with these settings", "check --decimation and --mode")
        }
        Trip::NotRunning => (
            "not_running",
            None,
            "torques came for a run that was not started or has stopped",
            "the board was reset during the run: check its power, then run again",
        ),
        Trip::WrongRole => (
            "wrong_role",
            None,
            "the commands are for another role than the board's",
            "flash the image of the role that this run asks for",
        ),
        Trip::FarHorizon { tick } => (
            "far_horizon",
            Some(tick),
            "a schedule reaches farther ahead than ten command timeouts",
            "send shorter schedules, or set a longer command timeout",
        ),
        Trip::Overtaken => (
            "overtaken",
            None,
            "a reset was overtaken by a stop, by work on flash, or by a silence",
            "wait for the answer to the preceding message, then reset again",
        ),
    }
}

/// Failure that ends a run with a trip.
pub fn failure(trip: &Trip) -> Failure {
    let (name, tick, what, help) = texts(trip);
    let place = tick.map(|tick| format!(" at tick {tick}")).unwrap_or_default();
    let happened = match trip {
        // The requested action was refused and nothing else changed.
        Trip::NotRunning | Trip::WrongRole | Trip::Overtaken => "the board refused a message",
        _ => "the board went into its safe state",
    };
    Failure::check_failed(format!("{happened}{place}: {what} ({name})")).with_help(help)
}

/// Entry of the record for a trip.
pub fn entry(trip: &Trip) -> FaultEntry {
    let (name, tick, what, help) = texts(trip);
    FaultEntry { tick, name: name.to_owned(), text: format!("{what}; {help}") }
}

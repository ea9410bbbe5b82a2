//! Validated request to run a joint on a board: joint, profile and rates are checked before anything is built or
//! started.

use std::path::{Path, PathBuf};

use board::device::board::Board;
use board::device::image;
use board::device::tick_time::RateCheck;
use board::line_options::{LineOptions, Mode};
use board::profile::TorqueProfile;
use board::session::{BoardHelp, Expected, command_timeout};
use board::twin;
use clap::ValueEnum;
use joint_file::JointFile;
use joint_file::named::{self, Loaded};
use joint_file::warnings;
use link::messages::{Role, RunMode, RunSettings};
use model_core::gears::certificate::Substeps;
use report::command_line::quoted;
use report::failure::{Failure, Outcome};

/// Requested run.
#[derive(Debug, Clone)]
pub struct RunRequest<'a> {
    /// Joint file, or the name of a preset.
    pub file: &'a Path,
    /// Board, and the line to it.
    pub line: &'a LineOptions,
    /// Lockstep (the board waits for the host) or real time; by default lockstep on the emulated board, real time on a
    /// real one.
    pub mode: Option<Mode>,
    /// Step rate, part of the image [Hz].
    pub rate: u32,
    /// Name of a built-in torque profile, or a CSV file.
    pub profile: &'a str,
    /// Length of the run; the profile's length by default [s].
    pub duration: Option<f64>,
    /// Steps per sample.
    pub decimation: u16,
    /// True if the board already has its image.
    pub no_build: bool,
    /// True to build and run even if the worst-case tick exceeds the period.
    pub force: bool,
    /// True to skip the f64 reference.
    pub no_reference: bool,
    /// Folder of the results.
    pub out: Option<&'a Path>,
    /// File for a copy of the record as JSON.
    pub json: Option<&'a Path>,
    /// File for a picture of the first reversal through the gap.
    pub picture: Option<&'a Path>,
}

/// Validated run.
#[derive(Debug, Clone)]
pub struct RunPlan {
    /// Joint file as named by the user.
    pub name: String,
    /// Joint file for the firmware's build.
    pub path: PathBuf,
    /// Content of the joint file.
    pub joint: JointFile,
    /// Board of the image.
    pub board: Board,
    /// Expected identity of the board.
    pub expected: Expected,
    /// Sub-steps of a tick with a change of contact.
    pub substeps: Substeps,
    /// Torques.
    pub profile: TorqueProfile,
    /// Settings of the run.
    pub settings: RunSettings,
}

impl RunPlan {
    /// Reads and designs everything that a run needs.
    pub fn new(request: &RunRequest<'_>) -> Outcome<Self> {
        let loaded = named::load(request.file)?;
        warnings::print(&loaded);
        let path = image::joint_file(request.file, &loaded.name);
        let Loaded { name, file: joint, .. } = loaded;
        let parameters = &joint.parameters;
        let on_board = RateCheck::new(parameters, request.line.board(), Role::Plant);
        on_board.check_unless_forced(request.rate, request.force)?;
        let substeps = on_board.substeps(request.rate).map_err(|error| Failure::new(error.to_string()))?;
        let digest = twin::tables_digest(parameters, request.line.board().chip(), request.rate)?;
        let profile = TorqueProfile::load(request.profile, parameters, request.rate, request.duration)?;
        let mode = match (request.mode, &request.line.port) {
            (Some(Mode::Lockstep), _) | (None, None) => RunMode::Lockstep,
            (Some(Mode::Realtime), _) | (None, Some(_)) => RunMode::Realtime,
        };
        if u32::from(request.decimation) > profile.ticks {
            let message = format!("a sample every {} steps in a run of {}", request.decimation, profile.ticks);
            return Err(Failure::new(message).with_help("lower --decimation or raise --duration"));
        }
        let expected = Expected {
            joint: parameters.name.to_string(),
            digest,
            tick_rate: request.rate,
            planets: parameters.geometry.planets,
            role: Role::Plant,
            control_digest: None,
            help: request.help(),
        };
        let command_timeout = command_timeout(request.rate, request.line.port.is_none());
        let settings = RunSettings { mode, decimation: request.decimation, command_timeout, from_memory: false };
        Ok(Self { name, path, board: request.line.board().clone(), expected, substeps, profile, settings, joint })
    }
}

impl RunRequest<'_> {
    /// Remedy for a board with another identity.
    fn help(&self) -> BoardHelp {
        if self.line.port.is_none() {
            return BoardHelp::Rebuild;
        }
        let (file, board) = (quoted(&self.file.display().to_string()), self.line.board_argument());
        let force = if self.force { " --force" } else { "" };
        let command = format!("cargo joint flash {file} --board {board}{}{force}", self.rate_option());
        if self.no_build { BoardHelp::Flash(command) } else { BoardHelp::FlashBuilt(command) }
    }

    /// Command that repeats the run.
    pub fn replay_command(&self) -> String {
        let mut command =
            format!("cargo joint hil {}{}", quoted(&self.file.display().to_string()), self.line.repeated_options());
        let mut option = |name: &str, value: Option<String>| {
            if let Some(value) = value {
                command += &format!(" --{name} {}", quoted(&value));
            }
        };
        option("mode", self.mode.and_then(|mode| mode.to_possible_value()).map(|mode| mode.get_name().to_owned()));
        option("profile", Some(self.profile.to_owned()));
        option("duration", self.duration.map(|duration| duration.to_string()));
        option("decimation", Some(self.decimation.to_string()));
        for (name, given) in [("no-reference", self.no_reference), ("no-build", self.no_build), ("force", self.force)] {
            if given {
                command += &format!(" --{name}");
            }
        }
        command + &self.rate_option()
    }

    fn rate_option(&self) -> String {
        if self.rate == image::DEFAULT_TICK_RATE { String::new() } else { format!(" --rate {}", self.rate) }
    }
}

//! What `joint hil` was asked to do, with everything that can be wrong with it found before anything is built or
//! started: joint, profile, rates. Boards and files to be written are looked at later.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use joints::JointFile;
use link::messages::{Role, RunMode, RunSettings};

use super::line_options::LineOptions;
use super::profile::{BUILTIN, Profile};
use super::session::{Expected, Mend};
use super::twin;
use crate::failure::{Failure, Outcome};
use crate::target::board::Board;
use crate::target::image;
use crate::trial::plant::PlantName;
use crate::{check, images};

/// Arguments of `joint hil`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint hil                                   the emulated board: joint q1, then observer and compensation
  joint hil --full                            then every test, with all its seeds, around the f64 reference
  joint hil joints/l1.toml --duration 10      another joint, a longer run
  joint hil q1 --profile drive.csv --json out.json
  joint hil q1 --port /dev/ttyUSB0            a real board, flashed before by `joint flash q1`
  joint hil hil --host --plant reference      all tests of observer and compensation in the folder hil
  joint hil hil/t2.toml --host --seed 7       one of them, with another seed
  joint hil hil/t2.toml --role loop           the same with joint and controller on the emulated board

Exit code: 0 if every check held, 1 if one did not, 2 for bad input or a bad environment, 130 after Ctrl-C.")]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, paper, paper_printed; or a test file, or a folder
    /// of them (docs/hil-file.md) [default: joint q1, then the short run of the tests in hil]
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// Test files: runs observer and compensation on this machine, without a board
    #[arg(long, conflicts_with = "role")]
    pub host: bool,
    /// Test files: what the board does, observer and compensation or the whole loop with the joint [default: loop]
    #[arg(long, value_enum)]
    pub role: Option<RoleName>,
    /// Test files: runs this seed in place of the file's
    #[arg(long, value_name = "N", value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Test files: what is controlled [default: core]
    #[arg(long, value_enum)]
    pub plant: Option<PlantName>,
    /// Test files: runs the full lists of seeds, and files that are only for those; without FILE all of them
    #[arg(long)]
    pub full: bool,
    /// Test files: writes the results as JUnit XML to this file too
    #[arg(long, value_name = "XML")]
    pub junit: Option<PathBuf>,
    /// Which board, and how it is reached.
    #[command(flatten)]
    pub line: LineOptions,
    /// Who waits for whom [default: lockstep on the emulated board, realtime on a real one]
    #[arg(long, value_enum)]
    pub mode: Option<Mode>,
    /// Steps a second, in Hz; part of the image
    #[arg(long, value_name = "HZ", default_value_t = image::DEFAULT_TICK_RATE, value_parser = clap::value_parser!(u32).range(1..))]
    pub rate: u32,
    /// Torque profile: `reversals`, or a CSV file with the columns time_s, motor_torque_Nm and load_torque_Nm
    #[arg(long, value_name = "NAME|FILE", default_value = BUILTIN[0])]
    pub profile: String,
    /// Length of the run in s [default: the profile's own; 5 s for `reversals`]
    #[arg(long, value_name = "S")]
    pub duration: Option<f64>,
    /// A sample every so many steps; the digest covers every step
    #[arg(long, value_name = "STEPS", default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..))]
    pub decimation: u16,
    /// Folder for report.html, record.json and log.txt [default: target/hil/<joint>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Writes the record as JSON to this file too
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,
    /// Draws the first reversal through the gap to this file (SVG), for a document
    #[arg(long, value_name = "SVG")]
    pub picture: Option<PathBuf>,
    /// Does not compute the f64 reference
    #[arg(long)]
    pub no_reference: bool,
    /// Does not build the image: logs stay encoded, and its size is not checked
    #[arg(long, requires = "port")]
    pub no_build: bool,
    /// Also builds the images of all boards, lints the firmware and runs the tests that need the emulated board
    #[arg(long, conflicts_with = "port")]
    pub check: bool,
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

/// What a board does in tests of observer and compensation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RoleName {
    /// Observer and compensation; the joint is simulated here
    Observer,
    /// Joint, motor, observer and compensation
    Loop,
}

/// Who waits for whom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// The board waits for the host before every step that it has no torques for
    Lockstep,
    /// The board's clock rules, the host streams ahead
    Realtime,
}

/// A run that can be made.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The joint file as the user named it.
    pub name: String,
    /// The joint file for the firmware's build.
    pub path: PathBuf,
    /// What it says.
    pub joint: JointFile,
    /// The board that its image is for.
    pub board: Board,
    /// What the board must be.
    pub expected: Expected,
    /// The torques.
    pub profile: Profile,
    /// How the run goes.
    pub settings: RunSettings,
}

/// In real time a board without torques for so long goes to its safe state [s].
const COMMAND_TIMEOUT: f64 = 0.1;

impl Plan {
    /// Reads and designs all that a run needs.
    pub fn new(arguments: &Arguments) -> Outcome<Self> {
        let loaded = check::load(arguments.file())?;
        let path = images::joint_file(arguments.file(), &loaded);
        let check::Loaded { name, file: joint, .. } = loaded;
        let parameters = &joint.parameters;
        let digest = twin::tables_digest(parameters, arguments.line.board, arguments.rate)?;
        let profile = Profile::load(&arguments.profile, parameters, arguments.rate, arguments.duration)?;
        let mode = match (arguments.mode, &arguments.line.port) {
            (Some(Mode::Lockstep), _) | (None, None) => RunMode::Lockstep,
            (Some(Mode::Realtime), _) | (None, Some(_)) => RunMode::Realtime,
        };
        if u32::from(arguments.decimation) > profile.ticks {
            let message = format!("a sample every {} steps in a run of {}", arguments.decimation, profile.ticks);
            return Err(Failure::new(message).with_help("lower --decimation or raise --duration"));
        }
        let expected = Expected {
            joint: parameters.name.to_string(),
            digest,
            tick_rate: arguments.rate,
            planets: parameters.geometry.planets,
            role: Role::Plant,
            control_digest: None,
            mend: arguments.mend(),
        };
        let command_timeout = (COMMAND_TIMEOUT * f64::from(arguments.rate)).ceil() as u32;
        let settings = RunSettings { mode, decimation: arguments.decimation, command_timeout, from_memory: false };
        Ok(Self { name, path, board: arguments.line.board, expected, profile, settings, joint })
    }
}

impl Arguments {
    /// The file, or the joint of a run that names none.
    pub fn file(&self) -> &Path {
        self.file.as_deref().unwrap_or(Path::new("q1"))
    }

    /// What to do about a board that is another one.
    fn mend(&self) -> Mend {
        if self.line.port.is_none() {
            return Mend::Rebuild;
        }
        let (file, board) = (self.file().display(), self.line.board.name());
        let command = format!("cargo joint flash {file} --board {board}{}", self.rate_option());
        if self.no_build { Mend::Flash(command) } else { Mend::FlashBuilt(command) }
    }

    /// The command that makes this run again.
    pub fn replay_command(&self) -> String {
        let mut command = format!("cargo joint hil {}", self.file().display());
        let mut option = |name: &str, value: Option<String>| {
            if let Some(value) = value {
                command += &format!(" --{name} {value}");
            }
        };
        option("port", self.line.port.clone());
        option("baud", self.line.baud.map(|baud| baud.to_string()));
        option("board", self.line.port.as_ref().map(|_| self.line.board.name().to_owned()));
        option("mode", self.mode.and_then(|mode| mode.to_possible_value()).map(|mode| mode.get_name().to_owned()));
        option("profile", Some(self.profile.clone()));
        option("duration", self.duration.map(|duration| duration.to_string()));
        option("decimation", Some(self.decimation.to_string()));
        command + &self.rate_option()
    }

    fn rate_option(&self) -> String {
        if self.rate == image::DEFAULT_TICK_RATE { String::new() } else { format!(" --rate {}", self.rate) }
    }
}

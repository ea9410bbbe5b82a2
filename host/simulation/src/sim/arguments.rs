//! Command line of `joint sim`.

use std::path::PathBuf;

use super::scheme::{SchemeChoice, SchemeName};
use super::start::StartName;
use board::device::board::Board;
use live::PacedLiveOptions;
use report::command_line::quoted;
use report::failure::{Failure, Outcome};

/// Arguments of `joint sim`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  joint sim                                        joint q1, turning under its rated torque
  joint sim paper --set half_backlash_um=120       the paper's joint, chaotic
  joint sim joints/l1.toml --profile reversals     torque steps through the gap
  joint sim --profile reversals --live --live-wait --live-speed 0.1   a page that shows it in slow motion
  joint sim paper --scheme all                     every scheme against the reference

Exit code: 0 if the run came to its end, 2 for bad input or a bad environment, 130 after Ctrl-C.")]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed
    #[arg(value_name = "FILE", default_value = "q1")]
    pub file: PathBuf,
    /// Integration scheme
    #[arg(long, value_enum, default_value = "realtime")]
    pub scheme: SchemeChoice,
    /// Motion, as for a sweep
    #[command(flatten)]
    pub motion: MotionArguments,
    /// Keeps every n-th tick in files and pictures [default: at most 200 000 samples]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub every: Option<u32>,
    /// Skips the energy balance
    #[arg(long)]
    pub no_energy: bool,
    /// Live view.
    #[command(flatten)]
    pub live: PacedLiveOptions,
    /// Folder for report.html, history.csv and history.mcap; a file that this command did not write is refused
    /// [default: joint-out/sim/<joint>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Also writes the figures as JSON to this file ("-": to standard output; all other output goes to standard error)
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,
}

/// Motion of the joint, for `joint sim` and `joint sweep`.
#[derive(Debug, Clone, clap::Args)]
pub struct MotionArguments {
    /// Changes a value of the joint file for this run, such as sun_planet.half_backlash_um=60; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Length of the run in s [default: the profile's own; else 1 s, or 600 periods of a prescribed mesh frequency]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub duration: Option<f64>,
    /// Time excluded from figures, spectrum and phase portrait, in s [default: half of a run under constant torques,
    /// else 0]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub settle: Option<f64>,
    /// Step rate in Hz [default: 20000; more if a prescribed mesh period would have fewer than 48 ticks]
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1..))]
    pub rate: Option<u32>,
    /// Torque profile in place of constant torques: `reversals`, or a CSV file with the columns time_s, motor_torque_Nm
    /// and load_torque_Nm
    #[arg(long, value_name = "NAME|FILE", conflicts_with_all = ["drive", "load"])]
    pub profile: Option<String>,
    /// Constant torque on the sun shaft in N m [default: the file's drive torque, or the balance of its rated torque]
    #[arg(long, value_name = "NM", allow_negative_numbers = true)]
    pub drive: Option<f64>,
    /// Constant torque that brakes the link in N m [default: the balance of the drive torque]
    #[arg(long, value_name = "NM", allow_negative_numbers = true)]
    pub load: Option<f64>,
    /// State at the start [default: rest with a profile, centred at a prescribed mesh frequency, else seated]
    #[arg(long, value_enum)]
    pub start: Option<StartName>,
    /// Speed of the carrier at the start in rad/s [default: one turn a second under constant torques and mode "angle",
    /// else 0]
    #[arg(long, value_name = "RAD/S", allow_negative_numbers = true)]
    pub speed: Option<f64>,
    /// Computes the core's schemes in f64 in place of the board's f32
    #[arg(long)]
    pub f64: bool,
    /// Board whose step is used: a name of boards/, or the path of a board file [default: olimex-h405]
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse)]
    pub board: Option<Board>,
    /// Uses as many sub-steps as the accuracy needs, even beyond a board's time
    #[arg(long, conflicts_with = "board")]
    pub accurate: bool,
}

impl MotionArguments {
    /// Rejects options without effect on a scheme.
    pub fn check_for(&self, scheme: SchemeName) -> Outcome<()> {
        let of_core = [("f64", self.f64), ("accurate", self.accurate), ("board", self.board.is_some())];
        let idle = of_core.iter().find(|(_, given)| *given && scheme == SchemeName::Reference);
        idle.map_or(Ok(()), |(name, _)| {
            Err(Failure::new(format!(
                "--{name} has no effect on --scheme reference, which runs in f64 at its own step, without a board"
            ))
            .with_help("leave it out, or name a scheme of the core: realtime, paper, rk4, euler"))
        })
    }

    /// Options that repeat the motion, each with a leading space.
    pub fn replay(&self) -> String {
        let shown = |(name, value): (&str, Option<String>)| match value {
            Some(value) => format!(" --{name} {}", quoted(&value)),
            None => format!(" --{name}"),
        };
        self.options().into_iter().map(shown).collect()
    }

    /// Options that repeat the motion, as words of a command line.
    pub fn words(&self) -> Vec<String> {
        let word = |(name, value): (&str, Option<String>)| match value {
            Some(value) => format!("--{name}={value}"),
            None => format!("--{name}"),
        };
        self.options().into_iter().map(word).collect()
    }

    /// Given options with their values; `None` for an option without value.
    fn options(&self) -> Vec<(&'static str, Option<String>)> {
        let mut options: Vec<_> = self.set.iter().map(|change| ("set", Some(change.clone()))).collect();
        let valued = [
            ("duration", self.duration.map(|value| value.to_string())),
            ("settle", self.settle.map(|value| value.to_string())),
            ("rate", self.rate.map(|value| value.to_string())),
            ("profile", self.profile.clone()),
            ("drive", self.drive.map(|value| value.to_string())),
            ("load", self.load.map(|value| value.to_string())),
            ("start", self.start.map(|start| start.name().to_owned())),
            ("speed", self.speed.map(|value| value.to_string())),
            ("board", self.board.as_ref().map(|board| board.argument.clone())),
        ];
        options.extend(valued.into_iter().filter(|(_, value)| value.is_some()));
        let flags = [("f64", self.f64), ("accurate", self.accurate)];
        options.extend(flags.into_iter().filter(|(_, given)| *given).map(|(name, _)| (name, None)));
        options
    }
}

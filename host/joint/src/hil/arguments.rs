//! The command line of `joint hil`.

use std::path::{Path, PathBuf};

use board::device::image;
use board::line_options::{LineOptions, Mode, RoleName};
use board::profile::BUILTIN;
use joint_run::plan::RunRequest;
use live::PacedLiveOptions;
use report::seeds::Seeds;
use report::workspace::workspace;
use scenario::plant::PlantName;
use tasks::EngineArguments;

/// Folder of the tests that come with the program, in the workspace and in an installed program's data.
pub const TESTS: &str = "hil";
/// Steps between two samples by default.
const DECIMATION: u16 = 20;

/// Arguments of `joint hil`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint hil                                   the emulated board: joint q1, then observer and compensation
  joint hil --full                            then every test, with all its seeds, around the f64 reference
  joint hil joints/l1.toml --duration 10      another joint, a longer run
  joint hil q1 --profile drive.csv --json out.json
  joint hil q1 --port /dev/ttyUSB0            a real board, flashed before by `joint flash q1`
  joint hil --host                            all tests of observer and compensation around the f64 reference
  joint hil hil --host --plant reference      all tests of observer and compensation in the folder hil
  joint hil hil/t2.toml --host --seed 7       one of them, with another seed
  joint hil hil/t2.toml --host --live --live-speed 1   a page that shows it in real time
  joint hil hil/never-worse.toml --host --seed 1-10000 --dask tcp://10.0.0.5:8786   on the workers of a Dask scheduler
  joint hil hil/t2.toml --role loop           the same with joint and controller on the emulated board

Exit code: 0 if every check held, 1 if one did not, 2 for bad input or a bad environment, 130 after Ctrl-C.")]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed; or a test file, or a folder
    /// of them (docs/reference/hil-file.md) [default: joint q1, then the short run of the tests in hil; with --host the folder hil]
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// Test files: runs observer and compensation on this machine, without a board
    #[arg(long, conflicts_with = "role")]
    pub host: bool,
    /// Test files: role of the board: observer and compensation, or the whole loop with the joint [default: loop]
    #[arg(long, value_enum)]
    pub role: Option<RoleName>,
    /// Test files with --host: saves the estimated parameters at the end of each run, as a board does, with their joint
    /// file, for `joint memory`
    #[arg(long, requires = "host", conflicts_with_all = ["role", "force"])]
    pub memory: bool,
    /// Test files with --host: keeps the result of every seed in the folder `tasks` of --out, and goes on from the results
    /// that are there; --dask and --slurm do so too
    #[arg(long)]
    pub resume: bool,
    /// Test files with --host: engine of the tasks.
    #[command(flatten)]
    pub engine: EngineArguments,
    /// Test files: runs this seed, or a range of seeds (1-10000), in place of the file's
    #[arg(long, value_name = "N|FROM-TO", allow_negative_numbers = true)]
    pub seed: Option<Seeds>,
    /// Test files: model of the joint that is controlled [default: core]
    #[arg(long, value_enum)]
    pub plant: Option<PlantName>,
    /// Test files: runs the full lists of seeds, and the files that only a full run includes; without FILE every test
    #[arg(long)]
    pub full: bool,
    /// Test files: also writes the results as JUnit XML to this file
    #[arg(long, value_name = "XML")]
    pub junit: Option<PathBuf>,
    /// Board and its connection.
    #[command(flatten)]
    pub line: LineOptions,
    /// Pacing: lockstep, or the board's own clock [default: lockstep on the emulated board, realtime on a real one]
    #[arg(long, value_enum)]
    pub mode: Option<Mode>,
    /// Step rate in Hz; part of the image [default: 20000]
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1..))]
    pub rate: Option<u32>,
    /// Torque profile: `reversals`, or a CSV file with the columns time_s, motor_torque_Nm and load_torque_Nm
    /// [default: reversals]
    #[arg(long, value_name = "NAME|FILE")]
    pub profile: Option<String>,
    /// Length of the run in s [default: the profile's own; 5 s for `reversals`]
    #[arg(long, value_name = "S")]
    pub duration: Option<f64>,
    /// Steps between two samples; the digest covers every step [default: 20]
    #[arg(long, value_name = "STEPS", value_parser = clap::value_parser!(u16).range(1..))]
    pub decimation: Option<u16>,
    /// Test files: live view of the tested controller, one run at a time, on the host or with --role observer.
    #[command(flatten)]
    pub live: PacedLiveOptions,
    /// Folder for report.html, record.json, log.txt and run.mcap; a file that this command did not write is refused [default: joint-out/hil/<joint>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Also writes the record as JSON to this file ("-": to standard output; all other output goes to standard error)
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,
    /// Draws the first reversal through the gap to this file (SVG), for a document
    #[arg(long, value_name = "SVG")]
    pub picture: Option<PathBuf>,
    /// Skips the f64 reference
    #[arg(long)]
    pub no_reference: bool,
    /// Skips the build of the image: logs stay encoded, and the size of the image is not checked
    #[arg(long, requires = "port")]
    pub no_build: bool,
    /// Builds and runs even if the worst-case tick exceeds the period; the board reports `forced` in its identity
    #[arg(long, conflicts_with = "host")]
    pub force: bool,
    /// Also builds the images of all boards, lints the firmware and runs the tests that need the emulated board
    #[arg(long, conflicts_with_all = ["port", "baud", "named_board", "no_build"])]
    pub check: bool,
}

impl Arguments {
    /// File of the run; if the command line names none, the folder of tests with `--host`, else joint q1.
    pub fn file(&self) -> &Path {
        self.file.as_deref().unwrap_or(Path::new(if self.host { TESTS } else { "q1" }))
    }

    /// Path of the tests: as typed, or among the tests that come with the program if nothing lies there.
    pub fn tests(&self) -> PathBuf {
        let typed = self.file();
        if typed.starts_with(TESTS) && !typed.exists() { workspace().join(typed) } else { typed.to_owned() }
    }

    /// Step rate [Hz].
    pub fn rate(&self) -> u32 {
        self.rate.unwrap_or(image::DEFAULT_TICK_RATE)
    }

    /// Request for a run of a joint on a board.
    pub fn request(&self) -> RunRequest<'_> {
        RunRequest {
            file: self.file(),
            line: &self.line,
            mode: self.mode,
            rate: self.rate(),
            profile: self.profile.as_deref().unwrap_or(BUILTIN[0]),
            duration: self.duration,
            decimation: self.decimation.unwrap_or(DECIMATION),
            no_build: self.no_build,
            force: self.force,
            no_reference: self.no_reference,
            out: self.out.as_deref(),
            json: self.json.as_deref(),
            picture: self.picture.as_deref(),
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    fn tests(words: &[&str]) -> PathBuf {
        Line::parse_from([&["joint"], words].concat()).arguments.tests()
    }

    /// The tests of the program are found from any folder; a test runs in the folder of this crate, which has no `hil`.
    #[test]
    fn bundled_tests_found_from_any_folder() {
        assert!(!Path::new(TESTS).exists());
        assert_eq!(tests(&["hil/t2.toml", "--host"]), workspace().join("hil/t2.toml"));
        assert_eq!(tests(&["--host"]), workspace().join("hil"));
        assert_eq!(tests(&["other/t2.toml"]), Path::new("other/t2.toml"));
        assert_eq!(tests(&["src/main.rs"]), Path::new("src/main.rs"));
        assert_eq!(tests(&[]), Path::new("q1"));
    }
}

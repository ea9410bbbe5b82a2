//! Command line of `joint memory`.

use std::path::PathBuf;

use clap::Subcommand;

use board::line_options::LineOptions;
use board::line_options::RoleName;

/// Arguments of `joint memory`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "A memory holds the parameters that the observer on a board has estimated: half-backlash, compliance, offset, encoder \
errors. It is valid only with the joint file and encoders that the board's image was built from.

Examples:
  joint memory keep --port /dev/ttyACM0               parameters of the last run, to the flash
  joint memory read q1.memory --port /dev/ttyACM0     from the flash to a file, and show
  joint memory show q1.memory --joint joints/q1.toml  show the contents
  joint memory write q1.memory --port /dev/ttyACM0    to the flash of a board
  joint memory write q1.memory --joint q1             checked by the firmware on the emulated board
  joint memory erase --port /dev/ttyACM0              erase the flash

Exit code: 0 if it was done, 2 for bad input or a bad environment, 130 after Ctrl-C."
)]
pub struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Show the parameters in a memory, with intervals and units, beside those of its joint file
    Show {
        /// Memory to show
        #[arg(value_name = "MEMORY")]
        file: PathBuf,
        /// Joint file (TOML) or preset of the run in which the parameters were estimated
        #[arg(long, value_name = "FILE", default_value = "q1")]
        joint: PathBuf,
        /// Writes the parameters as JSON ("-": to standard output, in place of the text)
        #[arg(long, value_name = "OUT")]
        json: Option<PathBuf>,
    },
    /// Read a memory from the flash of a board into a file, and show it
    Read {
        /// File to write
        #[arg(value_name = "MEMORY")]
        file: PathBuf,
        #[command(flatten)]
        place: BoardArguments,
    },
    /// Send a memory to a board, which checks it and writes it to its flash
    Write {
        /// Memory to send
        #[arg(value_name = "MEMORY")]
        file: PathBuf,
        #[command(flatten)]
        place: BoardArguments,
    },
    /// Have a board write the parameters that it estimated in its last run to its flash
    Keep {
        #[command(flatten)]
        place: BoardArguments,
    },
    /// Have a board erase its estimated parameters, in its flash too
    Erase {
        #[command(flatten)]
        place: BoardArguments,
    },
}

/// Board, joint and role.
#[derive(Debug, clap::Args)]
pub(super) struct BoardArguments {
    /// Board and its connection.
    #[command(flatten)]
    pub line: LineOptions,
    /// Joint file (TOML) or preset of the board's image
    #[arg(long, value_name = "FILE", default_value = "q1")]
    pub joint: PathBuf,
    /// Role of the emulated board [default: observer]
    #[arg(long, value_enum, conflicts_with_all = ["port", "baud", "named_board"])]
    pub role: Option<RoleName>,
}

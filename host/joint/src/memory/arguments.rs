//! What `joint memory` may be asked for on the command line.

use std::path::PathBuf;

use clap::Subcommand;

use board::line_options::LineOptions;
use board::line_options::RoleName;

/// Arguments of `joint memory`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "A memory is what the observer on a board has learnt: half-backlash, compliance, offset, encoder errors. It \
is good for the joint file and encoders that the board's image was built from, and for nothing else.

Examples:
  joint memory keep --port /dev/ttyACM0               what was learnt in the last run, to the flash
  joint memory read q1.memory --port /dev/ttyACM0     from the flash to a file, and shown
  joint memory show q1.memory --joint joints/q1.toml  what is in it
  joint memory write q1.memory --port /dev/ttyACM0    to the flash of a board
  joint memory write q1.memory --joint q1             judged by the firmware on the emulated board
  joint memory erase --port /dev/ttyACM0              forgotten

Exit code: 0 if it was done, 2 for bad input or a bad environment, 130 after Ctrl-C."
)]
pub struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Show what is in a memory, with intervals and units, beside its joint file
    Show {
        /// The memory
        #[arg(value_name = "MEMORY")]
        file: PathBuf,
        /// Joint file (TOML) or preset that it was learnt with
        #[arg(long, value_name = "FILE", default_value = "q1")]
        joint: PathBuf,
        /// Writes the same as JSON ("-" is standard output, in place of the text)
        #[arg(long, value_name = "OUT")]
        json: Option<PathBuf>,
    },
    /// Read a memory off the flash of a board into a file, and show it
    Read {
        /// File that is to be written
        #[arg(value_name = "MEMORY")]
        file: PathBuf,
        #[command(flatten)]
        place: BoardArguments,
    },
    /// Bring a memory to a board, which judges it and writes it to its flash
    Write {
        /// The memory
        #[arg(value_name = "MEMORY")]
        file: PathBuf,
        #[command(flatten)]
        place: BoardArguments,
    },
    /// Have a board write what it has learnt in its last run to its flash
    Keep {
        #[command(flatten)]
        place: BoardArguments,
    },
    /// Have a board forget what it has learnt, in its flash too
    Erase {
        #[command(flatten)]
        place: BoardArguments,
    },
}

/// Which board.
#[derive(Debug, clap::Args)]
pub(super) struct BoardArguments {
    /// Which board, and how it is reached.
    #[command(flatten)]
    pub line: LineOptions,
    /// Joint file (TOML) or preset of the board's image
    #[arg(long, value_name = "FILE", default_value = "q1")]
    pub joint: PathBuf,
    /// What the emulated board does [default: observer]
    #[arg(long, value_enum, conflicts_with = "port")]
    pub role: Option<RoleName>,
}

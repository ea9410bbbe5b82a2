//! The options that name a board, its role and its line, which every command that talks to one has.

use clap::ValueEnum;
use link::messages::{Role, RunMode};

use crate::target::board::Board;

/// Which board, and how it is reached.
#[derive(Debug, clap::Args)]
pub struct LineOptions {
    /// Serial port of a real board, such as /dev/ttyACM0 [default: the emulated board]
    #[arg(long, value_name = "PATH")]
    pub port: Option<String>,
    /// Speed of the serial port in baud [default: that of the board's image]
    #[arg(long, value_name = "BAUD", requires = "port", value_parser = clap::value_parser!(u32).range(1..))]
    pub baud: Option<u32>,
    /// Board behind the port: a name of boards/, or the path of a board file
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse, default_value = board_file::DEFAULT, requires = "port")]
    pub board: Board,
}

impl LineOptions {
    /// Speed of the line [baud].
    pub fn baud_rate(&self) -> u32 {
        self.baud.unwrap_or(self.board.baud_rate())
    }
}

/// What a board does in tests of observer and compensation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RoleName {
    /// Observer and compensation; the joint is simulated here
    Observer,
    /// Joint, motor, observer and compensation
    Loop,
}

impl From<RoleName> for Role {
    fn from(role: RoleName) -> Self {
        match role {
            RoleName::Observer => Self::Observer,
            RoleName::Loop => Self::Loop,
        }
    }
}

/// Who waits for whom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// The board waits for the host before every step that it has no torques for
    Lockstep,
    /// The board's clock rules, the host streams ahead
    Realtime,
}

impl From<Mode> for RunMode {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Lockstep => Self::Lockstep,
            Mode::Realtime => Self::Realtime,
        }
    }
}

//! Options that name a board, its role and its line, shared by every command that talks to a board.

use std::sync::LazyLock;

use clap::ValueEnum;
use link::messages::{Role, RunMode};
use report::command_line::quoted;

use crate::device::board::Board;

/// Options that select a board and its line.
#[derive(Debug, clap::Args)]
pub struct LineOptions {
    /// Serial port of a real board, such as /dev/ttyACM0 [default: the emulated board]
    #[arg(long, value_name = "PATH")]
    pub port: Option<String>,
    /// Speed of the serial port in baud [default: that of the board's image]
    #[arg(long, value_name = "BAUD", requires = "port", value_parser = clap::value_parser!(u32).range(1..))]
    pub baud: Option<u32>,
    /// Board behind the port: a name of boards/, or the path of a board file [default: olimex-h405]
    #[arg(long = "board", value_name = "NAME|FILE", value_parser = Board::parse, requires = "port")]
    named_board: Option<Board>,
}

/// Board if none is named.
static DEFAULT_BOARD: LazyLock<Board> = LazyLock::new(Board::emulated);

impl LineOptions {
    /// Speed of the line [baud].
    pub fn baud_rate(&self) -> u32 {
        self.baud.unwrap_or(self.board().baud_rate())
    }

    /// Board behind the port, or the emulated one.
    pub fn board(&self) -> &Board {
        self.named_board.as_ref().unwrap_or(&DEFAULT_BOARD)
    }

    /// Board as the user named it, or the placeholder `NAME`, since an image is always for one board.
    pub fn board_argument(&self) -> String {
        self.named_board.as_ref().map_or("NAME".to_owned(), |board| quoted(&board.argument))
    }

    /// Options that select the port and board again, each with a leading space.
    pub fn repeated_options(&self) -> String {
        let port = self.port.as_ref().map(|port| format!(" --port {}", quoted(port)));
        let baud = self.baud.map(|baud| format!(" --baud {baud}"));
        let board = self.named_board.as_ref().map(|board| format!(" --board {}", quoted(&board.argument)));
        [port, baud, board].into_iter().flatten().collect()
    }
}

/// Role of a board in tests of observer and compensation.
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

/// Timing of a run: the board waits for the host, or runs by its own clock.
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

//! `joint hil`: a joint simulated on a board, driven and checked from here. Toolchain, images and the emulator's
//! process are left to `target`, pictures to `report`.

pub mod fault;
pub mod logs;
pub mod profile;
pub mod recording;
pub mod session;
pub mod transport;
pub mod twin;

use crate::failure::{Failure, Outcome};

/// Arguments of `joint hil`.
#[derive(Debug, clap::Args)]
pub struct Arguments {}

/// Runs a joint on a board.
pub fn run(_arguments: &Arguments) -> Outcome<()> {
    Err(Failure::new("there is no board"))
}

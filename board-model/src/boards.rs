//! The boards: chip, what drives its clock, and the speed of its line, as the firmware's page on boards states them.

use board::target::board::Board as Kind;

use crate::chips;
use crate::cpu::{Board, Setup};
use crate::image::Image;
use crate::wires::Surroundings;

/// An instruction takes a cycle, unless it is said otherwise [thousandths].
pub const USUAL_COST: u64 = 1000;

/// What drives the clock of a board as it is sold.
pub fn usual_surroundings(board: Kind) -> Surroundings {
    match board {
        Kind::Stm32f405 => Surroundings { crystal: Some(8_000_000), external_clock: None },
        Kind::Stm32g474 => Surroundings { crystal: Some(24_000_000), external_clock: None },
        Kind::Stm32h743 => Surroundings { crystal: None, external_clock: Some(8_000_000) },
    }
}

/// A board as it is sold, with an image.
pub fn start<'a>(board: Kind, image: Image) -> Result<Board<'a>, String> {
    start_with(board, image, usual_surroundings(board), USUAL_COST)
}

/// A board with other surroundings.
pub fn start_with<'a>(board: Kind, image: Image, surroundings: Surroundings, cost: u64) -> Result<Board<'a>, String> {
    let setup = Setup { surroundings, baud: board.baud_rate().into(), cost };
    match board {
        Kind::Stm32f405 => Board::new(chips::f405::chip, image, setup),
        Kind::Stm32g474 => Board::new(chips::g474::chip, image, setup),
        Kind::Stm32h743 => Board::new(chips::h743::chip, image, setup),
    }
}

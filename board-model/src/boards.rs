//! The boards: chip, what drives its clock, and the speed of its line, as the firmware's page on boards states them.

use board::target::board::Board as Kind;

use crate::chips;
use crate::cpu::{Board, Setup};
use crate::image::Image;
use crate::tamper::Tamper;
use crate::wires::Surroundings;

/// An instruction takes a cycle, unless it is said otherwise [thousandths].
pub const USUAL_COST: u64 = 1000;

/// What drives the clock of a board as it is sold.
pub fn usual_surroundings(board: Kind) -> Surroundings {
    match board {
        Kind::Stm32f405 => Surroundings::crystal(8_000_000),
        Kind::Stm32g474 => Surroundings::crystal(24_000_000),
        Kind::Stm32h743 => Surroundings::clock(8_000_000),
    }
}

/// What a check is of: an image on its board, with the mistakes that were planted.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The board.
    pub kind: Kind,
    /// The image.
    pub image: Image,
    /// What is done to its writes.
    pub tampers: &'static [Tamper],
}

impl Subject {
    /// The board as it is sold.
    pub fn start<'a>(&self) -> Result<Board<'a>, String> {
        self.start_with(usual_surroundings(self.kind))
    }

    /// The board with other surroundings.
    pub fn start_with<'a>(&self, surroundings: Surroundings) -> Result<Board<'a>, String> {
        self.start_at(surroundings, USUAL_COST)
    }

    /// The board with instructions that take longer or shorter.
    pub fn start_at<'a>(&self, surroundings: Surroundings, cost: u64) -> Result<Board<'a>, String> {
        let setup = Setup { surroundings, baud: self.kind.baud_rate().into(), cost };
        let chip = match self.kind {
            Kind::Stm32f405 => chips::f405::chip,
            Kind::Stm32g474 => chips::g474::chip,
            Kind::Stm32h743 => chips::h743::chip,
        };
        let mut board = Board::new(chip, self.image.clone(), setup)?;
        board.machine_mut().tampers = self.tampers;
        Ok(board)
    }
}

//! Boards: chip, clock source and line speed, from the board files.

use board::device::board::{Board as Described, Chip};
use board_file::ExternalClock;

use crate::can_bus::CanCable;
use crate::chips;
use crate::cpu::{Board, Setup};
use crate::image::Image;
use crate::tamper::Tamper;
use crate::wires::{Cable, Pin, Surroundings};

/// Default cost of an instruction [thousandths of a cycle].
pub const USUAL_COST: u64 = 1000;

/// Clock source of a board, from its file.
pub fn usual_surroundings(board: &Described) -> Surroundings {
    match board.description.clock {
        ExternalClock::None => Surroundings::default(),
        ExternalClock::Crystal(frequency) => Surroundings::crystal(frequency.into()),
        ExternalClock::Signal(frequency) => Surroundings::clock(frequency.into()),
    }
}

/// First preset board with a chip.
pub fn with(chip: Chip) -> Result<Described, String> {
    let name = board_file::boards_with(chip).first().copied().ok_or("no board has this chip")?;
    Described::load(name).map_err(|failure| failure.to_string())
}

/// Serial line of a board; the number of the peripheral ends its name.
fn cable(board: &Described) -> Cable {
    let serial = &board.description.serial;
    Cable {
        baud: board.baud_rate().into(),
        unit: serial.unit.trim_start_matches(char::is_alphabetic).parse().unwrap_or_default(),
        send: pin(serial.send.pin),
        receive: pin(serial.receive.pin),
    }
}

/// CAN bus of a board, by its file.
fn can(board: &Described) -> CanCable {
    board.description.can.map_or_else(CanCable::default, |can| CanCable {
        unit: can.unit.trim_start_matches(char::is_alphabetic).parse().unwrap_or_default(),
        send: pin(can.send.pin),
        receive: pin(can.receive.pin),
        bitrate: can.bitrate.into(),
        data_bitrate: can.data_bitrate.map(u64::from),
    })
}

/// Pin in the form of the model.
pub fn pin(pin: board_file::Pin) -> Pin {
    Pin(pin.letter(), pin.number.into())
}

/// Subject of a check: an image on its board, with planted mistakes.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Board.
    pub board: Described,
    /// Image.
    pub image: Image,
    /// Changes to the image's writes.
    pub tampers: &'static [Tamper],
}

impl Subject {
    /// Starts the board with its usual surroundings.
    pub fn start<'a>(&self) -> Result<Board<'a>, String> {
        self.start_with(usual_surroundings(&self.board))
    }

    /// Starts the board with other surroundings.
    pub fn start_with<'a>(&self, surroundings: Surroundings) -> Result<Board<'a>, String> {
        self.start_at(surroundings, USUAL_COST)
    }

    /// Starts the board with another cost of an instruction [thousandths of a cycle].
    pub fn start_at<'a>(&self, surroundings: Surroundings, cost: u64) -> Result<Board<'a>, String> {
        let setup = Setup { surroundings, cable: cable(&self.board), can: can(&self.board), cost };
        let chip = match self.board.chip() {
            Chip::Stm32f405 => chips::f405::chip,
            Chip::Stm32g474 => chips::g474::chip,
            Chip::Stm32h743 => chips::h743::chip,
            Chip::Stm32g431 => chips::g431::chip,
        };
        let mut board = Board::new(chip, self.image.clone(), setup)?;
        let unit = self.board.description.serial.unit;
        if !board.machine().chip.peripherals.iter().any(|placed| placed.name == unit) {
            return Err(format!("{unit} of {} is not modelled", self.board.chip().name()));
        }
        board.machine_mut().tampers = self.tampers;
        Ok(board)
    }
}

//! `joint flash`: builds the firmware of a joint and writes it to a real board, by probe-rs or over USB by the chip's
//! loader.

use board::device::board::Board;
use board::device::flash;
use report::failure::{Failure, Outcome};

use crate::image;

/// Arguments of `joint flash`.
#[derive(Debug, clap::Args)]
#[group(id = "flash")]
#[command(after_help = "Examples:
  joint flash --board nucleo-g474re                     joint q1 onto the board behind the debug probe
  joint flash joints/l1.toml --board weact-f405 --dfu   onto the board on USB, started with BOOT0 high
  joint flash --board my_board.toml --role observer

The board must be named: the pins of one board are gate inputs of another.")]
pub struct Arguments {
    /// Board to flash: a name of boards/, or the path of a board file
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse)]
    board: Option<Board>,
    #[command(flatten)]
    image: image::Image,
    /// Writes over USB by dfu-util; the chip's own loader runs if the board starts with BOOT0 high
    #[arg(long)]
    dfu: bool,
}

/// Builds an image and writes it to a board.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    let Some(board) = &arguments.board else {
        return Err(Failure::new("no board is named: the pins of one board are gate inputs of another").with_help(
            format!("name it by --board: one of {}, or the path of a board file", board_file::PRESETS.join(", ")),
        ));
    };
    let built = image::build(&arguments.image, board)?;
    match arguments.dfu {
        true => flash::by_dfu(&built.elf, board),
        false => flash::by_probe(&built.elf, board),
    }
}

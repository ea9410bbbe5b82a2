//! `joint flash`: builds the firmware of a joint and writes it to a real board by probe-rs.

use board::target::flash;
use report::failure::Outcome;

use crate::image;

/// Arguments of `joint flash`.
#[derive(Debug, clap::Args)]
#[group(id = "flash")]
#[command(after_help = "Examples:
  joint flash                                 joint q1 onto the stm32f405 behind the debug probe
  joint flash joints/l1.toml --board stm32g474")]
pub struct Arguments {
    #[command(flatten)]
    image: image::Arguments,
}

/// Builds an image and writes it to a board.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    let built = image::build(&arguments.image)?;
    flash::flash(&built.elf, arguments.image.board)
}

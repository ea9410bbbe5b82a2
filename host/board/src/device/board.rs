//! Board that an image is built for: its description and the path of its board file.

use std::path::{Path, PathBuf};

pub use board_file::Chip;
use board_file::{DEFAULT, PRESETS, named};
use model_core::gears::design::Processor;
use report::failure::{Failure, Outcome};
use report::workspace::workspace;

/// Board with the path of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Board {
    /// Name as given on the command line: a preset or a path.
    pub argument: String,
    /// Path of the board file, for the firmware's build.
    pub file: PathBuf,
    /// Contents of the board file.
    pub description: board_file::Board,
}

impl Board {
    /// Reads a board file, or finds a preset.
    pub fn load(argument: &str) -> Outcome<Self> {
        let typed = Path::new(argument);
        let loaded = named::load(typed)?;
        let file = match typed.is_file() {
            true => typed.canonicalize().map_err(|error| Failure::new(format!("{argument}: {error}")))?,
            false => workspace().join("boards").join(argument).with_added_extension("toml"),
        };
        Ok(Self { argument: argument.to_owned(), file, description: loaded.board })
    }

    /// Parses a command argument; the error carries message and help as one text.
    pub fn parse(argument: &str) -> Result<Self, String> {
        Self::load(argument).map_err(|failure| match failure.help() {
            Some(help) => format!("{}\n{help}", failure.message()),
            None => failure.message().to_owned(),
        })
    }

    /// Returns the board that the emulator stands for.
    ///
    /// # Panics
    /// Panics if the preset cannot be read; the preset's own test finds that.
    pub fn emulated() -> Self {
        Self::load(DEFAULT).expect("a good preset")
    }

    /// Loads every preset.
    pub fn presets() -> Outcome<Vec<Self>> {
        PRESETS.into_iter().map(Self::load).collect()
    }

    /// Name that the board states in its hello.
    pub fn name(&self) -> &str {
        &self.description.name
    }

    /// Its chip.
    pub fn chip(&self) -> Chip {
        self.description.chip
    }

    /// Clock, cycles per instruction and share of the period that the chip offers the step.
    pub fn processor(&self) -> Processor {
        self.chip().processor()
    }

    /// Its core clock [Hz]; the tick rate must divide it.
    pub fn core_rate(&self) -> u32 {
        self.chip().core_rate()
    }

    /// Speed of its serial line [baud].
    pub fn baud_rate(&self) -> u32 {
        self.description.serial.baud
    }

    /// Returns whether the firmware can be the SPI slave of a motor controller.
    pub fn has_spi_slave(&self) -> bool {
        self.description.spi_slave.is_some()
    }
}

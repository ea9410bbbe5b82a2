//! The board that an image is built for: what its board file says, and where that is.

use std::path::{Path, PathBuf};

pub use board_file::Chip;
use board_file::{DEFAULT, PRESETS, named};
use model_core::gears::design::Processor;
use report::failure::{Failure, Outcome};
use report::workspace::workspace;

/// A board with its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Board {
    /// As it was named: a preset, or a path.
    pub named: String,
    /// Its file, for the firmware's build.
    pub file: PathBuf,
    /// What that says.
    pub described: board_file::Board,
}

impl Board {
    /// Reads a board file, or finds a preset.
    pub fn load(named: &str) -> Outcome<Self> {
        let typed = Path::new(named);
        let loaded = named::load(typed)?;
        let file = match typed.is_file() {
            true => typed.canonicalize().map_err(|error| Failure::new(format!("{named}: {error}")))?,
            false => workspace().join("boards").join(named).with_added_extension("toml"),
        };
        Ok(Self { named: named.to_owned(), file, described: loaded.board })
    }

    /// For a command's arguments: the whole complaint, should there be one, as a text.
    pub fn parse(named: &str) -> Result<Self, String> {
        Self::load(named).map_err(|failure| match failure.help() {
            Some(help) => format!("{}\n{help}", failure.message()),
            None => failure.message().to_owned(),
        })
    }

    /// What the emulator stands for.
    ///
    /// # Panics
    /// If the preset cannot be read, which its own test finds.
    pub fn emulated() -> Self {
        Self::load(DEFAULT).expect("a good preset")
    }

    /// Every preset.
    pub fn presets() -> Outcome<Vec<Self>> {
        PRESETS.into_iter().map(Self::load).collect()
    }

    /// What it calls itself in its hello.
    pub fn name(&self) -> &str {
        &self.described.name
    }

    /// Its chip.
    pub fn chip(&self) -> Chip {
        self.described.chip
    }

    /// What it gives the step.
    pub fn processor(&self) -> Processor {
        self.chip().processor()
    }

    /// Its core clock [Hz]; the tick rate must divide it.
    pub fn core_rate(&self) -> u32 {
        self.chip().core_rate()
    }

    /// Speed of its serial line [baud].
    pub fn baud_rate(&self) -> u32 {
        self.described.serial.baud
    }

    /// Whether its firmware can be the slave of a motor controller on SPI.
    pub fn has_spi_slave(&self) -> bool {
        self.described.spi_slave.is_some()
    }
}

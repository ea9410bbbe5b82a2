//! The boards that images can be built for: name, chip, clock, baud rate. Pins and clock trees are in the firmware.

use clap::ValueEnum;
use model_core::gears::design::Processor;

/// A board that an image can be built for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Board {
    /// STM32F405 at 168 MHz; also what the emulator runs.
    Stm32f405,
    /// STM32G474 at 170 MHz: NUCLEO-G474RE.
    Stm32g474,
    /// STM32H743 at 400 MHz: NUCLEO-H743ZI.
    Stm32h743,
}

impl Board {
    /// Every board.
    pub const ALL: [Self; 3] = [Self::Stm32f405, Self::Stm32g474, Self::Stm32h743];

    /// Its name: the firmware's feature, and what the board calls itself in its hello.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stm32f405 => "stm32f405",
            Self::Stm32g474 => "stm32g474",
            Self::Stm32h743 => "stm32h743",
        }
    }

    /// Its chip, as probe-rs knows it.
    pub fn chip(self) -> &'static str {
        match self {
            Self::Stm32f405 => "STM32F405RGTx",
            Self::Stm32g474 => "STM32G474RETx",
            Self::Stm32h743 => "STM32H743ZITx",
        }
    }

    /// Its core clock [Hz]; the tick rate must divide it.
    pub fn core_rate(self) -> u32 {
        match self {
            Self::Stm32f405 => 168_000_000,
            Self::Stm32g474 => 170_000_000,
            Self::Stm32h743 => 400_000_000,
        }
    }

    /// What it gives the step.
    pub fn processor(self) -> Processor {
        match self {
            Self::Stm32f405 => Processor::STM32F405,
            Self::Stm32g474 => Processor::STM32G474,
            Self::Stm32h743 => Processor::STM32H743,
        }
    }

    /// Whether its firmware can be the slave of a motor controller on SPI.
    pub fn has_spi_slave(self) -> bool {
        matches!(self, Self::Stm32f405 | Self::Stm32g474)
    }

    /// Speed of its serial line [baud]: where the UART has no FIFO, the tick must not outlast a byte.
    pub fn baud_rate(self) -> u32 {
        match self {
            Self::Stm32f405 => 230_400,
            Self::Stm32g474 | Self::Stm32h743 => 921_600,
        }
    }
}

//! Board support: the chip behind one trait, and the pins of the board file. Each chip's file contains its clock, its
//! flash and the record of its tests, selected by `family`; constants of the board are generated from the board file
//! (`description`).

mod bounded_wait;
#[cfg(all(family = "stm32f4", has_can))]
pub mod bxcan;
mod chip;
mod description;
#[cfg(has_spi_slave)]
pub mod dma_slave;
mod external_clock;
#[cfg(all(not(family = "stm32f4"), has_can))]
pub mod fdcan;
#[cfg(all(family = "stm32g4", has_can))]
mod fdcan_g4;
#[cfg(all(family = "stm32h7", has_can))]
mod fdcan_h7;
pub mod flash_slots;
#[cfg(not(family = "stm32h7"))]
pub mod flash_unit;
mod gpio;
mod handover;
mod internal_clock;
mod serial_unit;
mod start;
mod watchdog;

#[cfg(all(family = "stm32f4", has_can))]
pub use bxcan as can;
pub use chip::{Chip, Parts};
pub use description::{CORE_RATE, NAME};
#[cfg(all(not(family = "stm32f4"), has_can))]
pub use fdcan as can;
pub use gpio::{Output, Pin};
pub use serial_unit::wake as wake_serial;
pub use start::{Started, start};
pub use watchdog::Watchdog;

#[cfg(family = "stm32f4")]
mod old_usart;
#[cfg(family = "stm32f4")]
mod stm32f405;
#[cfg(all(family = "stm32f4", has_spi_slave))]
mod stream_slave;
#[cfg(family = "stm32f4")]
pub use old_usart::look as look_at_serial;
#[cfg(family = "stm32f4")]
pub use stm32f405::{Stm32F405 as ThisChip, pac};
#[cfg(all(family = "stm32f4", has_spi_slave))]
pub use stream_slave::StreamSpi as ThisSpi;

#[cfg(not(family = "stm32f4"))]
mod fifo_uart;
#[cfg(not(family = "stm32f4"))]
pub use fifo_uart::look as look_at_serial;

#[cfg(all(family = "stm32g4", has_spi_slave))]
mod channel_slave;
#[cfg(family = "stm32g4")]
mod stm32g4;
#[cfg(all(family = "stm32g4", has_spi_slave))]
pub use channel_slave::ChannelSpi as ThisSpi;
#[cfg(family = "stm32g4")]
pub use stm32g4::{Stm32G4 as ThisChip, pac};

#[cfg(family = "stm32h7")]
mod stm32h743;
#[cfg(family = "stm32h7")]
pub use stm32h743::{Stm32H743 as ThisChip, pac};

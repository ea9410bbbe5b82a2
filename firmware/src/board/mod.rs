//! The board: what its chip does, behind one trait, and the pins that its file gives to the firmware. Each chip's file has its clock,
//! its flash and what it was checked on; the board's own facts are constants that the build makes of its board file
//! (`description`).

#[cfg(not(any(feature = "stm32f405", feature = "stm32g474", feature = "stm32g431", feature = "stm32h743")))]
compile_error!("choose a chip: one of the features stm32f405, stm32g474, stm32g431, stm32h743");
#[cfg(any(
    all(feature = "stm32f405", any(feature = "stm32g474", feature = "stm32g431", feature = "stm32h743")),
    all(feature = "stm32g474", any(feature = "stm32g431", feature = "stm32h743")),
    all(feature = "stm32g431", feature = "stm32h743"),
))]
compile_error!("one chip at a time: build with --no-default-features --features <chip>");

mod bounded_wait;
mod chip;
mod description;
#[cfg(has_spi_slave)]
pub mod dma_slave;
mod external_clock;
pub mod flash_slots;
#[cfg(not(feature = "stm32h743"))]
pub mod flash_unit;
mod gpio;
mod handover;
mod internal_clock;
mod serial_unit;
mod start;
mod watchdog;

pub use chip::{Chip, Parts};
pub use description::{CORE_RATE, NAME};
pub use gpio::{Output, Pin};
pub use serial_unit::wake as wake_serial;
pub use start::{Started, start};
pub use watchdog::Watchdog;

#[cfg(feature = "stm32f405")]
mod old_usart;
#[cfg(feature = "stm32f405")]
mod stm32f405;
#[cfg(all(feature = "stm32f405", has_spi_slave))]
mod stream_slave;
#[cfg(feature = "stm32f405")]
pub use old_usart::look as look_at_serial;
#[cfg(feature = "stm32f405")]
pub use stm32f405::{Stm32F405 as ThisChip, pac};
#[cfg(all(feature = "stm32f405", has_spi_slave))]
pub use stream_slave::StreamSpi as ThisSpi;

#[cfg(not(feature = "stm32f405"))]
mod fifo_uart;
#[cfg(not(feature = "stm32f405"))]
pub use fifo_uart::look as look_at_serial;

#[cfg(all(any(feature = "stm32g474", feature = "stm32g431"), has_spi_slave))]
mod channel_slave;
#[cfg(any(feature = "stm32g474", feature = "stm32g431"))]
mod stm32g4;
#[cfg(all(any(feature = "stm32g474", feature = "stm32g431"), has_spi_slave))]
pub use channel_slave::ChannelSpi as ThisSpi;
#[cfg(any(feature = "stm32g474", feature = "stm32g431"))]
pub use stm32g4::{Stm32G4 as ThisChip, pac};

#[cfg(feature = "stm32h743")]
mod stm32h743;
#[cfg(feature = "stm32h743")]
pub use stm32h743::{Stm32H743 as ThisChip, pac};

//! The boards: what differs between them, behind one trait, and the one that this image is for. Each board's file has
//! its pins, its clock and what it was checked on.

use core::convert::Infallible;

use embedded_hal::digital::OutputPin;
use link::messages::Clock;

use crate::kept_memory::Slots;
use crate::serial::Uart;

#[cfg(not(any(feature = "stm32f405", feature = "stm32g474", feature = "stm32h743")))]
compile_error!("choose a board: one of the features stm32f405, stm32g474, stm32h743");
#[cfg(any(
    all(feature = "stm32f405", feature = "stm32g474"),
    all(feature = "stm32f405", feature = "stm32h743"),
    all(feature = "stm32g474", feature = "stm32h743"),
))]
compile_error!("one board at a time: build with --no-default-features --features <board>");

mod bounded_wait;
#[cfg(feature = "spi_slave")]
pub mod dma_slave;
pub mod flash_slots;
#[cfg(any(feature = "stm32f405", feature = "stm32g474"))]
pub mod flash_unit;
mod output;
mod watchdog;

pub use output::Output;
pub use watchdog::Watchdog;

#[cfg(feature = "stm32f405")]
mod stm32f405;
#[cfg(feature = "stm32f405")]
mod stream_slave;
#[cfg(feature = "stm32f405")]
pub use stm32f405::{Stm32F405 as ThisBoard, pac};
#[cfg(feature = "stm32f405")]
pub use stream_slave::Spi1 as ThisSpi;

#[cfg(any(feature = "stm32g474", feature = "stm32h743"))]
mod fifo_uart;
#[cfg(any(feature = "stm32g474", feature = "stm32h743"))]
mod serial_usart;
#[cfg(any(feature = "stm32g474", feature = "stm32h743"))]
pub use serial_usart::UsartRegisters;

#[cfg(feature = "stm32g474")]
mod channel_slave;
#[cfg(feature = "stm32g474")]
mod stm32g474;
#[cfg(feature = "stm32g474")]
pub use channel_slave::Spi2 as ThisSpi;
#[cfg(feature = "stm32g474")]
pub use stm32g474::{Stm32G474 as ThisBoard, pac};

#[cfg(feature = "stm32h743")]
mod stm32h743;
#[cfg(feature = "stm32h743")]
pub use stm32h743::{Stm32H743 as ThisBoard, pac};

/// What the firmware needs of a board.
pub trait Board {
    /// Its name in the hello.
    const NAME: &'static str;
    /// Core clock, which also drives SysTick [Hz].
    const CORE_RATE: u32;
    /// The motor-enable output.
    type Enable: OutputPin<Error = Infallible>;
    /// The status light, on when high.
    type Light: OutputPin<Error = Infallible>;
    /// The line to the host.
    type Port: Uart;
    /// Where what was learnt is kept.
    type Slots: Slots;

    /// Sets up clock, pins, serial line and watchdog. Every wait is bounded.
    fn start(device: pac::Peripherals, core: &mut cortex_m::Peripherals) -> Started<Self>;

    /// Makes the serial interrupt run.
    fn wake_serial();
}

/// A board that is up.
pub struct Started<B: Board + ?Sized> {
    /// Where the core clock comes from.
    pub clock: Clock,
    /// The motor-enable output, low.
    pub enable: B::Enable,
    /// The status light.
    pub light: B::Light,
    /// The line to the host, open.
    pub port: B::Port,
    /// Where what was learnt is kept.
    pub slots: B::Slots,
    /// Running.
    pub watchdog: Watchdog,
    /// The last reset came from the watchdog.
    pub watchdog_reset: bool,
}

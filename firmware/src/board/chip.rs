//! Interface of a chip; each chip has a file of its own.
//!
//! A peripheral gets its enabled clock two bus cycles later, and an earlier write is lost (RM0440 7.2.17; STM32F405
//! errata sheet ES0182): each enable bit is therefore read back before the peripheral is used.

use link::messages::Clock;

use super::external_clock::Internal;
use super::pac;
use crate::kept_memory::Slots;
use crate::serial::Uart;

/// Chip, as the firmware uses it.
pub trait Chip {
    /// Internal oscillator: clock of core and serial line while no PLL runs.
    const INTERNAL: Internal;
    /// UART to the host.
    type Port: Uart;
    /// Flash slots for the estimated parameters.
    type Slots: Slots;

    /// Sets up clock and flash. Every wait is bounded.
    fn start(device: pac::Peripherals, core: &mut cortex_m::Peripherals) -> Parts<Self>;

    /// Resets all pin ports: a bootloader may have configured pins that the firmware does not use.
    fn reset_ports(clocks: &pac::RCC);

    /// Enables the clock of a pin port.
    fn power_port(clocks: &pac::RCC, port: u8);

    /// Opens the serial line; `clock` is the clock of its unit [Hz].
    fn open_port(clocks: &pac::RCC, clock: u32, baud_rate: u32) -> Self::Port;
}

/// Peripherals and findings of a chip's start.
pub struct Parts<C: Chip + ?Sized> {
    /// Source and tolerance of the core clock.
    pub clock: Clock,
    /// Flash slots for the estimated parameters.
    pub slots: C::Slots,
    /// Watchdog, not started.
    pub watchdog: pac::IWDG,
    /// The last reset came from the watchdog.
    pub watchdog_reset: bool,
    /// Clock enables of all other peripherals.
    pub clocks: pac::RCC,
}

//! What the firmware needs of a chip; each has a file of its own.
//!
//! A clock that is switched on comes to its peripheral two cycles of the bus later, and a write before that is lost (RM0440 7.2.17;
//! STM32F405's errata sheet ES0182): so each switch is read back before what it is for is touched.

use link::messages::Clock;

use super::external_clock::Internal;
use super::pac;
use crate::kept_memory::Slots;
use crate::serial::Uart;

/// What the firmware needs of a chip.
pub trait Chip {
    /// Its own oscillator: the core clock, and that of the serial line, while no PLL runs.
    const INTERNAL: Internal;
    /// The line to the host.
    type Port: Uart;
    /// Where what was learnt is kept.
    type Slots: Slots;

    /// Sets up clock and flash. Every wait is bounded.
    fn start(device: pac::Peripherals, core: &mut cortex_m::Peripherals) -> Parts<Self>;

    /// All ports of pins as after a reset: a bootloader may have set pins up that nobody here may touch.
    fn reset_ports(clocks: &pac::RCC);

    /// Switches the clock of a port of pins on.
    fn power_port(clocks: &pac::RCC, port: u8);

    /// Opens the serial line at a clock of its unit, in Hz.
    fn open_port(clocks: &pac::RCC, clock: u32, baud_rate: u32) -> Self::Port;
}

/// What a chip's start leaves to its board.
pub struct Parts<C: Chip + ?Sized> {
    /// What the core clock is made of.
    pub clock: Clock,
    /// Where what was learnt is kept.
    pub slots: C::Slots,
    /// Not started yet.
    pub watchdog: pac::IWDG,
    /// The last reset came from the watchdog.
    pub watchdog_reset: bool,
    /// Switches of the clocks of everything else.
    pub clocks: pac::RCC,
}

//! FDCAN of STM32G4 (RM0440 44.3.3): message RAM in fixed parts, clock of the bus.

use super::pac;

/// Registers of the peripheral.
#[cfg(can = "fdcan1")]
pub type Unit = pac::FDCAN1;
/// Registers of the peripheral.
#[cfg(can = "fdcan2")]
pub type Unit = pac::FDCAN2;
/// Registers of the peripheral.
#[cfg(can = "fdcan3")]
pub type Unit = pac::FDCAN3;

/// Number of the peripheral, from 0.
const NUMBER: usize = if cfg!(can = "fdcan1") {
    0
} else if cfg!(can = "fdcan2") {
    1
} else {
    2
};
/// Message RAM of this peripheral.
pub const RAM: usize = 0x4000_a400 + 0x350 * NUMBER;
/// Words of the message RAM.
pub const RAM_WORDS: usize = 0x350 / 4;
/// Elements of a FIFO.
pub const DEPTH: usize = 3;
/// Element: header and data [byte].
pub const ELEMENT: usize = 8 + 64;
/// Receive FIFO 0 in the message RAM [byte].
pub const FIFO_0: usize = 0xb0;
/// Transmit FIFO in the message RAM [byte].
pub const SEND_FIFO: usize = 0x278;

/// Clocks the peripheral from its bus, and resets it.
pub fn turn_on(clocks: &pac::RCC) {
    clocks.ccipr().modify(|_, w| w.fdcansel().pclk());
    clocks.apb1enr1().modify(|_, w| w.fdcanen().set_bit());
    let _ = clocks.apb1enr1().read();
    clocks.apb1rstr1().modify(|_, w| w.fdcanrst().set_bit());
    clocks.apb1rstr1().modify(|_, w| w.fdcanrst().clear_bit());
}

/// Does nothing: the parts of the message RAM are fixed.
pub fn lay_out_ram(_: &Unit) {}

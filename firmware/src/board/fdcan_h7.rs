//! FDCAN of STM32H743 (RM0433 56): message RAM shared by both peripherals and laid out by registers, clock of PLL 1.
//!
//! Erratum (ES0392): chips of revisions Y and W read wrong message RAM while two FDCAN are used. A board uses one, and the
//! reset leaves the other one in its initialisation.

use super::bounded_wait::wait_until;
use super::pac;

/// Registers of the peripheral.
#[cfg(can = "fdcan1")]
pub type Unit = pac::FDCAN1;
/// Registers of the peripheral.
#[cfg(can = "fdcan2")]
pub type Unit = pac::FDCAN2;

/// Message RAM; words only, and device memory by the address, which no cache holds.
pub const RAM: usize = 0x4000_ac00;
/// Words of the message RAM that are used: both FIFOs.
pub const RAM_WORDS: usize = 2 * DEPTH * ELEMENT / 4;
/// Elements of a FIFO.
pub const DEPTH: usize = 3;
/// Element: header and data [byte].
pub const ELEMENT: usize = 8 + 64;
/// Receive FIFO 0 in the message RAM [byte].
pub const FIFO_0: usize = 0;
/// Transmit FIFO in the message RAM [byte].
pub const SEND_FIFO: usize = FIFO_0 + DEPTH * ELEMENT;

/// Elements of 64 bytes of data, in RXESC and TXESC.
const LONGEST: u32 = 7;
/// Bypass of the clock calibration, with divider 1.
const BYPASS: u32 = 1 << 6;

/// Clocks the peripheral from output Q of PLL 1, and resets it.
pub fn turn_on(clocks: &pac::RCC) {
    clocks.d2ccip1r().modify(|_, w| w.fdcansel().pll1_q());
    clocks.apb1henr().modify(|_, w| w.fdcanen().set_bit());
    let _ = clocks.apb1henr().read();
    clocks.apb1hrstr().modify(|_, w| w.fdcanrst().set_bit());
    clocks.apb1hrstr().modify(|_, w| w.fdcanrst().clear_bit());
    bypass_calibration();
}

/// Bypasses the unit between the clock and both peripherals, which would divide the clock until it is calibrated by
/// frames of the bus. Its settings are open during the initialisation of FDCAN1.
fn bypass_calibration() {
    // SAFETY: called once, at the start, before the peripheral is taken; FDCAN1 is left in its initialisation.
    let (guard, calibration) = unsafe { (pac::FDCAN1::steal(), pac::CAN_CCU::steal()) };
    guard.cccr().modify(|_, w| w.init().set_bit());
    // A peripheral that does not answer is left alone: nothing is received and nothing sent.
    let _ = wait_until(|| guard.cccr().read().init().bit_is_set());
    guard.cccr().modify(|_, w| w.cce().set_bit());
    // SAFETY: defined bits.
    calibration.ccfg().write(|w| unsafe { w.bits(BYPASS) });
    guard.cccr().modify(|_, w| w.cce().clear_bit());
}

/// Sets up both FIFOs in the message RAM, without filters, buffers and events, during the initialisation.
pub fn lay_out_ram(unit: &Unit) {
    let depth = DEPTH as u32;
    // SAFETY: both FIFOs lie in the message RAM one behind the other; the address has the place of the lowest bits.
    unsafe {
        unit.rxf0c().write(|w| w.bits(depth << 16 | FIFO_0 as u32));
        unit.rxesc().write(|w| w.bits(LONGEST));
        unit.txbc().write(|w| w.bits(depth << 24 | SEND_FIFO as u32));
        unit.txesc().write(|w| w.bits(LONGEST));
    }
}

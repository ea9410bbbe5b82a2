//! A slave on SPI whose bytes are moved by DMA: what a transfer received, and what the next one takes.
//!
//! The emulated board has neither DMA nor EXTI. On a model of the boards' registers (`board-model`) good transfers, transfers cut
//! short and those that are too long are tried, each answered by the next good one. What only a board can show is the least
//! time between transfers.

use super::pac;
use crate::port::spi::Frame;
use crate::port::spi_slave::{Broken, SlaveBus};

/// SPI, DMA and the interrupt of the chip select, on one chip.
pub trait Unit {
    /// Sets up pins, DMA and interrupt; nothing is armed yet. Clocks of ports are on.
    fn start(device: pac::Peripherals) -> Self;
    /// Takes back the request of the chip select's interrupt.
    fn acknowledge(&mut self);
    /// Bytes that the transfer did not bring.
    fn missing(&self) -> u16;
    /// Bytes came that nobody took: more than fit, or one more after the last that was waited for.
    fn overran(&self) -> bool;
    /// Ends both directions. What is left in the SPI would come first in the next transfer, and only a reset empties it.
    fn stop(&mut self);
    /// Has the next transfer fill the frame at one address and send the frame at the other.
    fn begin(&mut self, received: u32, sent: u32);
}

/// The slave with its frames, which live for ever: the unit knows their addresses.
pub struct DmaSlave<U> {
    unit: U,
    received: &'static mut Frame,
    sent: &'static mut Frame,
}

impl<U: Unit> DmaSlave<U> {
    /// Not armed yet.
    pub fn start(device: pac::Peripherals, received: &'static mut Frame, sent: &'static mut Frame) -> Self {
        Self { unit: U::start(device), received, sent }
    }
}

impl<U: Unit> SlaveBus for DmaSlave<U> {
    fn finish(&mut self) -> Result<&Frame, Broken> {
        self.unit.acknowledge();
        let (missing, overran) = (self.unit.missing(), self.unit.overran());
        self.unit.stop();
        match (overran, missing) {
            (true, _) => Err(Broken::Overrun),
            (false, 0) => Ok(self.received),
            (false, missing) => Err(Broken::Short(missing)),
        }
    }

    fn arm(&mut self, next: &Frame) {
        *self.sent = *next;
        let [received, sent] = [self.received.as_ptr() as u32, self.sent.as_ptr() as u32];
        self.unit.begin(received, sent);
    }
}

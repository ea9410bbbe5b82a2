//! SPI slave with DMA: received bytes and prepared answer of each transfer.
//!
//! The emulated board has neither DMA nor EXTI. Tests on a model of the boards' registers (`board-model`) cover good,
//! short and overlong transfers, each followed by a good one. The shortest time between transfers can be measured on a
//! board only.

use super::description::SPI_SLAVE;
use super::gpio::Pin;
use super::pac;
use super::start::clocked_pin;
use crate::port::spi::Frame;
use crate::port::spi_slave::{Broken, SlaveBus};

/// Select, clock, out and in.
const PINS: [(u8, u8, u8); 4] = SPI_SLAVE.expect("the build has found a slave in the board's file");

/// SPI, DMA and the interrupt of the chip select, on one chip.
pub trait Unit {
    /// Sets up DMA and the interrupt of the chip select; nothing is armed yet.
    fn start(device: pac::Peripherals, select: Pin) -> Self;
    /// Clears the pending interrupt of the chip select.
    fn acknowledge(&mut self);
    /// Returns the number of missing bytes of the transfer.
    fn missing(&self) -> u16;
    /// Returns `true` if received bytes were lost.
    fn overran(&self) -> bool;
    /// Returns `true` if a received byte has not been read.
    fn has_byte(&self) -> bool;
    /// Stops both directions and resets the SPI: bytes left in it would be sent first in the next transfer.
    fn stop(&mut self);
    /// Prepares the next transfer with the addresses of the frames to receive and to send.
    fn begin(&mut self, received: u32, sent: u32);
}

/// SPI slave with its frames, which are static since the DMA uses their addresses.
pub struct DmaSlave<U> {
    unit: U,
    received: &'static mut Frame,
    sent: &'static mut Frame,
}

impl<U: Unit> DmaSlave<U> {
    /// Starts the slave, not armed.
    pub fn start(device: pac::Peripherals, received: &'static mut Frame, sent: &'static mut Frame) -> Self {
        let [select, clock, out, input] = PINS.map(|pin| clocked_pin(&device.RCC, pin));
        // At the pin speed after reset, edges of the answer would take longer than a bit.
        out.0.make_fast();
        for (pin, function) in [select, clock, out, input] {
            pin.set_function(function);
        }
        Self { unit: U::start(device, select.0), received, sent }
    }
}

impl<U: Unit> SlaveBus for DmaSlave<U> {
    fn finish(&mut self) -> Result<&Frame, Broken> {
        self.unit.acknowledge();
        let missing = self.unit.missing();
        // A surplus byte makes the transfer invalid.
        let overran = self.unit.overran() || missing == 0 && self.unit.has_byte();
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

//! A slave on SPI whose bytes are moved by DMA: what a transfer received, and what the next one takes.
//!
//! The emulated board has neither DMA nor EXTI. On a model of the boards' registers (`board-model`) good transfers, transfers cut
//! short and those that are too long are tried, each answered by the next good one. What only a board can show is the least
//! time between transfers.

use super::description::SPI_SLAVE;
use super::gpio::Pin;
use super::pac;
use super::start::given;
use crate::port::spi::Frame;
use crate::port::spi_slave::{Broken, SlaveBus};

/// Select, clock, out and in.
const PINS: [(u8, u8, u8); 4] = SPI_SLAVE.expect("the build has found a slave in the board's file");

/// SPI, DMA and the interrupt of the chip select, on one chip.
pub trait Unit {
    /// Sets up DMA and the interrupt of the chip select; nothing is armed yet.
    fn start(device: pac::Peripherals, select: Pin) -> Self;
    /// Takes back the request of the chip select's interrupt.
    fn acknowledge(&mut self);
    /// Bytes that the transfer did not bring.
    fn missing(&self) -> u16;
    /// Bytes came that nobody took.
    fn overran(&self) -> bool;
    /// A byte waits that nobody has taken.
    fn has_byte(&self) -> bool;
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
        let [select, clock, out, input] = PINS.map(|pin| given(&device.RCC, pin));
        // At the speed after a reset the answer's edges would take longer than a bit.
        out.0.make_fast();
        for (pin, function) in [select, clock, out, input] {
            pin.give_to(function);
        }
        Self { unit: U::start(device, select.0), received, sent }
    }
}

impl<U: Unit> SlaveBus for DmaSlave<U> {
    fn finish(&mut self) -> Result<&Frame, Broken> {
        self.unit.acknowledge();
        let missing = self.unit.missing();
        // A byte more than was waited for is one too many.
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

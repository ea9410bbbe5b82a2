//! The peripherals of the chips, each by its chapter of the reference manual.

pub mod dbgmcu;
pub mod dma;
pub mod dma_channel;
pub mod dma_stream;
pub mod dmamux;
pub mod exti;
pub mod flash;
pub mod flash_f4;
pub mod flash_g4;
pub mod flash_h7;
pub mod gpio;
pub mod iwdg;
pub mod pvd;
pub mod pwr_f4;
pub mod pwr_g4;
pub mod pwr_h7;
pub mod rcc;
pub mod rcc_f4;
pub mod rcc_g4;
pub mod rcc_h7;
pub mod spi;
pub mod syscfg;
pub mod tim;
pub mod usart;

use self::dma::Transfer;
use crate::register::Registers;
use crate::wires::{Time, Wires};

/// A peripheral with registers. Access rules that hold for all are checked before any of these is called.
pub trait Peripheral {
    /// Its registers.
    fn registers(&mut self) -> &mut Registers;

    /// A read of a register as it is at present, with what the read itself changes.
    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        self.advance(wires);
        self.registers().get(offset)
    }

    /// A register was written: the value, and what the register held before.
    fn written(&mut self, _offset: u32, _value: u32, _before: u32, _wires: &mut Wires) {}

    /// Brings it up to the present, and its wires to their levels.
    fn advance(&mut self, _wires: &mut Wires) {}

    /// When something happens by itself next.
    fn next_event(&self) -> Option<Time> {
        None
    }

    /// The next item that a DMA controller moves.
    fn next_transfer(&mut self, _wires: &mut Wires) -> Option<Transfer> {
        None
    }

    /// A reset of the peripheral.
    fn reset(&mut self) {
        self.registers().reset();
    }

    /// Power is gone, after which the reset comes: what a reset alone leaves.
    fn power_lost(&mut self) {}

    /// A read of flash that is not part of the image.
    fn read_memory(&mut self, _address: u32, _size: u32, _wires: &mut Wires) -> Option<u64> {
        None
    }

    /// A write to flash; whether it was this one's.
    fn write_memory(&mut self, _address: u32, _size: u32, _value: u64, _wires: &mut Wires) -> bool {
        false
    }
}

//! Peripherals of the chips, each by its chapter of the reference manual.

pub mod bxcan;
pub mod can_node;
pub mod dbgmcu;
pub mod dma;
pub mod dma_channel;
pub mod dma_stream;
pub mod dmamux;
pub mod exti;
pub mod fdcan;
pub mod fdcan_ccu;
pub mod fdcan_maps;
pub mod fdcan_ram;
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

/// Peripheral with registers. The access rules common to all are checked before any of these methods is called.
pub trait Peripheral {
    /// Registers of the peripheral.
    fn registers(&mut self) -> &mut Registers;

    /// Reads a register, with the side effects of the read.
    fn read(&mut self, offset: u32, wires: &mut Wires) -> u32 {
        self.advance(wires);
        self.registers().get(offset)
    }

    /// Handles a write of a register; `before` is the register's previous value.
    fn written(&mut self, _offset: u32, _value: u32, _before: u32, _wires: &mut Wires) {}

    /// Brings the peripheral to the present, and its wires to their levels.
    fn advance(&mut self, _wires: &mut Wires) {}

    /// Time of the next event that needs no access.
    fn next_event(&self) -> Option<Time> {
        None
    }

    /// Next item that a DMA controller moves.
    fn next_transfer(&mut self, _wires: &mut Wires) -> Option<Transfer> {
        None
    }

    /// Resets the peripheral.
    fn reset(&mut self) {
        self.registers().reset();
    }

    /// Clears the state that survives a reset but not a loss of power.
    fn power_lost(&mut self) {}

    /// Reads flash outside of the image; `None` if the address is not flash.
    fn read_memory(&mut self, _address: u32, _size: u32, _wires: &mut Wires) -> Option<u64> {
        None
    }

    /// Writes flash; returns whether the address is flash.
    fn write_memory(&mut self, _address: u32, _size: u32, _value: u64, _wires: &mut Wires) -> bool {
        false
    }
}

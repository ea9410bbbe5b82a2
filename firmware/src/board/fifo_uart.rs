//! Newer USART of the STM32 families, with FIFOs (G4: 8 bytes, H7: 16) that hold the bytes received during a tick at
//! full speed. The board sets up pins and clock.

use super::serial_unit::{Registers, wake};
use crate::serial::Uart;

/// Does nothing: received bytes raise their interrupt.
pub fn look() {}

/// USART with FIFOs enabled.
pub struct FifoUart {
    registers: Registers,
    overran: bool,
}

impl FifoUart {
    /// Opens the USART: 8 data bits, no parity, one stop bit.
    pub fn open(registers: Registers, clock: u32, baud_rate: u32) -> Self {
        // SAFETY: the quotient is a valid divider for 16-fold oversampling.
        registers.brr().write(|w| unsafe { w.bits((clock + baud_rate / 2) / baud_rate) });
        registers.cr1().write(|w| w.fifoen().set_bit().te().set_bit().re().set_bit().rxneie().set_bit());
        registers.cr1().modify(|_, w| w.ue().set_bit());
        Self { registers, overran: false }
    }
}

impl Uart for FifoUart {
    fn read(&mut self) -> Option<u8> {
        let status = self.registers.isr().read();
        if status.ore().bit_is_set() {
            self.overran = true;
            self.registers.icr().write(|w| w.orecf().clear());
        }
        status.rxne().bit_is_set().then(|| self.registers.rdr().read().bits() as u8)
    }

    fn overran(&mut self) -> bool {
        core::mem::take(&mut self.overran)
    }

    fn can_write(&self) -> bool {
        self.registers.isr().read().txe().bit_is_set()
    }

    fn write(&mut self, byte: u8) {
        // SAFETY: any nine bits may be sent.
        self.registers.tdr().write(|w| unsafe { w.bits(byte.into()) });
    }

    fn interrupt_on_write(&mut self, on: bool) {
        self.registers.cr1().modify(|_, w| w.txeie().bit(on));
    }

    fn interrupt_again(&mut self) {
        wake();
    }
}

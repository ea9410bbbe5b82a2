//! SPI1 of STM32F405 as a slave whose bytes are moved by DMA: mode 0, 8 bits, chip select by the master's hand.
//!
//! | use | pin | |
//! |---|---|---|
//! | chip select | PA4 | low during a transfer; its rising edge is the interrupt EXTI4 |
//! | clock | PA5 | at most 42 MHz by the chip, 21 MHz where wires are long |
//! | to the master | PA6 | DMA2 stream 3, channel 3 |
//! | from the master | PA7 | DMA2 stream 0, channel 3 |
//!
//! The emulated board has neither DMA nor EXTI: this is compiled and linted, and only a board can show that it works. What
//! is to be shown there: a frame of 192 bytes each way, a transfer cut short and one too long, each answered by the next
//! good one, and the least time between transfers.

use super::pac;
use super::patience::wait_until;
use crate::port::spi::{FRAME_BYTES, Frame};
use crate::port::spi_slave::{Broken, SlaveBus};

/// Streams of DMA2.
const RECEIVING: usize = 0;
const SENDING: usize = 3;
/// Channel of SPI1 in both, in the stream's register.
const CHANNEL: u32 = 3 << 25;
/// Addresses in memory rise.
const MEMORY_RISES: u32 = 1 << 10;
/// From memory to the peripheral.
const OUTWARDS: u32 = 1 << 6;
const ENABLE: u32 = 1;
/// All flags of streams 0 and 3.
const FLAGS: u32 = 0x3d | 0x3d << 22;
/// The line of the chip select.
const LINE: u32 = 1 << 4;

/// The slave's pins, DMA and buffers.
pub struct DmaSlave {
    spi: pac::SPI1,
    dma: pac::DMA2,
    exti: pac::EXTI,
    rcc: pac::RCC,
    received: &'static mut Frame,
    sent: &'static mut Frame,
}

impl DmaSlave {
    /// Sets up pins, DMA and interrupt; nothing is armed yet. Clocks of ports are on.
    pub fn start(device: pac::Peripherals, received: &'static mut Frame, sent: &'static mut Frame) -> Self {
        let pac::Peripherals { SPI1: spi, DMA2: dma, EXTI: exti, RCC: rcc, GPIOA: gpio, SYSCFG: syscfg, .. } = device;
        rcc.ahb1enr().modify(|_, w| w.gpioaen().set_bit().dma2en().set_bit());
        rcc.apb2enr().modify(|_, w| w.spi1en().set_bit().syscfgen().set_bit());
        gpio.afrl().modify(|_, w| w.afrl4().af5().afrl5().af5().afrl6().af5().afrl7().af5());
        // At the speed after a reset the answer's edges would take longer than a bit.
        gpio.ospeedr().modify(|_, w| w.ospeedr6().very_high_speed());
        gpio.moder()
            .modify(|_, w| w.moder4().alternate().moder5().alternate().moder6().alternate().moder7().alternate());
        // SAFETY: line 4 is that of port A (0); lines 5 to 7 are not used.
        syscfg.exticr2().write(|w| unsafe { w.bits(0) });
        // SAFETY: every line may have an edge and an interrupt.
        exti.rtsr().modify(|r, w| unsafe { w.bits(r.bits() | LINE) });
        // SAFETY: likewise.
        exti.imr().modify(|r, w| unsafe { w.bits(r.bits() | LINE) });
        Self { spi, dma, exti, rcc, received, sent }
    }

    /// Stops a stream; what it has begun it ends.
    fn stop(&self, stream: usize) {
        let control = self.dma.st(stream).cr();
        // SAFETY: a stream that is off may have any settings.
        control.write(|w| unsafe { w.bits(0) });
        let _ = wait_until(|| control.read().bits() & ENABLE == 0);
    }

    /// Starts a stream between the data register and a buffer.
    fn begin(&self, stream: usize, buffer: u32, direction: u32) {
        let registers = self.dma.st(stream);
        let data = self.spi.dr().as_ptr() as u32;
        // SAFETY: the data register, a buffer of a frame's length that lives for ever, and that length.
        unsafe {
            registers.par().write(|w| w.bits(data));
            registers.m0ar().write(|w| w.bits(buffer));
            registers.ndtr().write(|w| w.bits(FRAME_BYTES as u32));
            registers.cr().write(|w| w.bits(CHANNEL | MEMORY_RISES | direction | ENABLE));
        }
    }
}

impl SlaveBus for DmaSlave {
    fn finish(&mut self) -> Result<&Frame, Broken> {
        // SAFETY: a one takes back this line's request.
        self.exti.pr().write(|w| unsafe { w.bits(LINE) });
        let missing = self.dma.st(RECEIVING).ndtr().read().bits() as u16;
        let overran = self.spi.sr().read().ovr().bit_is_set();
        self.stop(RECEIVING);
        self.stop(SENDING);
        // What is left in its registers would come first in the next transfer: only a reset empties them.
        self.rcc.apb2rstr().modify(|_, w| w.spi1rst().set_bit());
        self.rcc.apb2rstr().modify(|_, w| w.spi1rst().clear_bit());
        match (overran, missing) {
            (true, _) => Err(Broken::Overrun),
            (false, 0) => Ok(self.received),
            (false, missing) => Err(Broken::Short(missing)),
        }
    }

    fn arm(&mut self, next: &Frame) {
        *self.sent = *next;
        // SAFETY: ones clear flags.
        self.dma.lifcr().write(|w| unsafe { w.bits(FLAGS) });
        let [received, sent] = [self.received.as_ptr() as u32, self.sent.as_ptr() as u32];
        self.begin(RECEIVING, received, 0);
        self.spi.cr2().write(|w| w.rxdmaen().enabled().txdmaen().enabled());
        self.begin(SENDING, sent, OUTWARDS);
        // All else as after its reset: slave, mode 0, 8 bits, chip select by its pin.
        cortex_m::asm::dmb();
        self.spi.cr1().write(|w| w.spe().enabled());
    }
}

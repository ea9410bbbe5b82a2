//! SPI1 of STM32F405 as a slave whose bytes are moved by DMA: mode 0, 8 bits, chip select by the master's hand.
//!
//! | use | pin | |
//! |---|---|---|
//! | chip select | PA4 | low during a transfer; its rising edge is the interrupt EXTI4 |
//! | clock | PA5 | at most 42 MHz by the chip, 21 MHz where wires are long |
//! | to the master | PA6 | DMA2 stream 3, channel 3 |
//! | from the master | PA7 | DMA2 stream 0, channel 3 |

use super::bounded_wait::wait_until;
use super::dma_slave::Unit;
use super::pac;
use crate::port::spi::FRAME_BYTES;

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

/// SPI1 and two streams of DMA2.
pub struct Spi1 {
    spi: pac::SPI1,
    dma: pac::DMA2,
    exti: pac::EXTI,
    rcc: pac::RCC,
}

impl Spi1 {
    /// Stops a stream; what it has begun it ends.
    fn end(&self, stream: usize) {
        let control = self.dma.st(stream).cr();
        // SAFETY: a stream that is off may have any settings.
        control.write(|w| unsafe { w.bits(0) });
        let _ = wait_until(|| control.read().bits() & ENABLE == 0);
    }

    /// Starts a stream between the data register and a buffer.
    fn set(&self, stream: usize, buffer: u32, direction: u32) {
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

impl Unit for Spi1 {
    fn start(device: pac::Peripherals) -> Self {
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
        Self { spi, dma, exti, rcc }
    }

    fn acknowledge(&mut self) {
        // SAFETY: a one takes back this line's request.
        self.exti.pr().write(|w| unsafe { w.bits(LINE) });
    }

    fn missing(&self) -> u16 {
        self.dma.st(RECEIVING).ndtr().read().bits() as u16
    }

    fn overran(&self) -> bool {
        let status = self.spi.sr().read();
        status.ovr().bit_is_set() || self.missing() == 0 && status.rxne().bit_is_set()
    }

    fn stop(&mut self) {
        self.end(RECEIVING);
        self.end(SENDING);
        self.rcc.apb2rstr().modify(|_, w| w.spi1rst().set_bit());
        self.rcc.apb2rstr().modify(|_, w| w.spi1rst().clear_bit());
    }

    fn begin(&mut self, received: u32, sent: u32) {
        // SAFETY: ones clear flags.
        self.dma.lifcr().write(|w| unsafe { w.bits(FLAGS) });
        self.set(RECEIVING, received, 0);
        self.spi.cr2().write(|w| w.rxdmaen().enabled().txdmaen().enabled());
        self.set(SENDING, sent, OUTWARDS);
        // All else as after its reset: slave, mode 0, 8 bits, chip select by its pin.
        cortex_m::asm::dmb();
        self.spi.cr1().write(|w| w.spe().enabled());
    }
}

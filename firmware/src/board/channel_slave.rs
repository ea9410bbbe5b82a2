//! SPI2 of STM32G474 as a slave whose bytes are moved by DMA: mode 0, 8 bits, chip select by the master's hand. SPI1 would
//! have its clock where the NUCLEO board has its light.
//!
//! | use | pin | |
//! |---|---|---|
//! | chip select | PB12 | low during a transfer; its rising edge is the interrupt EXTI15_10 |
//! | clock | PB13 | 21 MHz, as the times of the port are stated for |
//! | to the master | PB14 | DMA1 channel 2 |
//! | from the master | PB15 | DMA1 channel 1 |
//!
//! It runs on a model of the board's registers (`board-model`); it has not been run on silicon.

use super::bounded_wait::wait_until;
use super::dma_slave::Unit;
use super::pac;
use crate::port::spi::FRAME_BYTES;

/// Channels of DMA1, counted from 0.
const RECEIVING: usize = 0;
const SENDING: usize = 1;
/// What the multiplexer calls the requests of SPI2.
const REQUESTS: [(usize, u32); 2] = [(RECEIVING, 12), (SENDING, 13)];
/// Addresses in memory rise.
const MEMORY_RISES: u32 = 1 << 7;
/// From memory to the peripheral.
const OUTWARDS: u32 = 1 << 4;
const ENABLE: u32 = 1;
/// All flags of channels 1 and 2.
const FLAGS: u32 = 0xff;
/// The line of the chip select.
const LINE: u32 = 1 << 12;

/// SPI2 and two channels of DMA1.
pub struct Spi2 {
    spi: pac::SPI2,
    dma: pac::DMA1,
    exti: pac::EXTI,
    rcc: pac::RCC,
}

impl Spi2 {
    /// Stops a channel; what it has begun it ends.
    fn end(&self, channel: usize) {
        let control = self.dma.ch(channel).cr();
        // SAFETY: a channel that is off may have any settings.
        control.write(|w| unsafe { w.bits(0) });
        let _ = wait_until(|| control.read().bits() & ENABLE == 0);
    }

    /// Starts a channel between the data register and a buffer.
    fn set(&self, channel: usize, buffer: u32, direction: u32) {
        let registers = self.dma.ch(channel);
        let data = self.spi.dr().as_ptr() as u32;
        // SAFETY: the data register, a buffer of a frame's length that lives for ever, and that length.
        unsafe {
            registers.par().write(|w| w.bits(data));
            registers.mar().write(|w| w.bits(buffer));
            registers.ndtr().write(|w| w.bits(FRAME_BYTES as u32));
            registers.cr().write(|w| w.bits(MEMORY_RISES | direction | ENABLE));
        }
    }
}

impl Unit for Spi2 {
    fn start(device: pac::Peripherals) -> Self {
        let pac::Peripherals {
            SPI2: spi,
            DMA1: dma,
            DMAMUX: requests,
            EXTI: exti,
            RCC: rcc,
            GPIOB: gpio,
            SYSCFG: syscfg,
            ..
        } = device;
        rcc.ahb1enr().modify(|_, w| w.dma1en().set_bit().dmamux1en().set_bit());
        rcc.apb1enr1().modify(|_, w| w.spi2en().set_bit());
        rcc.apb2enr().modify(|_, w| w.syscfgen().set_bit());
        gpio.afrh().modify(|_, w| w.afrh12().af5().afrh13().af5().afrh14().af5().afrh15().af5());
        // At the speed after a reset the answer's edges would take longer than a bit.
        gpio.ospeedr().modify(|_, w| w.ospeedr14().very_high_speed());
        gpio.moder()
            .modify(|_, w| w.moder12().alternate().moder13().alternate().moder14().alternate().moder15().alternate());
        for (channel, request) in REQUESTS {
            // SAFETY: a channel that is off may have any request.
            requests.ccr(channel).write(|w| unsafe { w.bits(request) });
        }
        // SAFETY: line 12 is that of port B (1); lines 13 to 15 are not used.
        syscfg.exticr4().write(|w| unsafe { w.bits(1) });
        // SAFETY: every line may have an edge and an interrupt.
        exti.rtsr1().modify(|r, w| unsafe { w.bits(r.bits() | LINE) });
        // SAFETY: likewise.
        exti.imr1().modify(|r, w| unsafe { w.bits(r.bits() | LINE) });
        Self { spi, dma, exti, rcc }
    }

    fn acknowledge(&mut self) {
        // SAFETY: a one takes back this line's request.
        self.exti.pr1().write(|w| unsafe { w.bits(LINE) });
    }

    fn missing(&self) -> u16 {
        self.dma.ch(RECEIVING).ndtr().read().bits() as u16
    }

    fn overran(&self) -> bool {
        let status = self.spi.sr().read();
        status.ovr().bit_is_set() || self.missing() == 0 && status.rxne().bit_is_set()
    }

    fn stop(&mut self) {
        self.end(RECEIVING);
        self.end(SENDING);
        self.rcc.apb1rstr1().modify(|_, w| w.spi2rst().set_bit());
        self.rcc.apb1rstr1().modify(|_, w| w.spi2rst().clear_bit());
    }

    fn begin(&mut self, received: u32, sent: u32) {
        // SAFETY: ones clear flags.
        self.dma.ifcr().write(|w| unsafe { w.bits(FLAGS) });
        // Every byte asks to be fetched, not every second one as after its reset. The order is that of the reference manual: what
        // receives first, then the channels, then what sends.
        self.spi.cr2().modify(|_, w| w.frxth().quarter().rxdmaen().enabled());
        self.set(RECEIVING, received, 0);
        self.set(SENDING, sent, OUTWARDS);
        self.spi.cr2().modify(|_, w| w.txdmaen().enabled());
        // All else as after its reset: slave, mode 0, 8 bits, chip select by its pin.
        cortex_m::asm::dmb();
        self.spi.cr1().write(|w| w.spe().enabled());
    }
}

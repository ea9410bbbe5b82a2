//! SPI slave of STM32G4 with DMA: mode 0, 8 bits, hardware chip select. The port's times are stated for a clock of 21
//! MHz; the board file selects unit and pins.
//!
//! Tested on a model of the chip's registers (`board-model`); not run on silicon.

use super::bounded_wait::wait_until;
use super::dma_slave::Unit;
use super::gpio::Pin;
use super::pac;
use crate::port::spi::FRAME_BYTES;

/// Registers, requests and clock of each unit.
macro_rules! units {
    ($($name:literal => $spi:ident, $gates:ident, $gate:ident, $resets:ident, $reset:ident, $receives:literal, $sends:literal;)+) => {$(
        #[cfg(spi_slave = $name)]
        mod unit {
            use super::pac;

            pub type Spi = pac::$spi;
            /// Request numbers of the DMA multiplexer.
            pub const RECEIVES: u32 = $receives;
            pub const SENDS: u32 = $sends;

            /// The unit with its clock on.
            pub fn take(clocks: &pac::RCC) -> Spi {
                clocks.$gates().modify(|_, w| w.$gate().set_bit());
                let _ = clocks.$gates().read();
                // SAFETY: called once, at the start; there is no other user of the unit.
                unsafe { Spi::steal() }
            }

            pub fn reset(clocks: &pac::RCC) {
                clocks.$resets().modify(|_, w| w.$reset().set_bit());
                clocks.$resets().modify(|_, w| w.$reset().clear_bit());
            }
        }
    )+};
}

units! {
    "spi1" => SPI1, apb2enr, spi1en, apb2rstr, spi1rst, 10, 11;
    "spi2" => SPI2, apb1enr1, spi2en, apb1rstr1, spi2rst, 12, 13;
    "spi3" => SPI3, apb1enr1, spi3en, apb1rstr1, spi3rst, 14, 15;
}
use unit::Spi;

/// Channels of DMA1, counted from 0.
const RECEIVING: usize = 0;
const SENDING: usize = 1;
/// Incrementing memory addresses.
const MEMORY_RISES: u32 = 1 << 7;
/// Direction from memory to the peripheral.
const OUTWARDS: u32 = 1 << 4;
const ENABLE: u32 = 1;
/// All flags of channels 1 and 2.
const FLAGS: u32 = 0xff;

/// SPI unit with two channels of DMA1.
pub struct ChannelSpi {
    spi: Spi,
    dma: pac::DMA1,
    exti: pac::EXTI,
    clocks: pac::RCC,
    /// EXTI line of the chip select.
    line: u32,
}

impl ChannelSpi {
    /// Stops a channel; a transfer of a byte in progress is completed.
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

impl Unit for ChannelSpi {
    fn start(device: pac::Peripherals, select: Pin) -> Self {
        let pac::Peripherals { DMA1: dma, DMAMUX: requests, EXTI: exti, RCC: clocks, SYSCFG: syscfg, .. } = device;
        clocks.ahb1enr().modify(|_, w| w.dma1en().set_bit().dmamux1en().set_bit());
        let _ = clocks.ahb1enr().read();
        clocks.apb2enr().modify(|_, w| w.syscfgen().set_bit());
        let _ = clocks.apb2enr().read();
        let spi = unit::take(&clocks);
        for (channel, request) in [(RECEIVING, unit::RECEIVES), (SENDING, unit::SENDS)] {
            // SAFETY: a channel that is off may have any request.
            requests.ccr(channel).write(|w| unsafe { w.bits(request) });
        }
        let line = 1 << select.number;
        let (port, shift) = (u32::from(select.port), 4 * u32::from(select.number % 4));
        let to_port = |bits: u32| bits & !(0xf << shift) | port << shift;
        // SAFETY: of the register only the field of this line changes, to the port of the chip select.
        unsafe {
            match select.number / 4 {
                0 => syscfg.exticr1().modify(|r, w| w.bits(to_port(r.bits()))),
                1 => syscfg.exticr2().modify(|r, w| w.bits(to_port(r.bits()))),
                2 => syscfg.exticr3().modify(|r, w| w.bits(to_port(r.bits()))),
                _ => syscfg.exticr4().modify(|r, w| w.bits(to_port(r.bits()))),
            };
        }
        // SAFETY: every line may have an edge and an interrupt.
        exti.rtsr1().modify(|r, w| unsafe { w.bits(r.bits() | line) });
        // SAFETY: every line may have an interrupt.
        exti.imr1().modify(|r, w| unsafe { w.bits(r.bits() | line) });
        Self { spi, dma, exti, clocks, line }
    }

    fn acknowledge(&mut self) {
        // SAFETY: a one takes back this line's request.
        self.exti.pr1().write(|w| unsafe { w.bits(self.line) });
    }

    fn missing(&self) -> u16 {
        self.dma.ch(RECEIVING).ndtr().read().bits() as u16
    }

    fn overran(&self) -> bool {
        self.spi.sr().read().ovr().bit_is_set()
    }

    fn has_byte(&self) -> bool {
        self.spi.sr().read().rxne().bit_is_set()
    }

    fn stop(&mut self) {
        self.end(RECEIVING);
        self.end(SENDING);
        unit::reset(&self.clocks);
    }

    fn begin(&mut self, received: u32, sent: u32) {
        // SAFETY: ones clear flags.
        self.dma.ifcr().write(|w| unsafe { w.bits(FLAGS) });
        // Each received byte requests DMA, not every second one as after reset. Order of the reference manual:
        // reception first, then the channels, then transmission.
        self.spi.cr2().modify(|_, w| w.frxth().quarter().rxdmaen().enabled());
        self.set(RECEIVING, received, 0);
        self.set(SENDING, sent, OUTWARDS);
        self.spi.cr2().modify(|_, w| w.txdmaen().enabled());
        // All other settings as after reset: slave, mode 0, 8 bits, hardware chip select.
        cortex_m::asm::dmb();
        self.spi.cr1().write(|w| w.spe().enabled());
    }
}

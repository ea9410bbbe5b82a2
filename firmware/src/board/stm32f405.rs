//! STM32F405 at 168 MHz, and the board `netduinoplus2` of QEMU, which runs the same image.
//!
//! The estimated parameters are stored in the last two sectors; erasing one blocks the core for one or two seconds. The
//! images run on the emulated board and on a model of the chip's registers (`board-model`); not run on silicon yet.

pub use stm32f4::stm32f405 as pac;

use link::messages::{Clock, ClockSource};

use super::bounded_wait::wait_until;
use super::chip::{Chip, Parts};
use super::description::{EXTERNAL, EXTERNAL_PLL, INTERNAL_PLL, SLOTS};
use super::external_clock::{CaptureTimer, External, Internal, measure, select_clock};
use super::flash_slots::FlashSlots;
use super::flash_unit::{FlashUnit, Kind};
use super::internal_clock::back_to_internal;
use super::old_usart::OldUsart;
use super::serial_unit;
use crate::kept_memory::Slot;

/// This chip.
pub struct Stm32F405;

impl Chip for Stm32F405 {
    /// Tolerance from -10 to 85 degrees; from -40 degrees the frequency may be 8 % low.
    const INTERNAL: Internal = Internal { rate: 16_000_000, tolerance: 40_000 };
    type Port = OldUsart;
    type Slots = FlashSlots<FlashUnit<Sectors>>;

    fn start(device: pac::Peripherals, _core: &mut cortex_m::Peripherals) -> Parts<Self> {
        let clock = start_clock(&device.RCC, &device.FLASH, &device.TIM11);
        let watchdog_reset = device.RCC.csr().read().wdgrstf().bit_is_set();
        device.RCC.csr().modify(|_, w| w.rmvf().set_bit());
        device.RCC.apb1enr().modify(|_, w| w.pwren().set_bit());
        let _ = device.RCC.apb1enr().read();
        // The watchdog waits while a debugger halts the core.
        device.DBGMCU.apb1_fz().modify(|_, w| w.dbg_iwdg_stop().set_bit());
        let slots = FlashSlots::new(FlashUnit::new(device.FLASH, Sectors::watch_supply(device.PWR)));
        Parts { clock, slots, watchdog: device.IWDG, watchdog_reset, clocks: device.RCC }
    }

    fn reset_ports(clocks: &pac::RCC) {
        // SAFETY: a bit for each port that the chip has; a reset leaves the pins of the debug probe to it.
        unsafe {
            clocks.ahb1rstr().modify(|r, w| w.bits(r.bits() | 0x1ff));
            clocks.ahb1rstr().modify(|r, w| w.bits(r.bits() & !0x1ff));
        }
    }

    fn power_port(clocks: &pac::RCC, port: u8) {
        // SAFETY: the chip has this port.
        clocks.ahb1enr().modify(|r, w| unsafe { w.bits(r.bits() | 1 << port) });
        let _ = clocks.ahb1enr().read();
    }

    fn open_port(clocks: &pac::RCC, clock: u32, baud_rate: u32) -> OldUsart {
        OldUsart::open(serial_unit::take(clocks), clocks, clock, baud_rate)
    }
}

/// Starts the PLL at 168 MHz: from the external clock if its frequency agrees with the board file, else from the
/// internal oscillator. Registers that do not read back indicate a missing clock controller.
fn start_clock(clocks: &pac::RCC, flash: &pac::FLASH, timer: &CaptureTimer) -> Clock {
    // Clock source 0 selected while the internal oscillator is off: impossible on a real chip.
    if clocks.cr().read().hsirdy().bit_is_clear() && clocks.cfgr().read().bits() >> 2 & 3 == 0 {
        return Clock::of(ClockSource::NotModelled);
    }
    if !back_to_internal(clocks) {
        return Clock::of(ClockSource::Failed);
    }
    let external = EXTERNAL.map(|(frequency, is_signal)| {
        clocks.cr().modify(|_, w| w.hsebyp().bit(is_signal));
        clocks.cr().modify(|_, w| w.hseon().set_bit());
        let started = wait_until(|| clocks.cr().read().hserdy().bit_is_set());
        External { frequency, is_signal, measured: started.then(|| measured(clocks, timer)) }
    });
    let clock = select_clock(external, &Stm32F405::INTERNAL);
    let is_external = clock.source.is_external();
    if !is_external {
        clocks.cr().modify(|_, w| w.hseon().clear_bit());
    }
    let (divider, factor, _) = EXTERNAL_PLL.filter(|_| is_external).unwrap_or(INTERNAL_PLL);
    clocks.pllcfgr().modify(|_, w| {
        let w = w.pllsrc().bit(is_external).pllp().div2();
        // SAFETY: the build has held divider and factor against the ranges of the reference manual.
        unsafe { w.pllm().bits(divider as u8).plln().bits(factor as u16).pllq().bits(7) }
    });
    clocks.cr().modify(|_, w| w.pllon().set_bit());
    if !wait_until(|| clocks.cr().read().pllrdy().bit_is_set()) {
        return Clock::of(ClockSource::Failed);
    }
    flash.acr().modify(|_, w| w.latency().ws5().prften().set_bit().icen().set_bit().dcen().set_bit());
    if !wait_until(|| flash.acr().read().latency().is_ws5()) {
        return Clock::of(ClockSource::Failed);
    }
    clocks.cfgr().modify(|_, w| w.hpre().div1().ppre1().div4().ppre2().div2().sw().pll());
    if !wait_until(|| clocks.cfgr().read().sws().is_pll()) {
        return Clock::of(ClockSource::Failed);
    }
    clock
}

back_to_internal!(pllon, pllrdy, csson, |clocks| {
    clocks.cfgr().modify(|_, w| w.hpre().div1().ppre1().div1().ppre2().div1());
});

/// Measures the external clock [Hz]; timer 11 sees a 25th of it.
fn measured(clocks: &pac::RCC, timer: &CaptureTimer) -> u32 {
    const DIVIDER: u8 = 25;
    // SAFETY: the division for the clock of the time of day, which nothing else uses.
    clocks.cfgr().modify(|_, w| unsafe { w.rtcpre().bits(DIVIDER) });
    clocks.apb2enr().modify(|_, w| w.tim11en().set_bit());
    let _ = clocks.apb2enr().read();
    // SAFETY: the timer's input is the divided external clock (2).
    timer.or().write(|w| unsafe { w.bits(2) });
    let measured = measure(timer, DIVIDER.into(), &Stm32F405::INTERNAL);
    clocks.apb2enr().modify(|_, w| w.tim11en().clear_bit());
    measured
}

/// Last two sectors, written by words, which requires 2.7 V.
pub struct Sectors(pac::PWR);

impl Sectors {
    /// Enables supply monitoring at the highest level, 2.9 V.
    fn watch_supply(power: pac::PWR) -> Self {
        // SAFETY: every level is allowed.
        power.cr().modify(|_, w| unsafe { w.pls().bits(7) }.pvde().set_bit());
        Self(power)
    }
}

/// Bytes of a sector, except the first five.
const SECTOR: u32 = 128 << 10;

impl Kind for Sectors {
    const SLOTS: [usize; 2] = [SLOTS[0] as usize, SLOTS[1] as usize];
    const TOGETHER: usize = 1;
    const ERRORS: u32 = 0xf3;
    /// Words.
    const SIZE: u32 = 2 << 8;

    fn erase(&self, slot: Slot) -> u32 {
        // Sector erase (1) of a sector (3): from 128 KiB on, the fifth is the first of that size.
        let sector = 4 + (SLOTS[slot.index()] - 0x0800_0000) / SECTOR;
        1 << 1 | sector << 3
    }

    /// Always `true`: this flash has no check bits, and incomplete words are readable.
    fn read(&self, words: &mut dyn FnMut()) -> bool {
        words();
        true
    }

    fn has_supply(&self) -> bool {
        self.0.csr().read().pvdo().bit_is_clear()
    }
}

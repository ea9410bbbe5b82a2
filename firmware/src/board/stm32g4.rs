//! STM32G474, and STM32G431 with less memory, at 170 MHz.
//!
//! The estimated parameters are stored at the end of flash, in two slots. On STM32G474 the slots are 4 KiB apart: one
//! page or two, depending on the option DBANK.
//!
//! Tested on a model of the chip's registers (`board-model`); not run on silicon.

#[cfg(chip = "stm32g431")]
pub use stm32g4::stm32g431 as pac;
#[cfg(chip = "stm32g474")]
pub use stm32g4::stm32g474 as pac;

use core::sync::atomic::AtomicBool;
use core::sync::atomic::Ordering::Relaxed;

use cortex_m::asm::{dsb, isb};
use cortex_m_rt::exception;
use link::messages::{Clock, ClockSource};

use super::bounded_wait::wait_until;
use super::chip::{Chip, Parts};
use super::description::{CORE_RATE, EXTERNAL, EXTERNAL_PLL, FLASH_BYTES, INTERNAL_PLL, SLOTS};
use super::external_clock::{CaptureTimer, External, Internal, measure, select_clock};
use super::fifo_uart::FifoUart;
use super::flash_slots::{FlashSlots, mark};
use super::flash_unit::{FlashUnit, Kind};
use super::internal_clock::back_to_internal;
use super::serial_unit;
use crate::kept_memory::Slot;

/// This chip.
pub struct Stm32G4;

impl Chip for Stm32G4 {
    /// Tolerance from -40 to 105 degrees.
    const INTERNAL: Internal = Internal { rate: 16_000_000, tolerance: 20_000 };
    type Port = FifoUart;
    type Slots = FlashSlots<FlashUnit<LastPages>>;

    fn start(device: pac::Peripherals, _core: &mut cortex_m::Peripherals) -> Parts<Self> {
        let clock = start_clock(&device.RCC, &device.PWR, &device.FLASH, &device.TIM17);
        let watchdog_reset = device.RCC.csr().read().iwdgrstf().bit_is_set();
        device.RCC.csr().modify(|_, w| w.rmvf().set_bit());
        device.RCC.apb1enr1().modify(|_, w| w.pwren().set_bit());
        let _ = device.RCC.apb1enr1().read();
        // The watchdog waits while a debugger halts the core.
        device.DBGMCU.apb1l_fz().modify(|_, w| w.dbg_iwdg_stop().set_bit());
        let pages = LastPages::watch_supply(device.PWR, &device.FLASH);
        let slots = FlashSlots::new(FlashUnit::new(device.FLASH, pages));
        Parts { clock, slots, watchdog: device.IWDG, watchdog_reset, clocks: device.RCC }
    }

    fn reset_ports(clocks: &pac::RCC) {
        // SAFETY: a bit for each port that the chip has; a reset leaves the pins of the debug probe to it.
        unsafe {
            clocks.ahb2rstr().modify(|r, w| w.bits(r.bits() | 0x7f));
            clocks.ahb2rstr().modify(|r, w| w.bits(r.bits() & !0x7f));
        }
    }

    fn power_port(clocks: &pac::RCC, port: u8) {
        // SAFETY: the chip has this port.
        clocks.ahb2enr().modify(|r, w| unsafe { w.bits(r.bits() | 1 << port) });
        let _ = clocks.ahb2enr().read();
    }

    fn open_port(clocks: &pac::RCC, clock: u32, baud_rate: u32) -> FifoUart {
        FifoUart::open(serial_unit::take(clocks), clock, baud_rate)
    }
}

/// Last pages, written by double words.
pub struct LastPages {
    power: pac::PWR,
    pages: Pages,
}

/// Division of flash.
#[derive(Clone, Copy)]
struct Pages {
    bytes: u32,
    /// Pages of the first of two banks; `None` with one bank.
    of_first_bank: Option<u32>,
}

impl Pages {
    /// STM32G474: two banks with pages of 2 KiB, or one with pages of 4 KiB. STM32G431 has one, with pages of 2 KiB.
    fn look(flash: &pac::FLASH) -> Self {
        const DBANK: u32 = 1 << 22;
        let has_two_banks = cfg!(chip = "stm32g474") && flash.optr().read().bits() & DBANK != 0;
        let bytes = if has_two_banks || cfg!(chip = "stm32g431") { 2 << 10 } else { 4 << 10 };
        Self { bytes, of_first_bank: has_two_banks.then_some(FLASH_BYTES / 2 / bytes) }
    }
}

impl LastPages {
    /// Enables supply monitoring at 2.9 V and reads the division of flash.
    fn watch_supply(power: pac::PWR, flash: &pac::FLASH) -> Self {
        // Switches off the USB dead-battery pull-downs at PB4 and PB6 (RM0440 6.4.3), for any use of the two pins.
        power.cr3().modify(|r, w| {
            // SAFETY: UCPD1_DBDIS, which not all chips' descriptions have.
            unsafe { w.bits(r.bits() | 1 << 14) }
        });
        // SAFETY: 6 is a level of the supply itself.
        power.cr2().modify(|_, w| unsafe { w.pvdls().bits(6) }.pvde().set_bit());
        let pages = Pages::look(flash);
        let banks = if pages.of_first_bank.is_some() { 2 } else { 1 };
        defmt::info!("flash of {=u8} banks, pages of {=u32} bytes", banks, pages.bytes);
        Self { power, pages }
    }
}

impl Kind for LastPages {
    const SLOTS: [usize; 2] = [SLOTS[0] as usize, SLOTS[1] as usize];
    const TOGETHER: usize = 2;
    const ERRORS: u32 = 0xc3fb;
    const SIZE: u32 = 0;

    fn erase(&self, slot: Slot) -> u32 {
        // Page erase (1) of a page (3), of the second bank (11).
        let page = (SLOTS[slot.index()] - 0x0800_0000) / self.pages.bytes;
        match self.pages.of_first_bank {
            Some(first) => 1 << 1 | (page - first) << 3 | 1 << 11,
            None => 1 << 1 | page << 3,
        }
    }

    fn read(&self, words: &mut dyn FnMut()) -> bool {
        words();
        dsb();
        isb();
        // An exception, if any, occurs at once.
        !UNREADABLE.swap(false, Relaxed)
    }

    fn has_supply(&self) -> bool {
        self.power.sr2().read().pvdo().bit_is_clear()
    }
}

/// A read of a slot has failed.
static UNREADABLE: AtomicBool = AtomicBool::new(false);
/// Flags of two or more wrong bits in a word, and in the neighbouring word if flash is one bank; cleared by ones.
const DOUBLE_ERRORS: u32 = 1 << 31 | 1 << 29;

/// Handles unreadable flash, which is reported until the flags are cleared. In a slot the record is invalid; elsewhere
/// the program is.
// SAFETY: the handler accesses only the flags and no data that may be half changed.
#[exception]
unsafe fn NonMaskableInt() {
    // SAFETY: only this handler uses this register.
    let flash = unsafe { &*pac::FLASH::ptr() };
    let errors = flash.eccr().read().bits() & DOUBLE_ERRORS;
    assert!(errors != 0 && mark::slot().is_some(), "flash cannot be read");
    // SAFETY: ones clear flags.
    flash.eccr().write(|w| unsafe { w.bits(errors) });
    UNREADABLE.store(true, Relaxed);
}

/// Starts the PLL at 170 MHz: from the external clock if its frequency agrees with the board file, else from the
/// internal oscillator. Above 150 MHz the regulator must be in boost mode; the bus clock is halved while boost mode and
/// PLL start.
fn start_clock(clocks: &pac::RCC, power: &pac::PWR, flash: &pac::FLASH, timer: &CaptureTimer) -> Clock {
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
    let clock = select_clock(external, &Stm32G4::INTERNAL);
    let is_external = clock.source.is_external();
    if !is_external {
        clocks.cr().modify(|_, w| w.hseon().clear_bit());
    }
    let (divider, factor, _) = EXTERNAL_PLL.filter(|_| is_external).unwrap_or(INTERNAL_PLL);
    clocks.pllcfgr().modify(|_, w| {
        let w = if is_external { w.pllsrc().hse() } else { w.pllsrc().hsi16() };
        // SAFETY: the build has held divider and factor against the ranges of the reference manual; the register holds
        // divider - 1.
        unsafe { w.pllm().bits(divider as u8 - 1).plln().bits(factor as u8) }.pllr().div2().pllren().set_bit()
    });
    clocks.cr().modify(|_, w| w.pllon().set_bit());
    if !wait_until(|| clocks.cr().read().pllrdy().bit_is_set()) {
        return Clock::of(ClockSource::Failed);
    }
    clocks.apb1enr1().modify(|_, w| w.pwren().set_bit());
    let _ = clocks.apb1enr1().read();
    clocks.cfgr().modify(|_, w| w.hpre().div2());
    power.cr5().modify(|_, w| w.r1mode().clear_bit());
    flash.acr().modify(|_, w| {
        // SAFETY: four wait states, as the reference manual asks for 170 MHz.
        let w = unsafe { w.latency().bits(4) };
        w.prften().set_bit().icen().set_bit().dcen().set_bit()
    });
    if !wait_until(|| flash.acr().read().latency().bits() == 4) {
        return Clock::of(ClockSource::Failed);
    }
    clocks.cfgr().modify(|_, w| w.sw().pll());
    if !wait_until(|| clocks.cfgr().read().sws().is_pll()) {
        return Clock::of(ClockSource::Failed);
    }
    // Waits a microsecond at half speed, as required by the reference manual.
    cortex_m::asm::delay(CORE_RATE / 1_000_000);
    clocks.cfgr().modify(|_, w| w.hpre().div1());
    clock
}

back_to_internal!(pllon, pllrdy, csson, |clocks| {
    clocks.cfgr().modify(|_, w| w.hpre().div1().ppre1().div1().ppre2().div1());
});

/// Measures the external clock [Hz]; timer 17 sees a 32nd of it.
fn measured(clocks: &pac::RCC, timer: &CaptureTimer) -> u32 {
    const DIVIDER: u32 = 32;
    clocks.apb2enr().modify(|_, w| w.tim17en().set_bit());
    let _ = clocks.apb2enr().read();
    // SAFETY: the timer's input is the divided external clock (3).
    timer.tisel().write(|w| unsafe { w.bits(3) });
    let measured = measure(timer, DIVIDER, &Stm32G4::INTERNAL);
    clocks.apb2enr().modify(|_, w| w.tim17en().clear_bit());
    measured
}

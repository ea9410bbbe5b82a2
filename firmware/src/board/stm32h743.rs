//! STM32H743 at 400 MHz.
//!
//! The estimated parameters are stored in the first two sectors of the second bank.
//!
//! Tested on a model of the chip's registers (`board-model`); not run on silicon.

pub use stm32h7::stm32h743 as pac;

use core::arch::asm;

use cortex_m::asm::{dsb, isb};
use cortex_m::peripheral::SCB;
use link::messages::{Clock, ClockSource};

use super::bounded_wait::wait_until;
use super::chip::{Chip, Parts};
use super::description::{EXTERNAL, EXTERNAL_PLL, INTERNAL_PLL, SLOTS};
use super::external_clock::{CaptureTimer, External, Internal, measure, select_clock};
use super::fifo_uart::FifoUart;
use super::flash_slots::{Flash, FlashSlots};
use super::internal_clock::back_to_internal;
use super::serial_unit;
use crate::kept_memory::Slot;

/// This chip.
pub struct Stm32H743;

impl Chip for Stm32H743 {
    /// Tolerance from -40 to 105 degrees.
    const INTERNAL: Internal = Internal { rate: 64_000_000, tolerance: 20_000 };
    type Port = FifoUart;
    type Slots = FlashSlots<SecondBank>;

    fn start(device: pac::Peripherals, core: &mut cortex_m::Peripherals) -> Parts<Self> {
        core.SCB.enable_icache();
        core.SCB.enable_dcache(&mut core.CPUID);
        let clock = start_clock(&device.RCC, &device.PWR, &device.FLASH, &device.TIM17);
        let watchdog_reset = device.RCC.rsr().read().iwdg1rstf().bit_is_set();
        device.RCC.rsr().modify(|_, w| w.rmvf().set_bit());
        // The watchdog waits while a debugger halts the core.
        device.DBGMCU.apb4fz1().modify(|_, w| w.dbg_iwdg1().set_bit());
        let slots = FlashSlots::new(SecondBank::watch_supply(device.FLASH, device.PWR));
        Parts { clock, slots, watchdog: device.IWDG, watchdog_reset, clocks: device.RCC }
    }

    fn reset_ports(clocks: &pac::RCC) {
        // SAFETY: a bit for each port that the chip has; a reset leaves the pins of the debug probe to it.
        unsafe {
            clocks.ahb4rstr().modify(|r, w| w.bits(r.bits() | 0x7ff));
            clocks.ahb4rstr().modify(|r, w| w.bits(r.bits() & !0x7ff));
        }
    }

    fn power_port(clocks: &pac::RCC, port: u8) {
        // SAFETY: the chip has this port.
        clocks.ahb4enr().modify(|r, w| unsafe { w.bits(r.bits() | 1 << port) });
        let _ = clocks.ahb4enr().read();
    }

    fn open_port(clocks: &pac::RCC, clock: u32, baud_rate: u32) -> FifoUart {
        FifoUart::open(serial_unit::take(clocks), clock, baud_rate)
    }
}

/// Second bank of flash, otherwise unused.
pub struct SecondBank {
    flash: pac::FLASH,
    power: pac::PWR,
}

impl SecondBank {
    /// Enables supply monitoring at 2.85 V.
    fn watch_supply(flash: pac::FLASH, power: pac::PWR) -> Self {
        // SAFETY: 6 is a level of the supply itself.
        power.cr1().modify(|_, w| unsafe { w.pls().bits(6) }.pvde().set_bit());
        Self { flash, power }
    }
}

/// Data bus faults in the core's status: imprecise, precise, and with an address.
const BUS_FAULTS: u32 = 1 << 10 | 1 << 9 | 1 << 15;
/// Configuration bit of the core: failing loads continue with arbitrary data while faults are masked.
const GO_ON: u32 = 1 << 8;
/// Flag of two or more wrong bits in a word, in the bank's status.
const DOUBLE_ERROR: u32 = 1 << 26;

impl Flash for SecondBank {
    const SLOTS: [usize; 2] = [SLOTS[0] as usize, SLOTS[1] as usize];
    const TOGETHER: usize = 8;

    fn is_locked(&self) -> bool {
        self.flash.bank2().cr().read().lock().bit_is_set()
    }

    fn write_key(&mut self, key: u32) {
        // SAFETY: the key register takes every word.
        self.flash.bank2().keyr().write(|w| unsafe { w.bits(key) });
    }

    fn prepare(&mut self) {
        // SAFETY: ones clear the flags of errors and of an end.
        self.flash.bank2().ccr().write(|w| unsafe { w.bits(0x0fef_0000) });
    }

    fn erase(&mut self, slot: Slot) {
        // Sector erase (2), the slot's sector (8), by double words (4), start (7).
        let bits = 1 << 2 | (slot.index() as u32) << 8 | 3 << 4 | 1 << 7;
        // SAFETY: erases a slot, which has no other user.
        self.flash.bank2().cr().write(|w| unsafe { w.bits(bits) });
    }

    fn read(&mut self, words: &mut dyn FnMut()) -> bool {
        // SAFETY: while faults are masked, only these loads can fail; interrupts wait for the few loads of a flash
        // word.
        unsafe {
            let scb = &*SCB::PTR;
            scb.ccr.modify(|bits| bits | GO_ON);
            asm!("cpsid f");
            words();
            dsb();
            isb();
            let faults = scb.cfsr.read() & BUS_FAULTS;
            scb.cfsr.write(faults);
            asm!("cpsie f");
            scb.ccr.modify(|bits| bits & !GO_ON);
            let failed = faults != 0 || self.flash.bank2().sr().read().bits() & DOUBLE_ERROR != 0;
            self.flash.bank2().ccr().write(|w| w.bits(DOUBLE_ERROR));
            !failed
        }
    }

    fn has_supply(&mut self) -> bool {
        self.power.csr1().read().pvdo().bit_is_clear()
    }

    fn set_write_enable(&mut self, on: bool) {
        // SAFETY: programming (1), by double words (4).
        self.flash.bank2().cr().write(|w| unsafe { w.bits(u32::from(on) << 1 | 3 << 4) });
    }

    fn is_busy(&self) -> bool {
        // Busy (0), or with something in its queue (2).
        self.flash.bank2().sr().read().bits() & 0b101 != 0
    }

    fn lock(&mut self) {
        // SAFETY: the lock (0).
        self.flash.bank2().cr().write(|w| unsafe { w.bits(1) });
        // SAFETY: the cache belongs to the core and has no other user: idle runs below everything.
        let mut core = unsafe { cortex_m::Peripherals::steal() };
        core.SCB.clean_invalidate_dcache(&mut core.CPUID);
    }
}

/// Divider of the 800 MHz in PLL 1 for the clock of FDCAN, 80 MHz: below that of its bus.
const CAN_DIVIDER: u8 = 10;

/// Starts PLL 1 at 400 MHz at voltage scale 1: from the external clock if its frequency agrees with the board file,
/// else from the internal oscillator. Buses run at 200 MHz, peripherals at 100 MHz.
fn start_clock(clocks: &pac::RCC, power: &pac::PWR, flash: &pac::FLASH, timer: &CaptureTimer) -> Clock {
    // Clock source 0 selected while the internal oscillator is off: impossible on a real chip.
    if clocks.cr().read().hsirdy().bit_is_clear() && clocks.cfgr().read().bits() >> 3 & 7 == 0 {
        return Clock::of(ClockSource::NotModelled);
    }
    if !back_to_internal(clocks) {
        return Clock::of(ClockSource::Failed);
    }
    power.cr3().modify(|_, w| w.scuen().set_bit().ldoen().set_bit().bypass().clear_bit());
    if !wait_until(|| power.csr1().read().actvosrdy().bit_is_set()) {
        return Clock::of(ClockSource::Failed);
    }
    // SAFETY: 3 stands for scale 1.
    power.d3cr().modify(|_, w| unsafe { w.vos().bits(3) });
    if !wait_until(|| power.d3cr().read().vosrdy().bit_is_set()) {
        return Clock::of(ClockSource::Failed);
    }
    let external = EXTERNAL.map(|(frequency, is_signal)| {
        clocks.cr().modify(|_, w| w.hsebyp().bit(is_signal));
        clocks.cr().modify(|_, w| w.hseon().set_bit());
        let started = wait_until(|| clocks.cr().read().hserdy().bit_is_set());
        External { frequency, is_signal, measured: started.then(|| measured(clocks, timer, frequency)) }
    });
    let clock = select_clock(external, &Stm32H743::INTERNAL);
    let is_external = clock.source.is_external();
    if !is_external {
        clocks.cr().modify(|_, w| w.hseon().clear_bit());
    }
    let (divider, factor, range) = EXTERNAL_PLL.filter(|_| is_external).unwrap_or(INTERNAL_PLL);
    clocks.pllckselr().modify(|_, w| {
        let w = if is_external { w.pllsrc().hse() } else { w.pllsrc().hsi() };
        w.divm1().set(divider as u8)
    });
    clocks
        .pllcfgr()
        .modify(|_, w| w.pll1vcosel().wide_vco().pll1rge().set(range as u8).divp1en().enabled().divq1en().enabled());
    clocks.pll1divr().modify(|_, w| {
        // SAFETY: the register holds factor - 1 and divider - 1; the build has held the factor against the range of the
        // reference manual.
        unsafe { w.divn1().bits(factor as u16 - 1).divq1().bits(CAN_DIVIDER - 1) }.divp1().div2()
    });
    clocks.cr().modify(|_, w| w.pll1on().set_bit());
    if !wait_until(|| clocks.cr().read().pll1rdy().bit_is_set()) {
        return Clock::of(ClockSource::Failed);
    }
    // SAFETY: two wait states, as the reference manual asks for 200 MHz at scale 1.
    flash.acr().modify(|_, w| unsafe { w.latency().bits(2).wrhighfreq().bits(2) });
    if !wait_until(|| flash.acr().read().latency().bits() == 2) {
        return Clock::of(ClockSource::Failed);
    }
    clocks.d1cfgr().modify(|_, w| w.d1cpre().div1().hpre().div2().d1ppre().div2());
    clocks.d2cfgr().modify(|_, w| w.d2ppre1().div2().d2ppre2().div2());
    clocks.d3cfgr().modify(|_, w| w.d3ppre().div2());
    clocks.cfgr().modify(|_, w| w.sw().pll1());
    if !wait_until(|| clocks.cfgr().read().sws().is_pll1()) {
        return Clock::of(ClockSource::Failed);
    }
    clock
}

back_to_internal!(pll1on, pll1rdy, hsecsson, |clocks| {
    clocks.cr().modify(|_, w| w.hsidiv().div1());
    clocks.d1cfgr().modify(|_, w| w.d1cpre().div1().hpre().div1().d1ppre().div1());
    clocks.d2cfgr().modify(|_, w| w.d2ppre1().div1().d2ppre2().div1());
});

/// Measures the external clock [Hz]; timer 17 sees it divided to 1 MHz, if its frequency agrees with the board file.
fn measured(clocks: &pac::RCC, timer: &CaptureTimer, frequency: u32) -> u32 {
    let divider = frequency / 1_000_000;
    // SAFETY: the division for the clock of the time of day, 63 at most, which nothing else uses.
    clocks.cfgr().modify(|_, w| unsafe { w.rtcpre().bits(divider as u8) });
    clocks.apb2enr().modify(|_, w| w.tim17en().set_bit());
    let _ = clocks.apb2enr().read();
    // SAFETY: the timer's input is the divided external clock (2).
    timer.tim17_tisel().write(|w| unsafe { w.bits(2) });
    let measured = measure(timer, divider, &Stm32H743::INTERNAL);
    clocks.apb2enr().modify(|_, w| w.tim17en().clear_bit());
    measured
}

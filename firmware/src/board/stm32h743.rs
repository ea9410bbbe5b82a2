//! STM32H743 at 400 MHz from the 8 MHz that the ST-LINK supplies: the board NUCLEO-H743ZI.
//!
//! | use | pin | |
//! |---|---|---|
//! | serial to the host | PD8 out, PD9 in | USART3, the board's ST-LINK port, 921600 8N1 |
//! | motor enable | PC8 | high: on |
//! | status light | PB0 | the board's green light, on when high |
//!
//! What the observer has learnt is kept in the first two sectors of the second bank.
//!
//! The image runs on a model of the board's registers (`board-model`); it has not been run on silicon.

pub use stm32h7::stm32h743 as pac;

use core::arch::asm;

use cortex_m::asm::{dsb, isb};
use cortex_m::peripheral::SCB;
use link::messages::Clock;

use super::bounded_wait::wait_until;
use super::fifo_uart::FifoUart;
use super::flash_slots::{Flash, FlashSlots};
use super::output::{Output, ports};
use super::{Board, Started, Watchdog, serial_usart};
use crate::kept_memory::Slot;

const BAUD_RATE: u32 = 921_600;
/// Clock of USART3 once the PLL runs: a quarter of the core clock.
const USART_CLOCK: u32 = 100_000_000;
/// Core and USART clock while no PLL runs.
const INTERNAL_CLOCK: u32 = 64_000_000;

/// This board.
pub struct Stm32H743;

impl Board for Stm32H743 {
    const NAME: &'static str = "stm32h743";
    const CORE_RATE: u32 = 400_000_000;
    type Enable = Output<pac::GPIOC, 8>;
    type Light = Output<pac::GPIOB, 0>;
    type Port = FifoUart;
    type Slots = FlashSlots<SecondBank>;

    fn start(device: pac::Peripherals, core: &mut cortex_m::Peripherals) -> Started<Self> {
        core.SCB.enable_icache();
        core.SCB.enable_dcache(&mut core.CPUID);
        let clock = start_clock(&device.RCC, &device.PWR, &device.FLASH);
        let watchdog_reset = device.RCC.rsr().read().iwdg1rstf().bit_is_set();
        device.RCC.rsr().modify(|_, w| w.rmvf().set_bit());
        device.RCC.ahb4enr().modify(|_, w| w.gpioben().set_bit().gpiocen().set_bit().gpioden().set_bit());
        device.RCC.apb1lenr().modify(|_, w| w.usart3en().set_bit());
        device.GPIOD.afrh().modify(|_, w| w.afr8().af7().afr9().af7());
        device.GPIOD.pupdr().modify(|_, w| w.pupdr9().pull_up());
        device.GPIOD.moder().modify(|_, w| w.moder8().alternate().moder9().alternate());
        device.GPIOC.moder().modify(|_, w| w.moder8().output());
        device.GPIOB.moder().modify(|_, w| w.moder0().output());
        let usart_clock = if clock == Clock::Failed { INTERNAL_CLOCK } else { USART_CLOCK };
        Started {
            clock,
            enable: Output::new(device.GPIOC),
            light: Output::new(device.GPIOB),
            port: FifoUart::open(device.USART3, usart_clock, BAUD_RATE),
            slots: FlashSlots::new(SecondBank::watch_supply(device.FLASH, device.PWR)),
            watchdog: Watchdog::start(device.IWDG),
            watchdog_reset,
        }
    }

    fn wake_serial() {
        serial_usart::wake();
    }
}

/// The second bank, of which nothing else is used.
pub struct SecondBank {
    flash: pac::FLASH,
    power: pac::PWR,
}

impl SecondBank {
    /// Has the supply watched at 2.85 V.
    fn watch_supply(flash: pac::FLASH, power: pac::PWR) -> Self {
        // SAFETY: 6 is a level of the supply itself.
        power.cr1().modify(|_, w| unsafe { w.pls().bits(6) }.pvde().set_bit());
        Self { flash, power }
    }
}

/// Faults of the data bus in the core's status: imprecise, precise, and with an address.
const BUS_FAULTS: u32 = 1 << 10 | 1 << 9 | 1 << 15;
/// In the core's configuration: loads that fail while faults are masked go on with anything.
const GO_ON: u32 = 1 << 8;
/// Two or more wrong bits in a word, in the bank's status.
const DOUBLE_ERROR: u32 = 1 << 26;

impl Flash for SecondBank {
    const SLOTS: [usize; 2] = [0x0810_0000, 0x0812_0000];
    const TOGETHER: usize = 8;

    fn is_locked(&self) -> bool {
        self.flash.bank2().cr().read().lock().bit_is_set()
    }

    fn take_key(&mut self, key: u32) {
        // SAFETY: the key register takes every word.
        self.flash.bank2().keyr().write(|w| unsafe { w.bits(key) });
    }

    fn prepare(&mut self) {
        // SAFETY: ones clear the flags of errors and of an end.
        self.flash.bank2().ccr().write(|w| unsafe { w.bits(0x0fef_0000) });
    }

    fn erase(&mut self, slot: Slot) {
        // SAFETY: sector erase (2), the slot's sector (8), by double words (4), start (7).
        let bits = 1 << 2 | (slot.index() as u32) << 8 | 3 << 4 | 1 << 7;
        self.flash.bank2().cr().write(|w| unsafe { w.bits(bits) });
    }

    fn read(&mut self, words: &mut dyn FnMut()) -> bool {
        // SAFETY: for as long as faults are masked, these loads alone can fail; interrupts wait for the few that a flash
        // word has.
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

    fn take_writes(&mut self, on: bool) {
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
        // SAFETY: the cache is the core's alone, and nobody else has it in hand: idle runs below everything.
        let mut core = unsafe { cortex_m::Peripherals::steal() };
        core.SCB.clean_invalidate_dcache(&mut core.CPUID);
    }
}

/// 400 MHz by PLL 1 at voltage scale 1: from the ST-LINK's clock, else from the internal oscillator. Buses run at
/// 200 MHz, peripherals at 100 MHz.
fn start_clock(rcc: &pac::RCC, power: &pac::PWR, flash: &pac::FLASH) -> Clock {
    if rcc.cr().read().hsirdy().bit_is_clear() {
        return Clock::NotModelled;
    }
    power.cr3().modify(|_, w| w.scuen().set_bit().ldoen().set_bit().bypass().clear_bit());
    if !wait_until(|| power.csr1().read().actvosrdy().bit_is_set()) {
        return Clock::Failed;
    }
    // SAFETY: 3 stands for scale 1.
    power.d3cr().modify(|_, w| unsafe { w.vos().bits(3) });
    if !wait_until(|| power.d3cr().read().vosrdy().bit_is_set()) {
        return Clock::Failed;
    }
    rcc.cr().modify(|_, w| w.hsebyp().set_bit());
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    let external = wait_until(|| rcc.cr().read().hserdy().bit_is_set());
    if !external {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
    }
    // Both give the PLL 4 MHz, 800 MHz inside, 400 MHz out.
    rcc.pllckselr().modify(|_, w| match external {
        true => w.pllsrc().hse().divm1().set(2),
        false => w.pllsrc().hsi().divm1().set(16),
    });
    rcc.pllcfgr().modify(|_, w| w.pll1vcosel().wide_vco().pll1rge().range4().divp1en().enabled());
    // SAFETY: the register holds factor - 1, within the range of the reference manual.
    rcc.pll1divr().modify(|_, w| unsafe { w.divn1().bits(200 - 1) }.divp1().div2());
    rcc.cr().modify(|_, w| w.pll1on().set_bit());
    if !wait_until(|| rcc.cr().read().pll1rdy().bit_is_set()) {
        return Clock::Failed;
    }
    // SAFETY: two wait states, as the reference manual asks for 200 MHz at scale 1.
    flash.acr().modify(|_, w| unsafe { w.latency().bits(2).wrhighfreq().bits(2) });
    if !wait_until(|| flash.acr().read().latency().bits() == 2) {
        return Clock::Failed;
    }
    rcc.d1cfgr().modify(|_, w| w.d1cpre().div1().hpre().div2().d1ppre().div2());
    rcc.d2cfgr().modify(|_, w| w.d2ppre1().div2().d2ppre2().div2());
    rcc.d3cfgr().modify(|_, w| w.d3ppre().div2());
    rcc.cfgr().modify(|_, w| w.sw().pll1());
    if !wait_until(|| rcc.cfgr().read().sws().is_pll1()) {
        return Clock::Failed;
    }
    if external { Clock::External } else { Clock::InternalFallback }
}

ports!(pac::GPIOB, pac::GPIOC);

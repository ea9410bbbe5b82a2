//! STM32G474 at 170 MHz from a 24 MHz crystal: the board NUCLEO-G474RE.
//!
//! | use | pin | |
//! |---|---|---|
//! | serial to the host | PA2 out, PA3 in | USART2, the board's ST-LINK port, 921600 8N1 |
//! | motor enable | PB0 | high: on |
//! | status light | PA5 | the board's green light, on when high |
//!
//! What the observer has learnt is kept at the end of flash, in two slots that are 4 KiB apart: one page, or two, as the
//! option DBANK says.
//!
//! The image runs on a model of the board's registers (`board-model`); it has not been run on silicon.

pub use stm32g4::stm32g474 as pac;

use core::sync::atomic::AtomicBool;
use core::sync::atomic::Ordering::Relaxed;

use cortex_m::asm::{dsb, isb};
use cortex_m_rt::exception;
use link::messages::Clock;

use super::bounded_wait::wait_until;
use super::fifo_uart::FifoUart;
use super::flash_slots::{FlashSlots, mark};
use super::flash_unit::{FlashUnit, Kind};
use super::output::{Output, ports};
use super::{Board, Started, Watchdog, serial_usart};
use crate::kept_memory::Slot;

const BAUD_RATE: u32 = 921_600;
/// Clock of USART2 once the PLL runs.
const USART_CLOCK: u32 = 170_000_000;
/// Core and USART clock while no PLL runs.
const INTERNAL_CLOCK: u32 = 16_000_000;

/// This board.
pub struct Stm32G474;

impl Board for Stm32G474 {
    const NAME: &'static str = "stm32g474";
    const CORE_RATE: u32 = 170_000_000;
    type Enable = Output<pac::GPIOB, 0>;
    type Light = Output<pac::GPIOA, 5>;
    type Port = FifoUart;
    type Slots = FlashSlots<FlashUnit<LastPages>>;

    fn start(device: pac::Peripherals, _core: &mut cortex_m::Peripherals) -> Started<Self> {
        let clock = start_clock(&device.RCC, &device.PWR, &device.FLASH);
        let watchdog_reset = device.RCC.csr().read().iwdgrstf().bit_is_set();
        device.RCC.csr().modify(|_, w| w.rmvf().set_bit());
        device.RCC.ahb2enr().modify(|_, w| w.gpioaen().set_bit().gpioben().set_bit());
        device.RCC.apb1enr1().modify(|_, w| w.usart2en().set_bit().pwren().set_bit());
        device.GPIOA.afrl().modify(|_, w| w.afrl2().af7().afrl3().af7());
        device.GPIOA.pupdr().modify(|_, w| w.pupdr3().pull_up());
        device.GPIOA.moder().modify(|_, w| w.moder2().alternate().moder3().alternate().moder5().output());
        device.GPIOB.moder().modify(|_, w| w.moder0().output());
        let pages = LastPages::watch_supply(device.PWR, &device.FLASH);
        let usart_clock = if clock == Clock::Failed { INTERNAL_CLOCK } else { USART_CLOCK };
        Started {
            clock,
            enable: Output::new(device.GPIOB),
            light: Output::new(device.GPIOA),
            port: FifoUart::open(device.USART2, usart_clock, BAUD_RATE),
            slots: FlashSlots::new(FlashUnit::new(device.FLASH, pages)),
            watchdog: Watchdog::start(device.IWDG),
            watchdog_reset,
        }
    }

    fn wake_serial() {
        serial_usart::wake();
    }
}

/// The last 8 KiB, written by double words.
pub struct LastPages {
    power: pac::PWR,
    /// Flash is two banks with pages of 2 KiB, not one with pages of 4 KiB.
    has_two_banks: bool,
}

impl LastPages {
    /// Has the supply watched at 2.9 V, and looks how flash is divided.
    fn watch_supply(power: pac::PWR, flash: &pac::FLASH) -> Self {
        // SAFETY: 6 is a level of the supply itself.
        power.cr2().modify(|_, w| unsafe { w.pvdls().bits(6) }.pvde().set_bit());
        // DBANK.
        let has_two_banks = flash.optr().read().bits() & 1 << 22 != 0;
        defmt::info!(
            "flash has {=str}",
            if has_two_banks { "two banks, pages of 2 KiB" } else { "one bank, pages of 4 KiB" }
        );
        Self { power, has_two_banks }
    }
}

impl Kind for LastPages {
    const SLOTS: [usize; 2] = [0x0807_e000, 0x0807_f000];
    const TOGETHER: usize = 2;
    const ERRORS: u32 = 0xc3fb;
    const SIZE: u32 = 0;

    fn erase(&self, slot: Slot) -> u32 {
        // Page erase (1) of a page (3), of bank 2 (11) where there are two.
        let index = slot.index() as u32;
        match self.has_two_banks {
            true => 1 << 1 | (124 + 2 * index) << 3 | 1 << 11,
            false => 1 << 1 | (126 + index) << 3,
        }
    }

    fn read(&self, words: &mut dyn FnMut()) -> bool {
        words();
        dsb();
        isb();
        // The exception comes at once, if it comes.
        !UNREADABLE.swap(false, Relaxed)
    }

    fn has_supply(&self) -> bool {
        self.power.sr2().read().pvdo().bit_is_clear()
    }
}

/// Words of a slot could not be read.
static UNREADABLE: AtomicBool = AtomicBool::new(false);
/// Two or more wrong bits in a word, and in the word beside it where flash is one bank: ones clear the flags.
const DOUBLE_ERRORS: u32 = 1 << 31 | 1 << 29;

/// Flash that cannot be read, which is told until the flags are cleared. In a slot, its record is no good; anywhere else
/// the program is.
// SAFETY: the handler touches the flags and nothing that it may find half changed.
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

/// 170 MHz by the PLL: from the crystal, else from the internal oscillator. Above 150 MHz the regulator must be in its
/// boost mode, and the bus clock is halved while that and the PLL come in.
fn start_clock(rcc: &pac::RCC, power: &pac::PWR, flash: &pac::FLASH) -> Clock {
    if rcc.cr().read().hsirdy().bit_is_clear() {
        return Clock::NotModelled;
    }
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    let external = wait_until(|| rcc.cr().read().hserdy().bit_is_set());
    if !external {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
    }
    // Both give the PLL 4 MHz, 340 MHz inside, 170 MHz out.
    rcc.pllcfgr().modify(|_, w| {
        let w = if external { w.pllsrc().hse().pllm().div6() } else { w.pllsrc().hsi16().pllm().div4() };
        w.plln().div85().pllr().div2().pllren().set_bit()
    });
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    if !wait_until(|| rcc.cr().read().pllrdy().bit_is_set()) {
        return Clock::Failed;
    }
    rcc.apb1enr1().modify(|_, w| w.pwren().set_bit());
    rcc.cfgr().modify(|_, w| w.hpre().div2());
    power.cr5().modify(|_, w| w.r1mode().clear_bit());
    flash.acr().modify(|_, w| {
        // SAFETY: four wait states, as the reference manual asks for 170 MHz.
        let w = unsafe { w.latency().bits(4) };
        w.prften().set_bit().icen().set_bit().dcen().set_bit()
    });
    if !wait_until(|| flash.acr().read().latency().bits() == 4) {
        return Clock::Failed;
    }
    rcc.cfgr().modify(|_, w| w.sw().pll());
    if !wait_until(|| rcc.cfgr().read().sws().is_pll()) {
        return Clock::Failed;
    }
    // A microsecond at half speed, as the reference manual asks.
    cortex_m::asm::delay(Stm32G474::CORE_RATE / 1_000_000);
    rcc.cfgr().modify(|_, w| w.hpre().div1());
    if external { Clock::External } else { Clock::InternalFallback }
}

ports!(pac::GPIOA, pac::GPIOB);

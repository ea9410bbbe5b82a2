//! STM32G474 at 170 MHz from a 24 MHz crystal: the board NUCLEO-G474RE.
//!
//! | use | pin | |
//! |---|---|---|
//! | serial to the host | PA2 out, PA3 in | USART2, the board's ST-LINK port, 921600 8N1 |
//! | motor enable | PB0 | high: on |
//! | status light | PA5 | the board's green light, on when high |
//!
//! What the observer has learnt is kept in the last page of 2 KB, in its second bank.
//!
//! The image runs on a model of the board's registers (`board-model`); it has not been run on silicon.

pub use stm32g4::stm32g474 as pac;

use link::messages::Clock;

use super::bounded_wait::wait_until;
use super::fifo_uart::FifoUart;
use super::flash_page::FlashPage;
use super::flash_unit::{Bits, FlashUnit};
use super::output::{Output, ports};
use super::{Board, Started, Watchdog, serial_usart};

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
    type Page = FlashPage<LastPage>;

    fn start(device: pac::Peripherals, _core: &mut cortex_m::Peripherals) -> Started<Self> {
        let clock = start_clock(&device.RCC, &device.PWR, &device.FLASH);
        let watchdog_reset = device.RCC.csr().read().iwdgrstf().bit_is_set();
        device.RCC.csr().modify(|_, w| w.rmvf().set_bit());
        device.RCC.ahb2enr().modify(|_, w| w.gpioaen().set_bit().gpioben().set_bit());
        device.RCC.apb1enr1().modify(|_, w| w.usart2en().set_bit());
        device.GPIOA.afrl().modify(|_, w| w.afrl2().af7().afrl3().af7());
        device.GPIOA.pupdr().modify(|_, w| w.pupdr3().pull_up());
        device.GPIOA.moder().modify(|_, w| w.moder2().alternate().moder3().alternate().moder5().output());
        device.GPIOB.moder().modify(|_, w| w.moder0().output());
        let usart_clock = if clock == Clock::Failed { INTERNAL_CLOCK } else { USART_CLOCK };
        Started {
            clock,
            enable: Output::new(device.GPIOB),
            light: Output::new(device.GPIOA),
            port: FifoUart::open(device.USART2, usart_clock, BAUD_RATE),
            page: FlashPage(FlashUnit::new(device.FLASH, LAST_PAGE)),
            watchdog: Watchdog::start(device.IWDG),
            watchdog_reset,
        }
    }

    fn wake_serial() {
        serial_usart::wake();
    }
}

/// The last page of the second bank, by double words.
pub type LastPage = FlashUnit<0x0807_f800, 2>;
/// Page erase (1) of page 127 (3) of bank 2 (11).
const LAST_PAGE: Bits = Bits { errors: 0xc3fb, erase: 1 << 1 | 127 << 3 | 1 << 11, size: 0 };

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

//! STM32F405 at 168 MHz from an 8 MHz crystal, and the board `netduinoplus2` of QEMU, which runs the same image.
//!
//! | use | pin | |
//! |---|---|---|
//! | serial to the host | PA9 out, PA10 in | USART1, 230400 8N1 |
//! | motor enable | PB0 | high: on |
//! | status light | PC12 | the light of Olimex STM32-H405, which is on when low |
//!
//! What the observer has learnt is kept in the last two sectors of 128 KiB; while one is erased the core stands still for a
//! second or two.
//!
//! This USART has room for one byte only, and the tick may hold its interrupt off for most of a period (50 us): at
//! 230400 baud a byte takes 43 us. The emulated board heeds no baud rate. Nothing here has been run on silicon yet.

pub use stm32f4::stm32f405 as pac;

use core::convert::Infallible;

use cortex_m::peripheral::NVIC;
use embedded_hal::digital::{ErrorType, OutputPin};
use link::messages::Clock;

use super::bounded_wait::wait_until;
use super::flash_slots::FlashSlots;
use super::flash_unit::{FlashUnit, Kind};
use super::output::{Output, ports};
use super::{Board, Started, Watchdog};
use crate::kept_memory::Slot;
use crate::serial::Uart;

const BAUD_RATE: u32 = 230_400;
/// Clock of USART1 once the PLL runs: half the core clock.
const USART_CLOCK: u32 = 84_000_000;
/// Core and USART clock while no PLL runs.
const INTERNAL_CLOCK: u32 = 16_000_000;

/// This board.
pub struct Stm32F405;

impl Board for Stm32F405 {
    const NAME: &'static str = "stm32f405";
    const CORE_RATE: u32 = 168_000_000;
    type Enable = Output<pac::GPIOB, 0>;
    type Light = LowLight;
    type Port = Usart;
    type Slots = FlashSlots<FlashUnit<Sectors>>;

    fn start(device: pac::Peripherals, _core: &mut cortex_m::Peripherals) -> Started<Self> {
        let clock = start_clock(&device.RCC, &device.FLASH);
        let watchdog_reset = device.RCC.csr().read().wdgrstf().bit_is_set();
        device.RCC.csr().modify(|_, w| w.rmvf().set_bit());
        device.RCC.ahb1enr().modify(|_, w| w.gpioaen().set_bit().gpioben().set_bit().gpiocen().set_bit());
        device.RCC.apb1enr().modify(|_, w| w.pwren().set_bit());
        device.RCC.apb2enr().modify(|_, w| w.usart1en().set_bit());
        device.GPIOA.afrh().modify(|_, w| w.afrh9().af7().afrh10().af7());
        device.GPIOA.pupdr().modify(|_, w| w.pupdr10().pull_up());
        device.GPIOA.moder().modify(|_, w| w.moder9().alternate().moder10().alternate());
        device.GPIOB.moder().modify(|_, w| w.moder0().output());
        device.GPIOC.moder().modify(|_, w| w.moder12().output());
        let usart_clock = if clock == Clock::Failed { INTERNAL_CLOCK } else { USART_CLOCK };
        Started {
            clock,
            enable: Output::new(device.GPIOB),
            light: LowLight(Output::new(device.GPIOC)),
            port: Usart::open(device.USART1, usart_clock),
            slots: FlashSlots::new(FlashUnit::new(device.FLASH, Sectors::watch_supply(device.PWR))),
            watchdog: Watchdog::start(device.IWDG),
            watchdog_reset,
        }
    }

    fn wake_serial() {
        NVIC::pend(pac::Interrupt::USART1);
    }
}

/// 168 MHz by the PLL: from the crystal, else from the internal oscillator. The internal oscillator drives the core
/// from reset on, so if it is not ready there is no clock controller.
fn start_clock(rcc: &pac::RCC, flash: &pac::FLASH) -> Clock {
    if rcc.cr().read().hsirdy().bit_is_clear() {
        return Clock::NotModelled;
    }
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    let external = wait_until(|| rcc.cr().read().hserdy().bit_is_set());
    if !external {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
    }
    // Both give the PLL 2 MHz, 336 MHz inside, 168 MHz out.
    let divider = if external { 4 } else { 8 };
    rcc.pllcfgr().modify(|_, w| {
        let w = w.pllsrc().bit(external).pllp().div2();
        // SAFETY: divider and factor are within the ranges of the reference manual.
        unsafe { w.pllm().bits(divider).plln().bits(168).pllq().bits(7) }
    });
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    if !wait_until(|| rcc.cr().read().pllrdy().bit_is_set()) {
        return Clock::Failed;
    }
    flash.acr().modify(|_, w| w.latency().ws5().prften().set_bit().icen().set_bit().dcen().set_bit());
    if !wait_until(|| flash.acr().read().latency().is_ws5()) {
        return Clock::Failed;
    }
    rcc.cfgr().modify(|_, w| w.hpre().div1().ppre1().div4().ppre2().div2().sw().pll());
    if !wait_until(|| rcc.cfgr().read().sws().is_pll()) {
        return Clock::Failed;
    }
    if external { Clock::External } else { Clock::InternalFallback }
}

ports!(pac::GPIOB, pac::GPIOC);

/// A light that shines when its pin is low.
pub struct LowLight(Output<pac::GPIOC, 12>);

impl ErrorType for LowLight {
    type Error = Infallible;
}

impl OutputPin for LowLight {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set_high()
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set_low()
    }
}

/// The last two sectors, written by words: that takes 2.7 V.
pub struct Sectors(pac::PWR);

impl Sectors {
    /// Has the supply watched at the highest level, 2.9 V.
    fn watch_supply(power: pac::PWR) -> Self {
        // SAFETY: every level is allowed.
        power.cr().modify(|_, w| unsafe { w.pls().bits(7) }.pvde().set_bit());
        Self(power)
    }
}

impl Kind for Sectors {
    const SLOTS: [usize; 2] = [0x080c_0000, 0x080e_0000];
    const TOGETHER: usize = 1;
    const ERRORS: u32 = 0xf3;
    /// Words.
    const SIZE: u32 = 2 << 8;

    fn erase(&self, slot: Slot) -> u32 {
        // Sector erase (1) of sector 10 or 11 (3).
        1 << 1 | (10 + slot.index() as u32) << 3
    }

    /// This flash has no check bits: what was half written reads as something.
    fn read(&self, words: &mut dyn FnMut()) -> bool {
        words();
        true
    }

    fn has_supply(&self) -> bool {
        self.0.csr().read().pvdo().bit_is_clear()
    }
}

/// USART1.
pub struct Usart {
    registers: pac::USART1,
    overran: bool,
}

impl Usart {
    fn open(registers: pac::USART1, clock: u32) -> Self {
        // SAFETY: the quotient is a valid divider for 16-fold oversampling.
        registers.brr().write(|w| unsafe { w.bits((clock / BAUD_RATE) as u16) });
        registers.cr1().write(|w| w.ue().set_bit().te().set_bit().re().set_bit().rxneie().set_bit());
        Self { registers, overran: false }
    }
}

impl Uart for Usart {
    fn read(&mut self) -> Option<u8> {
        let status = self.registers.sr().read();
        self.overran |= status.ore().bit_is_set();
        // Reading the data after the status also clears the overrun.
        (status.rxne().bit_is_set() || status.ore().bit_is_set()).then(|| self.registers.dr().read().dr().bits() as u8)
    }

    fn overran(&mut self) -> bool {
        core::mem::take(&mut self.overran)
    }

    fn can_write(&self) -> bool {
        self.registers.sr().read().txe().bit_is_set()
    }

    fn write(&mut self, byte: u8) {
        // SAFETY: any nine bits may be sent.
        self.registers.dr().write(|w| unsafe { w.dr().bits(byte.into()) });
    }

    fn interrupt_on_write(&mut self, on: bool) {
        self.registers.cr1().modify(|_, w| w.txeie().bit(on));
    }

    fn interrupt_again(&mut self) {
        Stm32F405::wake_serial();
    }
}

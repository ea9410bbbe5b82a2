//! STM32F405: RM0090, memory map in its table 1, interrupts in its table 61.

use super::{always, gated, ports};
use crate::machine::{Chip, Memory};
use crate::peripherals::bxcan::{self, Bxcan};
use crate::peripherals::dbgmcu::Dbgmcu;
use crate::peripherals::dma_stream::DmaStreams;
use crate::peripherals::exti::Exti;
use crate::peripherals::gpio::Gpio;
use crate::peripherals::iwdg::Iwdg;
use crate::peripherals::spi::{self, Spi};
use crate::peripherals::syscfg::Syscfg;
use crate::peripherals::tim::{self, Timer};
use crate::peripherals::usart::{BusClock, Place, Usart};
use crate::peripherals::{flash_f4, pwr_f4, rcc_f4};
use crate::wires::Pin;

const AHB1ENR: u32 = 0x30;
const APB1ENR: u32 = 0x40;
const APB2ENR: u32 = 0x44;
const AHB1RSTR: u32 = 0x10;
const APB1RSTR: u32 = 0x20;
const APB2RSTR: u32 = 0x24;
const RM: &str = "RM0090 7.3";

/// RM0090 2.3.1: the core-coupled memory is on the core's own bus.
static MEMORIES: [Memory; 2] = [
    Memory { base: 0x1000_0000, size: 0x1_0000, core_only: true },
    Memory { base: 0x2000_0000, size: 0x2_0000, core_only: false },
];

/// Data sheet of STM32F405, table 9: USART1 to USART3 are function 7, the others function 8.
const USART1: Place = Place {
    number: 1,
    interrupt: 37,
    clock: BusClock::High,
    send: &[(Pin('A', 9), 7), (Pin('B', 6), 7)],
    receive: &[(Pin('A', 10), 7), (Pin('B', 7), 7)],
};
const USART2: Place = Place {
    number: 2,
    interrupt: 38,
    clock: BusClock::Low,
    send: &[(Pin('A', 2), 7), (Pin('D', 5), 7)],
    receive: &[(Pin('A', 3), 7), (Pin('D', 6), 7)],
};
const USART3: Place = Place {
    number: 3,
    interrupt: 39,
    clock: BusClock::Low,
    send: &[(Pin('B', 10), 7), (Pin('C', 10), 7), (Pin('D', 8), 7)],
    receive: &[(Pin('B', 11), 7), (Pin('C', 11), 7), (Pin('D', 9), 7)],
};
const UART4: Place = Place {
    number: 4,
    interrupt: 52,
    clock: BusClock::Low,
    send: &[(Pin('A', 0), 8), (Pin('C', 10), 8)],
    receive: &[(Pin('A', 1), 8), (Pin('C', 11), 8)],
};
const UART5: Place =
    Place { number: 5, interrupt: 53, clock: BusClock::Low, send: &[(Pin('C', 12), 8)], receive: &[(Pin('D', 2), 8)] };
const USART6: Place = Place {
    number: 6,
    interrupt: 71,
    clock: BusClock::High,
    send: &[(Pin('C', 6), 8), (Pin('G', 14), 8)],
    receive: &[(Pin('C', 7), 8), (Pin('G', 9), 8)],
};

/// Same data sheet, table 9: SPI1 is function 5.
const SPI1: spi::Place = spi::Place {
    number: 1,
    clock: BusClock::High,
    pins: [(Pin('A', 4), 5), (Pin('A', 5), 5), (Pin('A', 6), 5), (Pin('A', 7), 5)],
};

/// Same data sheet, table 9: both CAN are function 9.
const CAN1: bxcan::Place = bxcan::Place {
    number: 1,
    interrupts: [19, 20, 21, 22],
    send: &[(Pin('A', 12), 9), (Pin('B', 9), 9), (Pin('D', 1), 9)],
    receive: &[(Pin('A', 11), 9), (Pin('B', 8), 9), (Pin('D', 0), 9)],
};

/// RM0090 19.5: HSE_RTC is input 2.
const TIM11: tim::Place = tim::Place { map: &tim::F4, interrupt: 26, selection: (0x50, 2) };

/// Chip with an image that ends at an address.
pub fn chip(image_end: u32) -> Chip {
    let mut peripherals = vec![
        always("RCC", 0x4002_3800, Box::new(rcc_f4::Rcc::default())),
        always("FLASH", 0x4002_3c00, Box::new(flash_f4::Flash::new(image_end))),
        always("IWDG", 0x4000_3000, Box::new(Iwdg::new(false))),
        always("EXTI", 0x4001_3c00, Box::new(Exti::f4())),
        always("DBGMCU", 0xe004_2000, Box::new(Dbgmcu::f405())),
        gated(RM, "PWR", 0x4000_7000, (APB1ENR, 28), None, Box::new(pwr_f4::Pwr::default())),
        gated(RM, "SYSCFG", 0x4001_3800, (APB2ENR, 14), Some((APB2RSTR, 14)), Box::new(Syscfg::f4())),
        gated(RM, "USART1", 0x4001_1000, (APB2ENR, 4), Some((APB2RSTR, 4)), Box::new(Usart::old(USART1))),
        gated(RM, "USART2", 0x4000_4400, (APB1ENR, 17), Some((APB1RSTR, 17)), Box::new(Usart::old(USART2))),
        gated(RM, "USART3", 0x4000_4800, (APB1ENR, 18), Some((APB1RSTR, 18)), Box::new(Usart::old(USART3))),
        gated(RM, "UART4", 0x4000_4c00, (APB1ENR, 19), Some((APB1RSTR, 19)), Box::new(Usart::old_uart(UART4))),
        gated(RM, "UART5", 0x4000_5000, (APB1ENR, 20), Some((APB1RSTR, 20)), Box::new(Usart::old_uart(UART5))),
        gated(RM, "USART6", 0x4001_1400, (APB2ENR, 5), Some((APB2RSTR, 5)), Box::new(Usart::old(USART6))),
        gated(RM, "DMA1", 0x4002_6000, (AHB1ENR, 21), Some((AHB1RSTR, 21)), Box::new(DmaStreams::new(1))),
        gated(RM, "DMA2", 0x4002_6400, (AHB1ENR, 22), Some((AHB1RSTR, 22)), Box::new(DmaStreams::new(2))),
        gated(RM, "TIM11", 0x4001_4800, (APB2ENR, 18), Some((APB2RSTR, 18)), Box::new(Timer::new(TIM11))),
        gated(RM, "CAN1", 0x4000_6400, (APB1ENR, 25), Some((APB1RSTR, 25)), Box::new(Bxcan::new(CAN1))),
        gated(RM, "SPI1", 0x4001_3000, (APB2ENR, 12), Some((APB2RSTR, 12)), Box::new(Spi::old(SPI1))),
    ];
    let names = ["GPIOA", "GPIOB", "GPIOC", "GPIOD", "GPIOE", "GPIOF", "GPIOG", "GPIOH", "GPIOI"];
    peripherals.extend(ports(RM, 0x4002_0000, [AHB1ENR, AHB1RSTR], &names, Gpio::f4));
    Chip {
        name: "stm32f405",
        is_m7: false,
        flash: 0x10_0000,
        memories: &MEMORIES,
        peripherals,
        after_reset: rcc_f4::AFTER_RESET,
        reset_flags: rcc_f4::flags,
    }
}

//! STM32G474: RM0440, memory map in its table 3, interrupts in its table 97.

use super::{always, gated, ports};
use crate::machine::{Chip, Memory, Placed};
use crate::peripherals::dbgmcu::Dbgmcu;
use crate::peripherals::dma_channel::DmaChannels;
use crate::peripherals::dmamux::DmaMux;
use crate::peripherals::exti::Exti;
use crate::peripherals::fdcan::{self, Fdcan};
use crate::peripherals::gpio::Gpio;
use crate::peripherals::iwdg::Iwdg;
use crate::peripherals::spi::{self, Spi};
use crate::peripherals::syscfg::Syscfg;
use crate::peripherals::tim::{self, Timer};
use crate::peripherals::usart::{BusClock, Place, Usart};
use crate::peripherals::{fdcan_maps, flash_g4, pwr_g4, rcc_g4};
use crate::wires::{Gate, Pin};

const AHB1ENR: u32 = 0x48;
const AHB1RSTR: u32 = 0x28;
const AHB2ENR: u32 = 0x4c;
const APB1ENR1: u32 = 0x58;
const APB2ENR: u32 = 0x60;
const AHB2RSTR: u32 = 0x2c;
const APB1RSTR1: u32 = 0x38;
const APB2RSTR: u32 = 0x40;
const RM: &str = "RM0440 7.4";

/// RM0440 2.4: 80 KiB, 16 KiB, and the core-coupled memory, which follows them and also has its own address.
static MEMORIES: [Memory; 2] = [
    Memory { base: 0x1000_0000, size: 0x8000, core_only: true },
    Memory { base: 0x2000_0000, size: 0x2_0000, core_only: false },
];

/// Data sheet of STM32G474, table 13: USART1 to USART3 are function 7.
const USART1: Place = Place {
    number: 1,
    interrupt: 37,
    clock: BusClock::High,
    send: &[(Pin('A', 9), 7), (Pin('B', 6), 7), (Pin('C', 4), 7), (Pin('E', 0), 7), (Pin('G', 9), 7)],
    receive: &[(Pin('A', 10), 7), (Pin('B', 7), 7), (Pin('C', 5), 7), (Pin('E', 1), 7)],
};
/// Data sheet DS12288, table 13: function 9. RM0440 2.2.2 has the message RAM.
const FDCAN1: fdcan::Place = fdcan::Place {
    number: 1,
    map: &fdcan_maps::G4,
    ram: 0x4000_a400,
    interrupt: 21,
    clock: Gate { offset: APB1ENR1, bit: 25 },
    send: &[(Pin('A', 12), 9), (Pin('B', 9), 9), (Pin('D', 1), 9)],
    receive: &[(Pin('A', 11), 9), (Pin('B', 8), 9), (Pin('D', 0), 9)],
};

const USART2: Place = Place {
    number: 2,
    interrupt: 38,
    clock: BusClock::Low,
    send: &[(Pin('A', 2), 7), (Pin('A', 14), 7), (Pin('B', 3), 7), (Pin('D', 5), 7)],
    receive: &[(Pin('A', 3), 7), (Pin('A', 15), 7), (Pin('B', 4), 7), (Pin('D', 6), 7)],
};
const USART3: Place = Place {
    number: 3,
    interrupt: 39,
    clock: BusClock::Low,
    send: &[(Pin('B', 9), 7), (Pin('B', 10), 7), (Pin('C', 10), 7), (Pin('D', 8), 7)],
    receive: &[(Pin('B', 8), 7), (Pin('B', 11), 7), (Pin('C', 11), 7), (Pin('D', 9), 7), (Pin('E', 15), 7)],
};

/// Same data sheet, table 13: SPI2 is function 5.
const SPI2: spi::Place = spi::Place {
    number: 2,
    clock: BusClock::Low,
    pins: [(Pin('B', 12), 5), (Pin('B', 13), 5), (Pin('B', 14), 5), (Pin('B', 15), 5)],
};

/// RM0440 30.8: HSE/32 is input 3 of both timers.
const TIM16: tim::Place = tim::Place { map: &tim::G4, interrupt: 25, selection: (0x5c, 3) };
const TIM17: tim::Place = tim::Place { interrupt: 26, ..TIM16 };

/// Peripherals that differ between the chips of RM0440.
pub(super) struct Parts {
    pub rcc: rcc_g4::Rcc,
    pub flash: flash_g4::Flash,
    pub dbgmcu: Dbgmcu,
    pub dma: DmaChannels,
    pub dmamux: DmaMux,
}

/// Chip with an image that ends at an address.
pub fn chip(image_end: u32) -> Chip {
    let peripherals = peripherals(Parts {
        rcc: rcc_g4::Rcc::category_3(),
        flash: flash_g4::Flash::category_3(image_end),
        dbgmcu: Dbgmcu::g474(),
        dma: DmaChannels::new(1, 8),
        dmamux: DmaMux::new(8),
    });
    Chip {
        name: "stm32g474",
        is_m7: false,
        flash: 0x8_0000,
        memories: &MEMORIES,
        peripherals,
        after_reset: rcc_g4::AFTER_RESET,
        reset_flags: rcc_g4::flags,
    }
}

/// Peripherals common to all chips of RM0440.
pub(super) fn peripherals(Parts { rcc, flash, dbgmcu, dma, dmamux }: Parts) -> Vec<Placed> {
    let mut peripherals = vec![
        always("RCC", 0x4002_1000, Box::new(rcc)),
        always("FLASH", 0x4002_2000, Box::new(flash)),
        always("IWDG", 0x4000_3000, Box::new(Iwdg::new(true))),
        always("EXTI", 0x4001_0400, Box::new(Exti::g4())),
        always("DBGMCU", 0xe004_2000, Box::new(dbgmcu)),
        gated(RM, "PWR", 0x4000_7000, (APB1ENR1, 28), Some((APB1RSTR1, 28)), Box::new(pwr_g4::Pwr::default())),
        gated(RM, "SYSCFG", 0x4001_0000, (APB2ENR, 0), Some((APB2RSTR, 0)), Box::new(Syscfg::g4())),
        gated(RM, "USART1", 0x4001_3800, (APB2ENR, 14), Some((APB2RSTR, 14)), Box::new(Usart::new(USART1, 8))),
        gated(RM, "USART2", 0x4000_4400, (APB1ENR1, 17), Some((APB1RSTR1, 17)), Box::new(Usart::new(USART2, 8))),
        gated(RM, "USART3", 0x4000_4800, (APB1ENR1, 18), Some((APB1RSTR1, 18)), Box::new(Usart::new(USART3, 8))),
        gated(RM, "FDCAN1", 0x4000_6400, (APB1ENR1, 25), Some((APB1RSTR1, 25)), Box::new(Fdcan::new(FDCAN1))),
        gated(RM, "TIM16", 0x4001_4400, (APB2ENR, 17), Some((APB2RSTR, 17)), Box::new(Timer::new(TIM16))),
        gated(RM, "TIM17", 0x4001_4800, (APB2ENR, 18), Some((APB2RSTR, 18)), Box::new(Timer::new(TIM17))),
        gated(RM, "DMA1", 0x4002_0000, (AHB1ENR, 0), Some((AHB1RSTR, 0)), Box::new(dma)),
        gated(RM, "DMAMUX", 0x4002_0800, (AHB1ENR, 2), Some((AHB1RSTR, 2)), Box::new(dmamux)),
        gated(RM, "SPI2", 0x4000_3800, (APB1ENR1, 14), Some((APB1RSTR1, 14)), Box::new(Spi::new(SPI2))),
    ];
    let names = ["GPIOA", "GPIOB", "GPIOC", "GPIOD", "GPIOE", "GPIOF", "GPIOG"];
    peripherals.extend(ports(RM, 0x4800_0000, [AHB2ENR, AHB2RSTR], &names, |port| Gpio::newer(port, true)));
    peripherals
}

//! STM32H743: RM0433, memory map in its table 8, interrupts in its table 149.

use super::{always, gated, ports};
use crate::machine::{Chip, Memory};
use crate::peripherals::dbgmcu::Dbgmcu;
use crate::peripherals::fdcan::{self, Fdcan};
use crate::peripherals::fdcan_ccu::Calibration;
use crate::peripherals::gpio::Gpio;
use crate::peripherals::iwdg::Iwdg;
use crate::peripherals::tim::{self, Timer};
use crate::peripherals::usart::{BusClock, Place, Usart};
use crate::peripherals::{fdcan_maps, flash_h7, pwr_h7, rcc_h7};
use crate::wires::{Gate, Pin};

const AHB4ENR: u32 = 0xe0;
const APB1LENR: u32 = 0xe8;
const APB1HENR: u32 = 0xec;
const APB2ENR: u32 = 0xf0;
const AHB4RSTR: u32 = 0x88;
const APB1LRSTR: u32 = 0x90;
const APB1HRSTR: u32 = 0x94;
const APB2RSTR: u32 = 0x98;
const RM: &str = "RM0433 8.7";

/// RM0433 2.4: instruction and data memory of the core, then the memory of each domain.
static MEMORIES: [Memory; 5] = [
    Memory { base: 0x0000_0000, size: 0x1_0000, core_only: true },
    Memory { base: 0x2000_0000, size: 0x2_0000, core_only: true },
    Memory { base: 0x2400_0000, size: 0x8_0000, core_only: false },
    Memory { base: 0x3000_0000, size: 0x4_8000, core_only: false },
    Memory { base: 0x3800_0000, size: 0x1_0000, core_only: false },
];

/// Data sheet of STM32H743, table 9: USART3 is function 7.
const USART3: Place = Place {
    number: 3,
    interrupt: 39,
    clock: BusClock::Low,
    send: &[(Pin('B', 10), 7), (Pin('C', 10), 7), (Pin('D', 8), 7)],
    receive: &[(Pin('B', 11), 7), (Pin('C', 11), 7), (Pin('D', 9), 7)],
};

/// Same data sheet, table 9 on: function 9. RM0433 table 8 has the message RAM, which FDCAN2 shares.
const FDCAN1: fdcan::Place = fdcan::Place {
    number: 1,
    map: &fdcan_maps::H7,
    ram: 0x4000_ac00,
    interrupt: 19,
    clock: Gate { offset: APB1HENR, bit: 8 },
    send: &[(Pin('A', 12), 9), (Pin('B', 9), 9), (Pin('D', 1), 9), (Pin('H', 13), 9)],
    receive: &[(Pin('A', 11), 9), (Pin('B', 8), 9), (Pin('D', 0), 9), (Pin('H', 14), 9), (Pin('I', 9), 9)],
};

/// RM0433 41.6: HSE_1MHz is input 2.
const TIM17: tim::Place = tim::Place { map: &tim::H7, interrupt: 118, selection: (0x68, 2) };

/// Chip with an image that ends at an address.
pub fn chip(image_end: u32) -> Chip {
    let mut peripherals = vec![
        always("RCC", 0x5802_4400, Box::new(rcc_h7::Rcc::default())),
        always("PWR", 0x5802_4800, Box::new(pwr_h7::Pwr::default())),
        always("FLASH", 0x5200_2000, Box::new(flash_h7::Flash::new(image_end))),
        always("IWDG1", 0x5800_4800, Box::new(Iwdg::new(true))),
        always("DBGMCU", 0x5c00_1000, Box::new(Dbgmcu::h743())),
        gated(RM, "FDCAN1", 0x4000_a000, (APB1HENR, 8), Some((APB1HRSTR, 8)), Box::new(Fdcan::new(FDCAN1))),
        gated(RM, "CAN_CCU", 0x4000_a800, (APB1HENR, 8), Some((APB1HRSTR, 8)), Box::new(Calibration::default())),
        gated(RM, "TIM17", 0x4001_4800, (APB2ENR, 18), Some((APB2RSTR, 18)), Box::new(Timer::new(TIM17))),
        gated(RM, "USART3", 0x4000_4800, (APB1LENR, 18), Some((APB1LRSTR, 18)), Box::new(Usart::new(USART3, 16))),
    ];
    let names = ["GPIOA", "GPIOB", "GPIOC", "GPIOD", "GPIOE", "GPIOF", "GPIOG", "GPIOH", "GPIOI", "GPIOJ", "GPIOK"];
    peripherals.extend(ports(RM, 0x5802_0000, [AHB4ENR, AHB4RSTR], &names, |port| Gpio::newer(port, false)));
    Chip {
        name: "stm32h743",
        is_m7: true,
        flash: 0x20_0000,
        memories: &MEMORIES,
        peripherals,
        after_reset: rcc_h7::AFTER_RESET,
        reset_flags: rcc_h7::flags,
    }
}

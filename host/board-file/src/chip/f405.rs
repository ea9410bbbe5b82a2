//! STM32F405: data sheet DS8626 (pins and their functions, oscillators, PLL), reference manual RM0090 (sectors of the flash, clock tree).

use model_core::gears::design::Processor;

use super::facts::{ALL, CanUnit, Facts, ImageSize, Package, SerialUnit, Slot, SpiUnit, TimerUnit, Variant, at, pin};
use crate::pll::PllLimits;

const APB1: u32 = 42_000_000;
const APB2: u32 = 84_000_000;

pub(super) const FACTS: Facts = Facts {
    name: "stm32f405",
    family: "stm32f4",
    core_rate: 168_000_000,
    processor: Processor::STM32F405,
    internal_oscillator: 16_000_000,
    crystal: (4_000_000, 26_000_000),
    signal: (1_000_000, 50_000_000),
    oscillator_pins: [pin("PH0"), pin("PH1")],
    pll: PllLimits {
        input: (1_000_000, 2_000_000),
        preferred_input: 2_000_000,
        oscillator: 336_000_000,
        divider: (2, 63),
        factor: (50, 432),
        ranges: &[],
    },
    boot_pin: None,
    serial: SERIAL,
    unsupported_serial: &[],
    spi: Ok(SPI),
    can: CAN,
    timers: TIMERS,
    // SRAM1 and SRAM2; the 64 KiB of CCM lie elsewhere.
    ram_kib: 128,
    slots,
    images: &[
        ImageSize { role: "plant", flash: 127_112, ram: 10_780 },
        ImageSize { role: "observer", flash: 173_072, ram: 26_412 },
        ImageSize { role: "loop", flash: 216_532, ram: 24_596 },
        ImageSize { role: "spi-observer", flash: 110_436, ram: 3_300 },
        // ODrive 3.6.
        ImageSize { role: "drive", flash: 110_024, ram: 5_312 },
    ],
    variants: &[
        Variant { name: "STM32F405RG", flash_kib: &[512, 1024], packages: &[Package { letter: 'T', pins: LQFP64 }] },
        Variant { name: "STM32F405VG", flash_kib: &[512, 1024], packages: &[Package { letter: 'T', pins: LQFP100 }] },
        Variant { name: "STM32F405ZG", flash_kib: &[512, 1024], packages: &[Package { letter: 'T', pins: LQFP144 }] },
        Variant { name: "STM32F405OG", flash_kib: &[512, 1024], packages: &[Package { letter: 'Y', pins: WLCSP90 }] },
        Variant { name: "STM32F405OE", flash_kib: &[512], packages: &[Package { letter: 'Y', pins: WLCSP90 }] },
    ],
};

/// Slots: the last two sectors of 128 KiB.
fn slots(flash: u32) -> [Slot; 2] {
    const SECTOR: u32 = 128 << 10;
    [2, 1].map(|from_end| Slot { address: 0x0800_0000 + flash - from_end * SECTOR, bytes: SECTOR })
}

const SERIAL: &[SerialUnit] = &[
    SerialUnit {
        name: "USART1",
        clock: APB2,
        send: &[at("PA9", 7), at("PB6", 7)],
        receive: &[at("PA10", 7), at("PB7", 7)],
    },
    SerialUnit {
        name: "USART2",
        clock: APB1,
        send: &[at("PA2", 7), at("PD5", 7)],
        receive: &[at("PA3", 7), at("PD6", 7)],
    },
    SerialUnit {
        name: "USART3",
        clock: APB1,
        send: &[at("PB10", 7), at("PC10", 7), at("PD8", 7)],
        receive: &[at("PB11", 7), at("PC11", 7), at("PD9", 7)],
    },
    SerialUnit {
        name: "UART4",
        clock: APB1,
        send: &[at("PA0", 8), at("PC10", 8)],
        receive: &[at("PA1", 8), at("PC11", 8)],
    },
    SerialUnit { name: "UART5", clock: APB1, send: &[at("PC12", 8)], receive: &[at("PD2", 8)] },
    SerialUnit {
        name: "USART6",
        clock: APB2,
        send: &[at("PC6", 8), at("PG14", 8)],
        receive: &[at("PC7", 8), at("PG9", 8)],
    },
];

const SPI: &[SpiUnit] = &[
    SpiUnit {
        name: "SPI1",
        select: &[at("PA4", 5), at("PA15", 5)],
        clock: &[at("PA5", 5), at("PB3", 5)],
        out: &[at("PA6", 5), at("PB4", 5)],
        input: &[at("PA7", 5), at("PB5", 5)],
    },
    SpiUnit {
        name: "SPI2",
        select: &[at("PB12", 5), at("PB9", 5), at("PI0", 5)],
        clock: &[at("PB13", 5), at("PB10", 5), at("PI1", 5)],
        out: &[at("PB14", 5), at("PC2", 5)],
        input: &[at("PB15", 5), at("PC3", 5)],
    },
    SpiUnit {
        name: "SPI3",
        select: &[at("PA4", 6), at("PA15", 6)],
        clock: &[at("PB3", 6), at("PC10", 6)],
        out: &[at("PB4", 6), at("PC11", 6)],
        input: &[at("PB5", 6), at("PC12", 6)],
    },
];

/// Data sheet DS8626, table 9.
const CAN: &[CanUnit] = &[
    CanUnit::classic(
        "CAN1",
        APB1,
        &[at("PA12", 9), at("PB9", 9), at("PD1", 9)],
        &[at("PA11", 9), at("PB8", 9), at("PD0", 9)],
    ),
    CanUnit::classic("CAN2", APB1, &[at("PB6", 9), at("PB13", 9)], &[at("PB5", 9), at("PB12", 9)]),
];

const TIMERS: &[TimerUnit] = &[
    TimerUnit { name: "TIM1", a: &[pin("PA8"), pin("PE9")], b: &[pin("PA9"), pin("PE11")] },
    TimerUnit { name: "TIM2", a: &[pin("PA0"), pin("PA5"), pin("PA15")], b: &[pin("PA1"), pin("PB3")] },
    TimerUnit { name: "TIM3", a: &[pin("PA6"), pin("PB4"), pin("PC6")], b: &[pin("PA7"), pin("PB5"), pin("PC7")] },
    TimerUnit { name: "TIM4", a: &[pin("PB6"), pin("PD12")], b: &[pin("PB7"), pin("PD13")] },
    TimerUnit { name: "TIM5", a: &[pin("PA0")], b: &[pin("PA1")] },
    TimerUnit { name: "TIM8", a: &[pin("PC6")], b: &[pin("PC7")] },
];

const LQFP64: &[(char, u16)] = &[('A', ALL), ('B', ALL), ('C', ALL), ('D', 1 << 2), ('H', 0b11)];
const LQFP100: &[(char, u16)] = &[('A', ALL), ('B', ALL), ('C', ALL), ('D', ALL), ('E', ALL), ('H', 0b11)];
const LQFP144: &[(char, u16)] =
    &[('A', ALL), ('B', ALL), ('C', ALL), ('D', ALL), ('E', ALL), ('F', ALL), ('G', ALL), ('H', 0b11)];
/// All pins but PC1, PC4, PC5, PD3, PD13 and PE0 to PE6.
const WLCSP90: &[(char, u16)] =
    &[('A', ALL), ('B', ALL), ('C', !0x0032), ('D', !0x2008), ('E', 0xff80), ('H', 0b11), ('I', 0b11)];

//! STM32H743 with 2 MiB of flash: data sheet DS12110 (pins and their functions, oscillators, PLL), reference manual RM0433
//! (sectors of the flash, clock tree at voltage scale 1).

use model_core::gears::design::Processor;

use super::facts::{ALL, CanUnit, Facts, ImageSize, Package, SerialUnit, Slot, TimerUnit, Variant, at, pin};
use crate::pll::PllLimits;

/// Clock of both buses with USARTs: a quarter of the core clock [Hz].
const APB: u32 = 100_000_000;

pub(super) const FACTS: Facts = Facts {
    name: "stm32h743",
    family: "stm32h7",
    core_rate: 400_000_000,
    processor: Processor::STM32H743,
    internal_oscillator: 64_000_000,
    crystal: (4_000_000, 48_000_000),
    signal: (4_000_000, 50_000_000),
    oscillator_pins: [pin("PH0"), pin("PH1")],
    pll: PllLimits {
        // Wide oscillator range, 192 to 836 MHz.
        input: (2_000_000, 16_000_000),
        preferred_input: 4_000_000,
        oscillator: 800_000_000,
        divider: (1, 63),
        factor: (4, 512),
        ranges: &[2_000_000, 4_000_000, 8_000_000],
    },
    boot_pin: None,
    serial: SERIAL,
    unsupported_serial: &[("LPUART1", "its registers and clock divider differ from a USART's")],
    spi: Err("the firmware has no slave for the STM32H743's kind of SPI"),
    can: CAN,
    timers: TIMERS,
    // DTCM.
    ram_kib: 128,
    slots,
    images: &[
        ImageSize { role: "plant", flash: 132_064, ram: 10_508 },
        ImageSize { role: "observer", flash: 177_952, ram: 26_140 },
        ImageSize { role: "loop", flash: 221_304, ram: 24_324 },
        // moteus.
        ImageSize { role: "drive", flash: 116_180, ram: 5_268 },
    ],
    variants: &[
        Variant { name: "STM32H743ZI", flash_kib: &[2048], packages: &[Package { letter: 'T', pins: LQFP144 }] },
        Variant {
            name: "STM32H743VI",
            flash_kib: &[2048],
            packages: &[Package { letter: 'T', pins: PINS_100 }, Package { letter: 'H', pins: PINS_100 }],
        },
        Variant { name: "STM32H743AI", flash_kib: &[2048], packages: &[Package { letter: 'I', pins: UFBGA169 }] },
        Variant {
            name: "STM32H743II",
            flash_kib: &[2048],
            packages: &[Package { letter: 'T', pins: PINS_176 }, Package { letter: 'K', pins: PINS_176 }],
        },
        Variant { name: "STM32H743BI", flash_kib: &[2048], packages: &[Package { letter: 'T', pins: ALL_PORTS }] },
        Variant { name: "STM32H743XI", flash_kib: &[2048], packages: &[Package { letter: 'H', pins: ALL_PORTS }] },
    ],
};

/// Slots: the first two sectors of the second bank. An image lies in the first bank, which can execute while they are
/// erased.
fn slots(_: u32) -> [Slot; 2] {
    const SECTOR: u32 = 128 << 10;
    [0, 1].map(|sector| Slot { address: 0x0810_0000 + sector * SECTOR, bytes: SECTOR })
}

const SERIAL: &[SerialUnit] = &[
    SerialUnit {
        name: "USART1",
        clock: APB,
        send: &[at("PA9", 7), at("PB6", 7), at("PB14", 4)],
        receive: &[at("PA10", 7), at("PB7", 7), at("PB15", 4)],
    },
    SerialUnit {
        name: "USART2",
        clock: APB,
        send: &[at("PA2", 7), at("PD5", 7)],
        receive: &[at("PA3", 7), at("PD6", 7)],
    },
    SerialUnit {
        name: "USART3",
        clock: APB,
        send: &[at("PB10", 7), at("PC10", 7), at("PD8", 7)],
        receive: &[at("PB11", 7), at("PC11", 7), at("PD9", 7)],
    },
    SerialUnit {
        name: "UART4",
        clock: APB,
        send: &[at("PA0", 8), at("PA12", 6), at("PB9", 8), at("PC10", 8), at("PD1", 8), at("PH13", 8)],
        receive: &[at("PA1", 8), at("PA11", 6), at("PB8", 8), at("PC11", 8), at("PD0", 8), at("PH14", 8), at("PI9", 8)],
    },
    SerialUnit {
        name: "UART5",
        clock: APB,
        send: &[at("PC12", 8), at("PB6", 14), at("PB13", 14)],
        receive: &[at("PD2", 8), at("PB5", 14), at("PB12", 14)],
    },
    SerialUnit {
        name: "USART6",
        clock: APB,
        send: &[at("PC6", 7), at("PG14", 7)],
        receive: &[at("PC7", 7), at("PG9", 7)],
    },
    SerialUnit {
        name: "UART7",
        clock: APB,
        send: &[at("PE8", 7), at("PF7", 7), at("PA15", 11), at("PB4", 11)],
        receive: &[at("PE7", 7), at("PF6", 7), at("PA8", 11), at("PB3", 11)],
    },
    SerialUnit {
        name: "UART8",
        clock: APB,
        send: &[at("PE1", 8), at("PJ8", 8)],
        receive: &[at("PE0", 8), at("PJ9", 8)],
    },
];

/// Clock of the FDCAN: output Q of the first PLL, a tenth of its oscillator's 800 MHz [Hz].
const FDCAN: u32 = 80_000_000;

/// Data sheet DS12110, table 9 on.
const CAN: &[CanUnit] = &[
    CanUnit::flexible(
        "FDCAN1",
        FDCAN,
        &[at("PA12", 9), at("PB9", 9), at("PD1", 9), at("PH13", 9)],
        &[at("PA11", 9), at("PB8", 9), at("PD0", 9), at("PH14", 9), at("PI9", 9)],
    ),
    CanUnit::flexible("FDCAN2", FDCAN, &[at("PB6", 9), at("PB13", 9)], &[at("PB5", 9), at("PB12", 9)]),
];

const TIMERS: &[TimerUnit] = &[
    TimerUnit { name: "TIM1", a: &[pin("PA8"), pin("PE9"), pin("PK1")], b: &[pin("PA9"), pin("PE11"), pin("PJ11")] },
    TimerUnit { name: "TIM2", a: &[pin("PA0"), pin("PA5"), pin("PA15")], b: &[pin("PA1"), pin("PB3")] },
    TimerUnit { name: "TIM3", a: &[pin("PA6"), pin("PB4"), pin("PC6")], b: &[pin("PA7"), pin("PB5"), pin("PC7")] },
    TimerUnit { name: "TIM4", a: &[pin("PB6"), pin("PD12")], b: &[pin("PB7"), pin("PD13")] },
    TimerUnit { name: "TIM5", a: &[pin("PA0"), pin("PH10")], b: &[pin("PA1"), pin("PH11")] },
    TimerUnit {
        name: "TIM8",
        a: &[pin("PC6"), pin("PI5"), pin("PJ8")],
        b: &[pin("PC7"), pin("PI6"), pin("PJ6"), pin("PJ10")],
    },
];

const PINS_100: &[(char, u16)] = &[('A', ALL), ('B', ALL), ('C', ALL), ('D', ALL), ('E', ALL), ('H', 0b11)];
const LQFP144: &[(char, u16)] =
    &[('A', ALL), ('B', ALL), ('C', ALL), ('D', ALL), ('E', ALL), ('F', ALL), ('G', ALL), ('H', 0b11)];
const UFBGA169: &[(char, u16)] = &[
    ('A', ALL),
    ('B', ALL),
    ('C', ALL),
    ('D', ALL),
    ('E', ALL),
    ('F', ALL),
    ('G', ALL),
    ('H', 0x1c3f),
    ('I', 0x38cf),
    ('J', 0b11),
];
const PINS_176: &[(char, u16)] =
    &[('A', ALL), ('B', ALL), ('C', ALL), ('D', ALL), ('E', ALL), ('F', ALL), ('G', ALL), ('H', ALL), ('I', 0x0fff)];
const ALL_PORTS: &[(char, u16)] = &[
    ('A', ALL),
    ('B', ALL),
    ('C', ALL),
    ('D', ALL),
    ('E', ALL),
    ('F', ALL),
    ('G', ALL),
    ('H', ALL),
    ('I', ALL),
    ('J', ALL),
    ('K', 0x00ff),
];

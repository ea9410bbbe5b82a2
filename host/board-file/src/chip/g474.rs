//! STM32G474 with 512 KiB of flash: data sheet DS12288 (pins and their functions, oscillators, PLL),
//! reference manual RM0440 (pages of the flash, clock tree).

use model_core::gears::design::Processor;

use super::facts::{ALL, CanUnit, Facts, ImageSize, Package, SerialUnit, Slot, SpiUnit, TimerUnit, Variant, at, pin};
use crate::pll::PllLimits;

/// Clock of all buses, equal to the core clock [Hz].
pub(super) const BUSES: u32 = 170_000_000;

pub(super) const FACTS: Facts = Facts {
    name: "stm32g474",
    family: "stm32g4",
    core_rate: 170_000_000,
    processor: Processor::STM32G474,
    internal_oscillator: 16_000_000,
    crystal: (4_000_000, 48_000_000),
    signal: (4_000_000, 48_000_000),
    oscillator_pins: [pin("PF0"), pin("PF1")],
    pll: PLL,
    boot_pin: Some(pin("PB8")),
    serial: &[USART1, USART2, USART3, UART4, UART5],
    unsupported_serial: &[LPUART1],
    spi: Ok(SPI),
    can: CAN,
    timers: TIMERS,
    // SRAM1 and SRAM2; the 32 KiB of CCM that follow are for code.
    ram_kib: 96,
    slots,
    images: &IMAGES,
    variants: &[
        Variant { name: "STM32G474RE", flash_kib: &[512], packages: &[Package { letter: 'T', pins: PINS_64 }] },
        Variant {
            name: "STM32G474CE",
            flash_kib: &[512],
            packages: &[Package { letter: 'T', pins: LQFP48 }, Package { letter: 'U', pins: UFQFPN48 }],
        },
        Variant {
            name: "STM32G474ME",
            flash_kib: &[512],
            packages: &[Package { letter: 'T', pins: PINS_80 }, Package { letter: 'Y', pins: WLCSP81 }],
        },
        Variant {
            name: "STM32G474VE",
            flash_kib: &[512],
            packages: &[Package { letter: 'T', pins: PINS_100 }, Package { letter: 'H', pins: PINS_100 }],
        },
        Variant { name: "STM32G474PE", flash_kib: &[512], packages: &[Package { letter: 'I', pins: TFBGA121 }] },
        Variant { name: "STM32G474QE", flash_kib: &[512], packages: &[Package { letter: 'T', pins: LQFP128 }] },
    ],
};

pub(super) const PLL: PllLimits = PllLimits {
    input: (2_660_000, 16_000_000),
    preferred_input: 4_000_000,
    oscillator: 340_000_000,
    divider: (1, 16),
    factor: (8, 127),
    ranges: &[],
};

pub(super) const IMAGES: [ImageSize; 5] = [
    ImageSize { role: "plant", flash: 127_180, ram: 10_532 },
    ImageSize { role: "observer", flash: 173_192, ram: 26_164 },
    ImageSize { role: "loop", flash: 216_292, ram: 24_348 },
    ImageSize { role: "spi-observer", flash: 111_464, ram: 3_300 },
    // moteus.
    ImageSize { role: "drive", flash: 114_296, ram: 5_240 },
];

/// Slots: the last two pages of 4 KiB of the single-bank layout. In the dual-bank layout each is two pages of 2 KiB, of
/// which the first is used, so that the addresses do not depend on the option bytes.
fn slots(flash: u32) -> [Slot; 2] {
    [2, 1].map(|from_end| Slot { address: 0x0800_0000 + flash - from_end * (4 << 10), bytes: 2 << 10 })
}

pub(super) const USART1: SerialUnit = SerialUnit {
    name: "USART1",
    clock: BUSES,
    send: &[at("PA9", 7), at("PB6", 7), at("PC4", 7), at("PE0", 7), at("PG9", 7)],
    receive: &[at("PA10", 7), at("PB7", 7), at("PC5", 7), at("PE1", 7)],
};
pub(super) const USART2: SerialUnit = SerialUnit {
    name: "USART2",
    clock: BUSES,
    send: &[at("PA2", 7), at("PA14", 7), at("PB3", 7), at("PD5", 7)],
    receive: &[at("PA3", 7), at("PA15", 7), at("PB4", 7), at("PD6", 7)],
};
pub(super) const USART3: SerialUnit = SerialUnit {
    name: "USART3",
    clock: BUSES,
    send: &[at("PB9", 7), at("PB10", 7), at("PC10", 7), at("PD8", 7)],
    receive: &[at("PB8", 7), at("PB11", 7), at("PC11", 7), at("PD9", 7), at("PE15", 7)],
};
pub(super) const UART4: SerialUnit =
    SerialUnit { name: "UART4", clock: BUSES, send: &[at("PC10", 5)], receive: &[at("PC11", 5)] };
const UART5: SerialUnit = SerialUnit { name: "UART5", clock: BUSES, send: &[at("PC12", 5)], receive: &[at("PD2", 5)] };

/// Serial peripheral of another kind, which is not supported.
pub(super) const LPUART1: (&str, &str) = ("LPUART1", "its registers and clock divider differ from a USART's");

pub(super) const SPI: &[SpiUnit] = &[
    SpiUnit {
        name: "SPI1",
        select: &[at("PA4", 5), at("PA15", 5), at("PG5", 5)],
        clock: &[at("PA5", 5), at("PB3", 5), at("PG2", 5)],
        out: &[at("PA6", 5), at("PB4", 5), at("PG3", 5)],
        input: &[at("PA7", 5), at("PB5", 5), at("PG4", 5)],
    },
    SpiUnit {
        name: "SPI2",
        select: &[at("PB12", 5), at("PD15", 6), at("PF0", 5)],
        clock: &[at("PB13", 5), at("PF1", 5), at("PF9", 5), at("PF10", 5)],
        out: &[at("PB14", 5), at("PA10", 5)],
        input: &[at("PB15", 5), at("PA11", 5)],
    },
    SpiUnit {
        name: "SPI3",
        select: &[at("PA4", 6), at("PA15", 6)],
        clock: &[at("PB3", 6), at("PC10", 6), at("PG9", 6)],
        out: &[at("PB4", 6), at("PC11", 6)],
        input: &[at("PB5", 6), at("PC12", 6)],
    },
];

/// Data sheet DS12288, table 13. The clock of the FDCAN is that of the bus (RM0440 7.4.27).
pub(super) const FDCAN1: CanUnit = CanUnit::flexible(
    "FDCAN1",
    BUSES,
    &[at("PA12", 9), at("PB9", 9), at("PD1", 9)],
    &[at("PA11", 9), at("PB8", 9), at("PD0", 9)],
);
const CAN: &[CanUnit] = &[
    FDCAN1,
    CanUnit::flexible("FDCAN2", BUSES, &[at("PB6", 9), at("PB13", 9)], &[at("PB5", 9), at("PB12", 9)]),
    CanUnit::flexible("FDCAN3", BUSES, &[at("PA15", 11), at("PB4", 11)], &[at("PA8", 11), at("PB3", 11)]),
];

/// Timers common to all chips of RM0440. TIM5 of the STM32G474 is left out.
pub(super) const TIMERS: &[TimerUnit] = &[
    TimerUnit { name: "TIM1", a: &[pin("PA8"), pin("PC0"), pin("PE9")], b: &[pin("PA9"), pin("PC1"), pin("PE11")] },
    TimerUnit {
        name: "TIM2",
        a: &[pin("PA0"), pin("PA5"), pin("PA15"), pin("PD3")],
        b: &[pin("PA1"), pin("PB3"), pin("PD4")],
    },
    TimerUnit {
        name: "TIM3",
        a: &[pin("PA6"), pin("PB4"), pin("PC6"), pin("PE2")],
        b: &[pin("PA4"), pin("PA7"), pin("PB5"), pin("PC7"), pin("PE3")],
    },
    TimerUnit { name: "TIM4", a: &[pin("PA11"), pin("PB6"), pin("PD12")], b: &[pin("PA12"), pin("PB7"), pin("PD13")] },
    TimerUnit { name: "TIM8", a: &[pin("PA15"), pin("PB6"), pin("PC6")], b: &[pin("PB8"), pin("PC7")] },
];

// PG10 is the reset input of all packages.
pub(super) const LQFP48: &[(char, u16)] = &[('A', ALL), ('B', ALL), ('C', 0xe000), ('F', 0b11)];
/// LQFP48 with PC4, PC6, PC10 and PC11 in addition.
pub(super) const UFQFPN48: &[(char, u16)] = &[('A', ALL), ('B', ALL), ('C', 0xec50), ('F', 0b11)];
pub(super) const PINS_64: &[(char, u16)] = &[('A', ALL), ('B', ALL), ('C', ALL), ('D', 1 << 2), ('F', 0b11)];
pub(super) const PINS_80: &[(char, u16)] =
    &[('A', ALL), ('B', ALL), ('C', ALL), ('D', 0x0707), ('E', 0xff80), ('F', 0b11)];
const WLCSP81: &[(char, u16)] = &[('A', ALL), ('B', ALL), ('C', ALL), ('D', 0x0f07), ('E', 0xff80), ('F', 0b11)];
pub(super) const PINS_100: &[(char, u16)] =
    &[('A', ALL), ('B', ALL), ('C', ALL), ('D', ALL), ('E', ALL), ('F', 0x0607)];
const TFBGA121: &[(char, u16)] =
    &[('A', ALL), ('B', ALL), ('C', ALL), ('D', ALL), ('E', ALL), ('F', ALL), ('G', 0x001f)];
const LQFP128: &[(char, u16)] =
    &[('A', ALL), ('B', ALL), ('C', ALL), ('D', ALL), ('E', ALL), ('F', ALL), ('G', 0x03ff)];

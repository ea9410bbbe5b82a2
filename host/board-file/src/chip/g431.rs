//! STM32G431 with 128 KiB of flash: data sheet DS12589 (pins and their functions, oscillators, PLL), reference manual
//! RM0440 (pages of the flash, clock tree). Data shared with the STM32G474 are in `g474`.

use model_core::gears::design::Processor;

use super::facts::{ALL, Facts, ImageSize, Package, Slot, Variant, pin};
use super::g474;

pub(super) const FACTS: Facts = Facts {
    name: "stm32g431",
    family: "stm32g4",
    core_rate: 170_000_000,
    processor: Processor::STM32G474,
    internal_oscillator: 16_000_000,
    crystal: (4_000_000, 48_000_000),
    signal: (4_000_000, 48_000_000),
    oscillator_pins: [pin("PF0"), pin("PF1")],
    pll: g474::PLL,
    boot_pin: Some(pin("PB8")),
    serial: &[g474::USART1, g474::USART2, g474::USART3, g474::UART4],
    unsupported_serial: &[g474::LPUART1],
    spi: Ok(g474::SPI),
    can: &[g474::FDCAN1],
    timers: g474::TIMERS,
    // SRAM1 and SRAM2; the 10 KiB of CCM that follow are for code.
    ram_kib: 22,
    slots,
    // Plant and drive (ODrive 3.6) are linked with less inlining. The others were linked for the STM32G474 only; with
    // less inlining they need less flash.
    images: &[
        ImageSize { role: "plant", flash: 123_636, ram: 10_532 },
        g474::IMAGES[1],
        g474::IMAGES[2],
        g474::IMAGES[3],
        ImageSize { role: "drive", flash: 108_012, ram: 5_312 },
    ],
    variants: &[
        Variant {
            name: "STM32G431KB",
            flash_kib: &[128],
            packages: &[Package { letter: 'T', pins: PINS_32 }, Package { letter: 'U', pins: PINS_32 }],
        },
        Variant {
            name: "STM32G431CB",
            flash_kib: &[128],
            packages: &[
                Package { letter: 'T', pins: g474::LQFP48 },
                Package { letter: 'U', pins: g474::UFQFPN48 },
                Package { letter: 'Y', pins: WLCSP49 },
            ],
        },
        Variant {
            name: "STM32G431RB",
            flash_kib: &[128],
            packages: &[Package { letter: 'T', pins: g474::PINS_64 }, Package { letter: 'I', pins: g474::PINS_64 }],
        },
        Variant { name: "STM32G431MB", flash_kib: &[128], packages: &[Package { letter: 'T', pins: g474::PINS_80 }] },
        Variant { name: "STM32G431VB", flash_kib: &[128], packages: &[Package { letter: 'T', pins: g474::PINS_100 }] },
    ],
};

/// Slots: the last two pages of 2 KiB.
fn slots(flash: u32) -> [Slot; 2] {
    const PAGE: u32 = 2 << 10;
    [2, 1].map(|from_end| Slot { address: 0x0800_0000 + flash - from_end * PAGE, bytes: PAGE })
}

const PINS_32: &[(char, u16)] = &[('A', ALL), ('B', 0x01f9), ('F', 0b11)];
/// UFQFPN48 without PC10.
const WLCSP49: &[(char, u16)] = &[('A', ALL), ('B', ALL), ('C', 0xe850), ('F', 0b11)];

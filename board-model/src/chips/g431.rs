//! STM32G431 with 128 KiB of flash: RM0440, as a chip of category 2. Parts shared with the STM32G474 are in `g474`.

use super::g474::{Parts, peripherals};
use crate::machine::{Chip, Memory};
use crate::peripherals::dbgmcu::Dbgmcu;
use crate::peripherals::dma_channel::DmaChannels;
use crate::peripherals::dmamux::DmaMux;
use crate::peripherals::{flash_g4, rcc_g4};

/// RM0440 2.4: 16 KiB, 6 KiB, and the core-coupled memory, which follows them and also has its own address.
static MEMORIES: [Memory; 2] = [
    Memory { base: 0x1000_0000, size: 0x2800, core_only: true },
    Memory { base: 0x2000_0000, size: 0x8000, core_only: false },
];

/// Chip with an image that ends at an address.
pub fn chip(image_end: u32) -> Chip {
    let peripherals = peripherals(Parts {
        rcc: rcc_g4::Rcc::category_2(),
        flash: flash_g4::Flash::category_2(image_end),
        dbgmcu: Dbgmcu::g431(),
        dma: DmaChannels::new(1, 6),
        dmamux: DmaMux::new(6),
    });
    Chip {
        name: "stm32g431",
        is_m7: false,
        flash: 0x2_0000,
        memories: &MEMORIES,
        peripherals,
        after_reset: rcc_g4::AFTER_RESET,
        reset_flags: rcc_g4::flags,
    }
}

//! More than thirty mistakes that a port to these chips can make, planted one by one into the writes of the images that
//! ship. Each must make its check fail: this tests the model itself.

use board::device::board::Chip;
use board::device::board::Chip::{Stm32f405, Stm32g431, Stm32g474, Stm32h743};

use crate::checks::{Check, boot, bootloader, can, load, memory, outputs, pins, spi};
use crate::images::Work;
use crate::images::Work::{Drive, Observer, Plant, SpiSlave};
use crate::tamper::How::{Clear, Field, Omit, OmitValue, Set, Swap};
use crate::tamper::{How, Tamper};

/// Planted mistake.
pub struct Mistake {
    /// Description.
    pub what: &'static str,
    /// Chip of the board.
    pub chip: Chip,
    /// Image.
    pub work: Work,
    /// Check that must find it.
    pub check: Check,
    /// Changes to the image's writes.
    pub tampers: &'static [Tamper],
    /// True if it represents its kind in the short form.
    pub in_short: bool,
}

impl Mistake {
    /// Mistake of the long form.
    const fn new(chip: Chip, work: Work, check: Check, tampers: &'static [Tamper], what: &'static str) -> Self {
        Self { what, chip, work, check, tampers, in_short: false }
    }

    /// Moves the mistake into the short form.
    const fn short(mut self) -> Self {
        self.in_short = true;
        self
    }
}

const fn at(address: u32, how: How) -> Tamper {
    Tamper { address, how }
}

/// All mistakes.
pub const ALL: &[Mistake] = &[
    // STM32F405: clock.
    Mistake::new(
        Stm32f405,
        Plant,
        boot::answers,
        &[at(0x4002_3804, Field(0x7fc0, 180 << 6))],
        "PLL factor 180 for 168",
    )
    .short(),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4002_3804, Field(0x3f, 8))], "PLL divider 8 for 4"),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4002_3804, Field(0x3f, 2))], "PLL divider 2 for 4"),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4002_3804, Field(0x0f00_0000, 0))], "PLL divider Q left at 0"),
    Mistake::new(
        Stm32f405,
        Plant,
        boot::answers,
        &[at(0x4002_3800, Clear(1 << 16))],
        "the crystal is never switched on",
    ),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4002_3c00, Omit)], "no wait states").short(),
    Mistake::new(
        Stm32f405,
        Plant,
        boot::answers,
        &[at(0x4002_3808, Swap(0x1c00, 0x1400, 0x1000))],
        "APB1 at half the core clock",
    ),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4002_3808, Clear(0xe000))], "APB2 at the core clock"),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4002_3808, Clear(3))], "the PLL is never selected"),
    // STM32F405: pins and line.
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4002_3830, Clear(1))], "the clock of port A is off").short(),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4002_3844, Clear(1 << 4))], "the clock of USART1 is off"),
    Mistake::new(
        Stm32f405,
        Plant,
        boot::answers,
        &[at(0x4002_0024, Swap(0xf0, 0x70, 0x80))],
        "PA9 has the wrong function",
    ),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4002_0000, Clear(3 << 20))], "PA10 stays an input"),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4002_0000, Clear(3 << 26))], "a debug pin is taken"),
    Mistake::new(
        Stm32f405,
        Plant,
        pins::only_those_of_the_file,
        &[at(0x4002_000c, Set(1))],
        "PA0, which the board's file forbids, has a pull",
    )
    .short(),
    Mistake::new(
        Stm32f405,
        Plant,
        boot::answers,
        &[at(0x4001_1008, Field(0xffff, 182))],
        "the divider of the line is that of APB1",
    ),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4001_1014, Clear(1 << 6))], "no DMA for received bytes"),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0x4001_100c, Set(1 << 14))], "a reserved bit of USART_CR1"),
    // The core.
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0xe000_e104, Omit)], "the line's interrupt stays masked"),
    Mistake::new(
        Stm32f405,
        Plant,
        boot::answers,
        &[at(0xe000_ed23, Field(0xff, 0xf0))],
        "the tick has the lowest priority",
    )
    .short(),
    Mistake::new(
        Stm32f405,
        Plant,
        boot::answers,
        &[at(0xe000_e014, Field(0xff_ffff, 8499))],
        "the tick is that of another core clock",
    ),
    Mistake::new(Stm32f405, Plant, boot::answers, &[at(0xe000_ed88, Omit)], "the floating-point unit stays off"),
    // After a bootloader.
    Mistake::new(
        Stm32f405,
        Plant,
        bootloader::starts,
        &[at(0xe000_ed08, Omit)],
        "a bootloader's vectors stay in force",
    )
    .short(),
    Mistake::new(
        Stm32f405,
        Plant,
        bootloader::starts,
        &[at(0xe000_e188, Omit)],
        "an interrupt that a bootloader has left on stays on",
    )
    .short(),
    Mistake::new(
        Stm32f405,
        SpiSlave,
        bootloader::serves_a_master,
        &[at(0xe000_e010, OmitValue(0))],
        "a bootloader's tick goes on",
    ),
    Mistake::new(
        Stm32f405,
        Plant,
        bootloader::starts,
        &[at(0x4002_3808, Swap(3, 0, 2))],
        "the core stays on a bootloader's PLL",
    ),
    Mistake::new(
        Stm32h743,
        Plant,
        bootloader::starts,
        &[at(0x5802_4488, Omit)],
        "a pin that a bootloader drove is driven still",
    ),
    Mistake::new(
        Stm32f405,
        Plant,
        bootloader::starts,
        &[at(0x4002_3810, OmitValue(0x2060_0000))],
        "a bootloader's DMA still writes to RAM",
    )
    .short(),
    Mistake::new(
        Stm32g474,
        Plant,
        bootloader::starts,
        &[at(0x4002_1028, OmitValue(7))],
        "a bootloader's DMA still writes to RAM",
    ),
    Mistake::new(
        Stm32g431,
        Plant,
        boot::answers,
        &[at(0x4000_7008, Omit)],
        "the line's pin is pulled down for an empty battery on USB",
    ),
    // STM32F405: watchdog and outputs.
    Mistake::new(
        Stm32f405,
        Plant,
        outputs::watchdog,
        &[at(0x4000_3000, OmitValue(0xcccc))],
        "the watchdog is never started",
    ),
    Mistake::new(
        Stm32f405,
        Plant,
        outputs::watchdog,
        &[at(0x4000_3000, OmitValue(0x5555))],
        "its settings are not unlocked",
    )
    .short(),
    Mistake::new(
        Stm32f405,
        Plant,
        outputs::watchdog,
        &[at(0x4000_3008, Field(0xfff, 4000))],
        "its time is eight times too long",
    ),
    Mistake::new(
        Stm32f405,
        Plant,
        outputs::watchdog,
        &[at(0x4002_3874, Clear(1 << 24))],
        "flags of resets are never cleared",
    ),
    Mistake::new(Stm32f405, Plant, outputs::silence, &[at(0x4002_0400, Clear(3))], "the enable pin stays an input"),
    // STM32F405: flash.
    Mistake::new(
        Stm32f405,
        Observer,
        memory::keeps,
        &[at(0x4002_3c04, OmitValue(0xcdef_89ab))],
        "flash: half of the keys",
    )
    .short(),
    Mistake::new(Stm32f405, Observer, memory::keeps, &[at(0x4002_3c10, Clear(0xf << 3))], "flash: sector 0 is erased"),
    Mistake::new(
        Stm32f405,
        Observer,
        memory::keeps,
        &[at(0x4002_3c10, Clear(3 << 8))],
        "flash: words, with PSIZE for bytes",
    ),
    Mistake::new(
        Stm32f405,
        Observer,
        memory::keeps,
        &[at(0x4002_3c10, Clear(1 << 16))],
        "flash: the erase is not started",
    ),
    Mistake::new(Stm32f405, Observer, memory::keeps, &[at(0x4002_3c10, Swap(1, 1, 0))], "flash: programs without PG"),
    Mistake::new(
        Stm32f405,
        Observer,
        memory::keeps,
        &[at(0x4002_3c00, Clear(1 << 12))],
        "flash: the data cache is not reset",
    ),
    Mistake::new(
        Stm32f405,
        Observer,
        memory::keeps,
        &[at(0x4002_3c00, Set(1 << 10))],
        "flash: the data cache is reset while it is on",
    ),
    // STM32F405: SPI.
    Mistake::new(
        Stm32f405,
        SpiSlave,
        spi::transfers,
        &[at(0x4002_6458, Swap(7 << 25, 3 << 25, 2 << 25))],
        "DMA: the channel beside",
    ),
    Mistake::new(Stm32f405, SpiSlave, spi::transfers, &[at(0x4002_6408, Omit)], "DMA: flags are not cleared"),
    Mistake::new(
        Stm32f405,
        SpiSlave,
        spi::transfers,
        &[at(0x4001_3c00, Omit)],
        "the chip select's interrupt stays masked",
    ),
    // STM32G474.
    Mistake::new(Stm32g474, Plant, boot::answers, &[at(0x4000_7080, Omit)], "no boost above 150 MHz").short(),
    Mistake::new(Stm32g474, Plant, boot::answers, &[at(0x4002_1058, Clear(1 << 28))], "the clock of PWR is off"),
    Mistake::new(Stm32g474, Plant, boot::answers, &[at(0x4002_1008, Clear(0xf0))], "full bus clock at once"),
    Mistake::new(Stm32g474, Plant, boot::answers, &[at(0x4002_2000, Field(0xf, 3))], "three wait states for four"),
    Mistake::new(Stm32g474, Plant, boot::answers, &[at(0x4002_100c, Clear(1 << 24))], "the output R of the PLL is off"),
    Mistake::new(Stm32g474, Plant, boot::answers, &[at(0x4000_4400, Clear(1 << 5))], "no interrupt for received bytes"),
    Mistake::new(Stm32g474, Plant, load::plant, &[at(0x4000_4400, Clear(1 << 29))], "the FIFO of the USART is off"),
    Mistake::new(
        Stm32g474,
        Observer,
        memory::keeps,
        &[at(0x4002_2014, Clear(1 << 11))],
        "flash: the page of the other bank",
    ),
    Mistake::new(
        Stm32g474,
        Observer,
        memory::keeps,
        &[at(0x4002_2000, Set(1 << 10))],
        "flash: the data cache is left on",
    ),
    Mistake::new(Stm32g474, Observer, memory::keeps, &[at(0x4002_2014, Clear(1 << 16))], "flash: programs over data"),
    Mistake::new(
        Stm32g474,
        SpiSlave,
        spi::transfers,
        &[at(0x4002_0800, Field(0x7f, 10))],
        "DMAMUX: the request of SPI1",
    )
    .short(),
    Mistake::new(
        Stm32g474,
        SpiSlave,
        spi::transfers,
        &[at(0x4000_3804, Clear(1 << 12))],
        "SPI: every second byte asks for DMA",
    ),
    Mistake::new(
        Stm32g474,
        Observer,
        memory::survives_some_cuts,
        &[at(0x4002_2018, Omit)],
        "flash: the flag of a double error is not cleared in NMI",
    ),
    Mistake::new(
        Stm32g474,
        Observer,
        memory::one_bank,
        &[at(0x4002_2014, Set(1 << 11))],
        "flash: the second bank of a chip with one",
    )
    .short(),
    // CAN.
    Mistake::new(
        Stm32f405,
        Drive,
        can::equals_twin,
        &[at(0x4000_641c, Field(0x3ff, 5))],
        "CAN: prescaler 6 for 3, half the bit rate",
    )
    .short(),
    Mistake::new(
        Stm32f405,
        Drive,
        can::equals_twin,
        &[at(0x4000_641c, Field(0x7f_0000, 4 << 16 | 7 << 20))],
        "CAN: the sample point in the middle of a bit",
    ),
    Mistake::new(
        Stm32f405,
        Drive,
        can::equals_twin,
        &[at(0x4000_6414, Clear(1 << 1))],
        "CAN: received frames raise no interrupt",
    ),
    Mistake::new(
        Stm32f405,
        Drive,
        can::equals_twin,
        &[at(0x4000_640c, Clear(1 << 5))],
        "CAN: the FIFO is never released",
    ),
    Mistake::new(
        Stm32f405,
        Drive,
        can::equals_twin,
        &[at(0x4000_6400, Clear(1 << 2))],
        "CAN: frames are sent in the order of their identifiers",
    )
    .short(),
    Mistake::new(Stm32f405, Drive, can::recovers, &[at(0x4000_6400, Clear(1 << 6))], "CAN: bus-off for ever").short(),
    Mistake::new(
        Stm32f405,
        Drive,
        can::equals_twin,
        &[at(0x4000_6600, Clear(1))],
        "CAN: filters are set up while they are in force",
    ),
    Mistake::new(Stm32f405, Drive, can::equals_twin, &[at(0x4000_661c, Omit)], "CAN: no filter is active"),
    Mistake::new(Stm32f405, Drive, can::equals_twin, &[at(0x4002_3840, Clear(1 << 25))], "CAN: its clock is off"),
    Mistake::new(
        Stm32f405,
        Drive,
        can::equals_twin,
        &[at(0x4002_0424, Swap(0xf0, 0x90, 0x80))],
        "CAN: PB9 has the wrong function",
    ),
    Mistake::new(
        Stm32g474,
        Drive,
        can::equals_twin,
        &[at(0x4000_641c, Field(0x1ff_0000, 1 << 16))],
        "FDCAN: prescaler 2 for 1, half the bit rate",
    ),
    Mistake::new(
        Stm32g474,
        Drive,
        can::equals_twin,
        &[at(0x4000_640c, Clear(1 << 23))],
        "FDCAN: no compensation of the transceiver's delay",
    )
    .short(),
    Mistake::new(
        Stm32g474,
        Drive,
        can::equals_twin,
        &[at(0x4000_6418, Set(1 << 13))],
        "FDCAN: edge filtering, which the errata forbid",
    )
    .short(),
    Mistake::new(
        Stm32g474,
        Drive,
        can::equals_twin,
        &[at(0x4000_6418, Set(1 << 6))],
        "FDCAN: no retransmission, which the errata forbid",
    ),
    Mistake::new(
        Stm32g474,
        Drive,
        can::equals_twin,
        &[at(0x4000_6494, Omit)],
        "FDCAN: received elements are never acknowledged",
    ),
    Mistake::new(
        Stm32g474,
        Drive,
        can::recovers,
        &[at(0x4000_6450, Omit)],
        "FDCAN: flags of interrupts are never cleared, and idle starves",
    ),
    Mistake::new(Stm32g474, Drive, can::equals_twin, &[at(0x4002_1088, Omit)], "FDCAN: clocked by the crystal").short(),
    Mistake::new(
        Stm32g474,
        Drive,
        can::recovers,
        &[at(0x4000_6418, OmitValue(0x300))],
        "FDCAN: the initialisation never ends",
    ),
    Mistake::new(
        Stm32h743,
        Drive,
        can::equals_twin,
        &[at(0x4000_a01c, Field(0x1ff_0000, 1 << 16))],
        "FDCAN: prescaler 2 for 1, half the bit rate",
    ),
    Mistake::new(
        Stm32h743,
        Drive,
        can::equals_twin,
        &[at(0x5802_4430, Field(0x7f_0000, 1 << 16))],
        "FDCAN: the divider of its clock left as after a reset",
    ),
    Mistake::new(Stm32h743, Drive, can::equals_twin, &[at(0x5802_4450, Omit)], "FDCAN: clocked by the debug probe"),
    Mistake::new(Stm32h743, Drive, can::equals_twin, &[at(0x5802_44ec, Clear(1 << 8))], "FDCAN: its clock is off"),
    Mistake::new(Stm32h743, Drive, can::equals_twin, &[at(0x4000_a804, Omit)], "FDCAN: clock calibration not bypassed")
        .short(),
    Mistake::new(
        Stm32h743,
        Drive,
        can::equals_twin,
        &[at(0x4000_a018, OmitValue(3))],
        "FDCAN: set up without access to the settings",
    ),
    Mistake::new(
        Stm32h743,
        Drive,
        can::equals_twin,
        &[at(0x4000_a0c0, Field(0xfffc, 0xd4))],
        "FDCAN: the FIFOs overlap in the message RAM by a word",
    )
    .short(),
    Mistake::new(
        Stm32h743,
        Drive,
        can::equals_twin,
        &[at(0x4000_a0c0, Field(0xfffc, 0xdc))],
        "FDCAN: the transmit FIFO a word behind its place in the message RAM",
    ),
    Mistake::new(
        Stm32h743,
        Drive,
        can::equals_twin,
        &[at(0x4000_a0a0, Field(0xfffc, 0x27fc))],
        "FDCAN: the receive FIFO leaves the message RAM",
    ),
    Mistake::new(Stm32h743, Drive, can::equals_twin, &[at(0x4000_a0bc, Omit)], "FDCAN: received elements of 8 bytes"),
    Mistake::new(Stm32h743, Drive, can::equals_twin, &[at(0x4000_a0c8, Omit)], "FDCAN: elements to send of 8 bytes"),
    Mistake::new(
        Stm32h743,
        Drive,
        can::equals_twin,
        &[at(0x4000_a0a8, Omit)],
        "FDCAN: received elements are never acknowledged",
    ),
    // STM32G431.
    Mistake::new(
        Stm32g431,
        Plant,
        pins::only_those_of_the_file,
        &[at(0x4800_0400, Field(3 << 30, 1 << 30))],
        "PB15, the gate input of a phase, is an output",
    )
    .short(),
    // STM32H743.
    Mistake::new(Stm32h743, Plant, boot::answers, &[at(0x5802_4818, Omit)], "voltage scale 3 at 400 MHz").short(),
    Mistake::new(Stm32h743, Plant, boot::answers, &[at(0x5802_480c, Omit)], "the supply is not set up"),
    Mistake::new(Stm32h743, Plant, boot::answers, &[at(0x5200_2000, Clear(0x30))], "WRHIGHFREQ 0 at 200 MHz"),
    Mistake::new(Stm32h743, Plant, boot::answers, &[at(0x5802_4418, Clear(0xf))], "the bus at the core clock"),
    Mistake::new(Stm32h743, Plant, boot::answers, &[at(0x5802_442c, Clear(0xc))], "PLL input range for 1 to 2 MHz"),
    Mistake::new(Stm32h743, Plant, boot::answers, &[at(0x5802_442c, Set(2))], "the medium range for 800 MHz inside"),
    Mistake::new(
        Stm32h743,
        Plant,
        boot::answers,
        &[at(0x5802_4430, Field(0xfe00, 2 << 9))],
        "PLL 1 divided by an odd number",
    ),
    Mistake::new(Stm32h743, Plant, boot::answers, &[at(0x5802_44e0, Clear(1 << 3))], "the clock of port D is off"),
    Mistake::new(Stm32h743, Observer, memory::keeps, &[at(0x5200_2104, Omit)], "flash: no keys for the second bank")
        .short(),
    Mistake::new(
        Stm32h743,
        Observer,
        memory::keeps,
        &[at(0x5200_210c, Swap(0x84, 0x84, 0x04))],
        "flash: the erase is not started",
    ),
    Mistake::new(
        Stm32h743,
        Observer,
        memory::survives_some_cuts,
        &[at(0xe000_ed14, Clear(1 << 8))],
        "flash: a word that may be damaged is read with bus faults on",
    ),
];

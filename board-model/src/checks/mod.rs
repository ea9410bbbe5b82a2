//! Checks of every image on the model of its board. A check starts its own board, and fails on the first error or on
//! any violation of a rule.

pub mod bits;
pub mod boot;
pub mod bootloader;
pub mod can;
mod can_client;
pub mod encoder;
pub mod load;
pub mod memory;
pub mod outputs;
pub mod pins;
pub mod sources;
pub mod spi;

use board::device::board::{Board as Described, Chip};

use crate::boards::Subject;
use crate::cpu::Board;
use crate::images::Work;
use crate::known;

/// Check of an image; returns findings or the error.
pub type Check = fn(&Subject) -> Result<String, String>;

/// Check with its name.
pub struct Named {
    /// Name: the property that must hold.
    pub name: &'static str,
    /// Images that the check is for.
    pub works: &'static [Work],
    /// Chips that the check is for, on the first board with each; other boards only boot and run the plant.
    pub chips: &'static [Chip],
    /// True if the plant must pass the check on every board.
    pub is_for_every_board: bool,
    /// Function of the check.
    pub run: Check,
    /// True if the check runs in the long form only.
    pub is_long: bool,
}

const fn short(name: &'static str, works: &'static [Work], run: Check) -> Named {
    Named { name, works, chips: &Chip::ALL, is_for_every_board: false, run, is_long: false }
}

impl Named {
    const fn on_every_board(mut self) -> Self {
        self.is_for_every_board = true;
        self
    }

    /// Images of a board for this check. Differences between boards with one chip show when they boot and run.
    pub fn works(&self, board: &Described, is_first: bool) -> impl Iterator<Item = Work> {
        let works: &[Work] = if is_first && self.chips.contains(&board.chip()) {
            self.works
        } else if self.is_for_every_board {
            &[Work::Plant]
        } else {
            &[]
        };
        works.iter().copied().filter(|work| has_image(board, *work))
    }
}

/// All checks, in order.
pub const ALL: &[Named] = &[
    short("boots, ticks and answers", &[Work::Plant, Work::Observer, Work::Loop], boot::answers).on_every_board(),
    short("drives no pin that its file forbids", &[Work::Plant], pins::only_those_of_the_file).on_every_board(),
    short("starts after a bootloader", &[Work::Plant, Work::Observer, Work::Loop], bootloader::starts),
    short("serves a master after a bootloader", &[Work::SpiSlave], bootloader::serves_a_master),
    short("boots from the internal oscillator", &[Work::Plant], sources::dead_crystal),
    short("other crystals", &[Work::Plant], sources::other_crystals),
    short("the external source dies in a run", &[Work::Plant], sources::dies_in_a_run),
    short("20,000 steps, the same in every bit as the host's twin", &[Work::Plant], bits::steps),
    short("keeps, writes and erases what was learnt", &[Work::Observer], memory::keeps),
    Named {
        name: "flash as one bank",
        works: &[Work::Observer],
        chips: &[Chip::Stm32g474],
        is_for_every_board: false,
        run: memory::one_bank,
        is_long: false,
    },
    short("plant with ticks as long as counted: no tick too long, no byte lost", &[Work::Plant], load::plant),
    short("loop with ticks as long as counted: no tick too long, no byte lost", &[Work::Loop], load::whole_loop),
    short("safe state when the host is silent", &[Work::Plant], outputs::silence),
    short("watchdog when the ticks stop", &[Work::Plant], outputs::watchdog),
    short("held by a debugger", &[Work::Plant], outputs::held_by_debugger),
    short("a fault resets and is told", &[Work::Plant], outputs::fault),
    short("transfers, good and bad", &[Work::SpiSlave], spi::transfers),
    short("transfers that are too long", &[Work::SpiSlave], spi::too_long),
    Named {
        name: "an encoder is read over SPI as a master",
        works: &[Work::Plant],
        chips: &[Chip::Stm32f405, Chip::Stm32g474, Chip::Stm32g431],
        is_for_every_board: false,
        run: encoder::is_read,
        is_long: false,
    },
    short("answers a client as the host's twin does, in every frame", &[Work::Drive], can::equals_twin),
    short("loses no frame of a full bus", &[Work::Drive], can::hears_in_a_flood),
    short("comes back after bus-off, a lonely bus and a held one", &[Work::Drive], can::recovers),
    short("reports bus-off to a CANopen master, as the host's twin does", &[Work::Canopen], can::reports_bus_off),
    short("power cut at some operations of flash", &[Work::Observer], memory::survives_some_cuts),
    Named {
        name: "power cut at every operation of flash",
        works: &[Work::Observer],
        chips: &Chip::ALL,
        is_for_every_board: false,
        run: memory::survives_cuts,
        is_long: true,
    },
];

/// Returns whether a board has an image of a kind: the STM32G431 has room for the plant and the smaller drives only.
fn has_image(board: &Described, work: Work) -> bool {
    match work {
        Work::Plant => true,
        Work::Observer | Work::Loop => board.chip() != Chip::Stm32g431,
        Work::SpiSlave => board.has_spi_slave(),
        Work::Drive => can::is_for(board),
        Work::Canopen => can::is_for(board) && board.chip() != Chip::Stm32g431,
    }
}

/// Fails if a board has halted or has violated a rule.
pub fn clean(board: &Board<'_>) -> Result<(), String> {
    if let Some(why) = &board.machine().halted {
        return Err(format!("{why}; it was at {}", board.whereabouts()));
    }
    let name = board.machine().chip.name;
    let violations = board.machine().wires.violations.all();
    let new: Vec<_> = violations.iter().filter(|violation| !known::is_known(name, violation)).collect();
    if new.is_empty() {
        return Ok(());
    }
    let lines = new.iter().map(|violation| format!("{violation}, in {}", board.image.function(violation.pc)));
    Err(lines.collect::<Vec<_>>().join("\n"))
}

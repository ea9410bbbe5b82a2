//! What every image must do on the model of its board. A check starts its own board, and fails on the first thing that is
//! not as it should be, or on any violation.

pub mod bits;
pub mod boot;
pub mod memory;
pub mod outputs;
pub mod sources;
pub mod spi;

use board::target::board::Board as Kind;

use crate::cpu::Board;
use crate::image::Image;
use crate::images::Work;

/// A check of an image: what it found, or what is wrong.
pub type Check = fn(Kind, &Image) -> Result<String, String>;

/// All checks: name, images that it is for, whether it is left to the long form.
pub const ALL: &[(&str, &[Work], Check)] = &[
    ("boots, ticks and answers", &[Work::Plant, Work::Observer, Work::Loop], boot::answers),
    ("boots from the internal oscillator", &[Work::Plant], sources::dead_crystal),
    ("other crystals", &[Work::Plant], sources::other_crystals),
    ("keeps, writes and erases what was learnt", &[Work::Observer], memory::keeps),
    ("power cut at every operation of flash", &[Work::Observer], memory::survives_cuts),
    ("safe state when the host is silent", &[Work::Plant], outputs::silence),
    ("watchdog when the ticks stop", &[Work::Plant], outputs::watchdog),
    ("a fault resets and is told", &[Work::Plant], outputs::fault),
    ("transfers, good and bad", &[Work::SpiSlave], spi::transfers),
    ("transfers that are too long", &[Work::SpiSlave], spi::too_long),
    ("20,000 steps, the same in every bit as the host's twin", &[Work::Plant], bits::steps),
];

/// Fails if a board has been halted or has done anything against a rule.
pub fn clean(board: &Board<'_>) -> Result<(), String> {
    if let Some(why) = &board.machine().halted {
        return Err(format!("{why}; it was at {}", board.whereabouts()));
    }
    let violations = board.machine().wires.violations.all();
    if violations.is_empty() {
        return Ok(());
    }
    let lines = violations.iter().map(|violation| format!("{violation}, in {}", board.image.function(violation.pc)));
    Err(lines.collect::<Vec<_>>().join("\n"))
}

/// Whether a board has an image for this.
pub fn applies(board: Kind, work: Work) -> bool {
    work != Work::SpiSlave || board.has_spi_slave()
}

//! Board files: TOML that describes a board (chip, memory, clock, pins, lines). Reading reports all problems of a file
//! at once, each with its place in the text.
//!
//! `chip` holds the data of every chip, one file each; `keys` lists every key; `section` reads values of a table by
//! that list; `pins` decides which pins may be used for a purpose; `can` reads the CAN line, whose rates `bit_timing`
//! makes from the clock; `lines` reads the encoders, which no image uses yet;
//! `reader` assembles the board. `generated` is the part that a build of the firmware uses. A board that was read can
//! be built for: its pins, clock, line speed and memory have been checked against the chip.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]

mod bit_timing;
mod board;
mod can;
mod chip;
mod generated;
mod keys;
mod lines;
#[cfg(feature = "diagnostics")]
pub mod named;
mod pin;
mod pins;
mod pll;
mod presets;
mod reader;
mod section;

pub use bit_timing::{BitTiming, TimingLimits};
pub use board::{
    Board, Can, Encoder, EncoderPins, ExternalClock, FLASH_START, Level, Output, RAM_START, Serial, SpiSlave,
    Transceiver,
};
pub use chip::{Chip, ImageSize, OTHER_CHIPS, Slot};
pub use generated::{all_cfgs, cfgs, linker_script, rust_source};
pub use joint_file::{Problem, Problems, Severity, Source};
pub use pin::{Alternate, InvalidPinName, Pin};
pub use pll::{Pll, Plls};
pub use presets::{DEFAULT, PRESETS, boards_with, chip_in_place_of_board, preset};
pub use reader::{baud_divider, read};

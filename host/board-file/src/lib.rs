//! Board files: TOML that says what a board is (chip, memory, clock, pins, lines), read with all problems of a file found at
//! once, each with its place in the text.
//!
//! `chip` has the facts of every chip, a file each; `keys` lists every key; `section` takes values out of a table by that
//! list; `pins` says which pins may be used for what, `lines` what a board has that no image uses yet; `reader` puts the board together. `generated` is what a build of the
//! firmware takes from it. A board that is read can be built for: pins, clock, speed of the line and memory have been held
//! against its chip.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]

mod board;
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

pub use board::{
    Board, Can, Encoder, EncoderPins, ExternalClock, FLASH_START, Level, Output, RAM_START, Serial, SpiSlave,
};
pub use chip::{Chip, ImageSize, OTHER_CHIPS, Slot};
pub use generated::{all_cfgs, cfgs, linker_script, rust_source};
pub use joint_file::{Problem, Problems, Severity, Source};
pub use pin::{Alternate, NoPin, Pin};
pub use pll::{Pll, Plls};
pub use presets::{DEFAULT, PRESETS, boards_with, chip_in_place_of_board, preset};
pub use reader::{baud_divider, read};

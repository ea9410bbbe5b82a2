//! Everything about the device under test on the host: its compiler, images, the emulator, flashing.
//!
//! The order of use: [`toolchain::Toolchain::prepare`], [`image::build_image`], then [`emulator::Emulator::start`] or
//! [`flash::flash`]; or [`measuring::build_measuring`] and [`measuring::run`]. An image is built once for its `sources`. Each says
//! what it is about to do, if that takes time or changes the machine, before it does it.

pub mod board;
pub mod compile;
pub mod cross_build;
pub mod emulator;
pub mod flash;
pub mod image;
pub mod lint;
pub mod measuring;
pub mod packages;
pub mod prediction;
mod role;
mod sources;
pub mod sysroot;
pub mod tick_time;
pub mod tool;
pub mod toolchain;

/// Prints a line for the user about what is done next.
pub type Say<'a> = &'a dyn Fn(&str);

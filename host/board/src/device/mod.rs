//! The device under test on the host: its compiler, images, the emulator, flashing.
//!
//! Order of use: [`toolchain::Toolchain::prepare`], [`image::build_image`], then [`emulator::Emulator::start`] or
//! [`flash`]; or [`measuring::build_measuring`] and [`measuring::run`]. An image is rebuilt only if one of its
//! `sources` has changed. Each step that takes time or changes the machine announces itself first.

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

/// Callback that prints a progress line for the user.
pub type Say<'a> = &'a dyn Fn(&str);

//! The host command `joint`: arguments, calls, exit codes. The work is done in the other host crates. A library, so that
//! the Python wheel can run the command without a second program; nothing else depends on it.

mod board;
mod budget;
mod check;
mod cli;
mod completions;
mod export;
mod flash;
mod hil;
mod identify;
mod image;
mod library;
mod memory;
mod merge;
mod new;
mod replay;
mod research;
mod sim;
mod sweep;
mod tables;
mod task;
mod twin;

pub use cli::{main, run};

//! The host command `joint` as a library, so that its parts can be tested without a process. `hil` runs a joint on a
//! board and checks it, `target` prepares toolchain, image and emulator, `check` reads a joint file, `record` is what
//! a run leaves behind and `report` shows it, `sim` moves a joint on the host, `sweep` many of them, `bench` compares the
//! step with what people use, `budget` says what is promised of it, `paper` redoes the paper with the numerics of
//! `study`, `proof` holds the step that ships to what is promised of it, `trial` runs test files of observer and
//! compensation, `identify` finds a joint's parameters in a recorded test, `memory` moves what a board has learnt; physics and wire format are left to
//! `model-core` and `link`.

pub mod bench;
pub mod budget;
pub mod check;
pub mod cli;
pub mod failure;
mod folder;
pub mod hil;
pub mod identify;
pub mod images;
pub mod interruption;
pub mod memory;
pub mod output;
pub mod paper;
pub mod proof;
pub mod record;
pub mod report;
#[cfg(test)]
mod schema;
pub mod sim;
pub mod study;
pub mod sweep;
pub mod target;
pub mod trial;

//! What `joint hil --check` does after the run: every board's image, clippy over the firmware, and the tests that need
//! the emulated board. Host tests that need no board are `cargo test`'s own business.

use std::process::{Command, Stdio};

use link::messages::Role;

use super::Progress;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::target::board::Board;
use crate::target::image;
use crate::target::lint;
use crate::target::toolchain::{Toolchain, workspace};

/// Runs all of it; the first failure ends it.
pub fn check(tick_rate: u32, progress: &Progress) -> Outcome<()> {
    let say = |line: &str| progress.say(line);
    progress.stage("preparing the toolchain");
    let toolchain = Toolchain::prepare(&say)?;
    for board in Board::ALL {
        progress.stage(&format!("building the image for {}", board.name()));
        let image = image::build_image(&toolchain, &image::preset_file("q1"), board, Role::Plant, tick_rate, &say)?;
        let (flash, ram) = (image.flash_bytes, image.ram_bytes);
        progress.clear();
        output::print(&format!("ok       image for {}: {flash} B of flash, {ram} B of RAM\n", board.name()))?;
        progress.stage(&format!("linting the firmware for {}", board.name()));
        lint::clippy(&toolchain, board, &say)?;
        progress.clear();
        output::print(&format!("ok       clippy for {}\n", board.name()))?;
    }
    emulator_tests()
}

/// The tests that are left out of `cargo test`, with cargo's own output.
fn emulator_tests() -> Outcome<()> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(["test", "--package", "joint", "--package", "host-tests", "--", "--ignored"])
        .current_dir(workspace())
        .stdin(Stdio::null())
        .status()
        .map_err(|error| Failure::new(format!("cannot run cargo for the tests on the emulated board: {error}")))?;
    match status.success() {
        true => output::print("ok       tests on the emulated board\n"),
        false => Err(Failure::check_failed(format!("tests on the emulated board failed ({status})"))),
    }
}

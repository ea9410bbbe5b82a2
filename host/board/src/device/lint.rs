//! Clippy over the firmware as built for a board, warnings denied.

use super::board::{Board, Chip};
use super::compile::PROFILE;
use super::measuring::measuring_features;
use super::toolchain::Toolchain;
use super::{Say, packages, tool};
use report::failure::{Failure, Outcome};

/// Debian's clippy, which must match the compiler that built the core library.
const PACKAGE: &str = "rust-web-clippy";

/// Lints library, binaries and examples of the firmware for a board, and the measuring binaries for the emulated chip.
pub fn clippy(toolchain: &Toolchain, board: &Board, say: Say<'_>) -> Outcome<()> {
    if toolchain.is_distribution() {
        packages::ensure(&[PACKAGE], "to lint the firmware", say)?;
    }
    let features = match board.chip() {
        Chip::Stm32f405 => measuring_features(),
        other => other.name().to_owned(),
    };
    let mut targets = vec!["--package", "firmware", "--profile", PROFILE, "--lib", "--examples"];
    // The SPI slave's binary compiles only for boards with an SPI slave.
    targets.extend(match board.has_spi_slave() {
        true => vec!["--bins"],
        false => vec!["--bin", "plant", "--bin", "observer", "--bin", "whole_loop"],
    });
    let mut command = toolchain.cargo("clippy");
    command
        .args(targets)
        .env("BOARD_FILE", &board.file)
        .args(["--no-default-features", "--features", &features])
        .args(["--", "-D", "warnings"]);
    tool::run_with_progress(&mut command, &format!("linting the firmware for {}", board.name()), say)
        .map_err(|failure| Failure::check_failed(failure.message()))
}

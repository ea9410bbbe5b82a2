//! Clippy over the firmware as it is built for a board, warnings denied.

use super::board::Board;
use super::compile::PROFILE;
use super::measuring::measuring_features;
use super::toolchain::Toolchain;
use super::{Say, packages, tool};
use report::failure::{Failure, Outcome};

/// Debian's clippy: it must match the compiler that built the core library.
const PACKAGE: &str = "rust-web-clippy";

/// Lints library, binaries and examples of the firmware for a board; on the board that is emulated, the measuring
/// binaries too.
pub fn clippy(toolchain: &Toolchain, board: Board, say: Say<'_>) -> Outcome<()> {
    if toolchain.is_distribution() {
        packages::ensure(&[PACKAGE], "to lint the firmware", say)?;
    }
    let features = match board {
        Board::Stm32f405 => measuring_features(),
        Board::Stm32g474 | Board::Stm32h743 => board.name().to_owned(),
    };
    let mut command = toolchain.cargo("clippy");
    command
        .args(["--package", "firmware", "--profile", PROFILE, "--lib", "--bins", "--examples"])
        .args(["--no-default-features", "--features", &features])
        .args(["--", "-D", "warnings"]);
    tool::follow(&mut command, &format!("linting the firmware for {}", board.name()), say)
        .map_err(|failure| Failure::check_failed(failure.message()))
}

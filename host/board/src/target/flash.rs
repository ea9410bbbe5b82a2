//! Writes an image to a real board with probe-rs.

use std::path::Path;
use std::process::{Command, Stdio};

use super::board::Board;
use super::tool;
use report::failure::{Failure, Outcome};

const PROGRAM: &str = "probe-rs";

/// Writes an image to the board behind the debug probe and starts it. probe-rs shows its own progress.
pub fn flash(elf: &Path, board: Board) -> Outcome<()> {
    let program = tool::find(PROGRAM).ok_or_else(|| absent(elf, board))?;
    let run = |arguments: &[&str], elf: Option<&Path>| {
        let mut command = Command::new(&program);
        command.args(arguments).args(["--chip", board.chip()]).args(elf).stdin(Stdio::null());
        let status = command.status().map_err(|error| Failure::new(format!("cannot run {PROGRAM}: {error}")))?;
        match status.success() {
            true => Ok(()),
            false => Err(Failure::new(format!("{PROGRAM} {} failed ({status})", arguments.join(" ")))
                .with_help("is the debug probe plugged in? `probe-rs list` shows what is there")),
        }
    };
    run(&["download"], Some(elf))?;
    run(&["reset"], None)
}

fn absent(elf: &Path, board: Board) -> Failure {
    Failure::new(format!("{PROGRAM}, which writes images to boards, is not on the search path")).with_help(format!(
        "get it: cargo install {PROGRAM}-tools --locked (https://probe.rs/docs/getting-started/installation)\n\
         or write {} to the {} by a tool of your own",
        elf.display(),
        board.chip()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_probe_rs_both_ways_to_go_on_are_shown() {
        let failure = absent(Path::new("images/q1.elf"), Board::Stm32g474);
        let help = failure.help().unwrap();
        assert!(help.contains("cargo install probe-rs-tools"), "{help}");
        assert!(help.contains("images/q1.elf") && help.contains("STM32G474RETx"), "{help}");
        assert_eq!(failure.exit_code(), 2);
    }
}

//! `board-model check`: runs the images that ship on models of their boards. `board-model run`: one board with its line on a
//! pseudo-terminal, for the host's own commands.

use std::process::ExitCode;
use std::time::Instant;

use board::target::board::Board as Kind;
use board_model::checks;
use board_model::images::Images;
use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(version, about = "STM32F405, STM32G474 and STM32H743 at the level of registers")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs every check on every board
    Check {
        /// This board only
        #[arg(long, value_enum)]
        board: Option<Kind>,
        /// Checks with this in their name only
        #[arg(long, value_name = "TEXT")]
        only: Option<String>,
    },
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Check { board, only } => check(board, only.as_deref()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// All of them, whatever fails; then how many did.
fn check(board: Option<Kind>, only: Option<&str>) -> Result<(), String> {
    let mut images = Images::prepare()?;
    let mut failed = 0;
    for kind in Kind::ALL.into_iter().filter(|kind| board.is_none_or(|wanted| wanted == *kind)) {
        for (name, works, run) in checks::ALL.iter().filter(|(name, ..)| only.is_none_or(|text| name.contains(text))) {
            for work in works.iter().filter(|work| checks::applies(kind, **work)) {
                let image = images.get(kind, *work)?;
                let start = Instant::now();
                let outcome = run(kind, &image);
                let what = format!("{}, {}: {name}", kind.name(), work.name());
                let seconds = start.elapsed().as_secs_f64();
                match outcome {
                    Ok(found) => println!("ok       {what} ({found}; {seconds:.1} s)"),
                    Err(message) => {
                        failed += 1;
                        println!("FAILED   {what} ({seconds:.1} s)\n{message}");
                    }
                }
            }
        }
    }
    if failed == 0 { Ok(()) } else { Err(format!("{failed} checks failed")) }
}

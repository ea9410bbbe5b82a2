//! `board-model check` runs the images that ship on models of their boards. `board-model run` runs one board with its
//! line on a pseudo-terminal, for the host's commands.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use board::device::board::Board;
use board::device::image::default_drive_rate;
use board_model::boards::{Subject, USUAL_COST, usual_surroundings};
use board_model::can_twin::DriveOf;
use board_model::checks::Named;
use board_model::image::Image;
use board_model::images::{Images, JOINT};
use board_model::planted::{self, Mistake};
use board_model::port::Paths;
use board_model::wires::Surroundings;
use board_model::{boards, checks, known, port};
use clap::{Parser, Subcommand};
use joint_file::named;

#[derive(Parser)]
#[command(version, about = "STM32F405, STM32G474, STM32G431 and STM32H743 at the level of registers")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs an image on a board whose line is a pseudo-terminal, until it is interrupted
    Run {
        /// The ELF file
        image: PathBuf,
        /// The board that it is for: a name of boards/, or the path of a board file
        #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse)]
        board: Board,
        /// Frequency of the external source, 0 for none [Hz, default: that of the board as it is sold]
        #[arg(long, value_name = "HZ")]
        source: Option<u64>,
        /// Thousandths of a cycle that an instruction takes
        #[arg(long, value_name = "N", default_value_t = USUAL_COST)]
        cost: u64,
        /// Ends when the client of the CAN bus has left, and compares every frame with the twin of the image's drive
        #[arg(long, value_name = "MAKER")]
        twin: Option<String>,
        /// Joint of the image, for the twin: a preset or a file
        #[arg(long, value_name = "FILE", default_value = JOINT)]
        joint: PathBuf,
        /// Identifier of the image's drive, for the twin
        #[arg(long, value_name = "ID", default_value_t = 1)]
        id: u8,
        /// Control rate of the image, for the twin [Hz, default: that of `joint image`]
        #[arg(long, value_name = "HZ")]
        rate: Option<u32>,
    },
    /// Runs every check on every board
    Check {
        /// This board only
        #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse)]
        board: Option<Board>,
        /// Checks with this in their name only
        #[arg(long, value_name = "TEXT")]
        only: Option<String>,
        /// The long form: every planted mistake, and power cut at every operation of flash
        #[arg(long)]
        full: bool,
    },
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Run { image, board, source, cost, twin, joint, id, rate } => {
            run(&image, board, source, cost, twin.map(|maker| Twin { maker, joint, id, rate }).as_ref())
        }
        Command::Check { board, only, full } => check(board, only.as_deref(), full),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Drive of an image, to be compared with its twin.
struct Twin {
    maker: String,
    joint: PathBuf,
    id: u8,
    rate: Option<u32>,
}

/// Runs a board at its ports; violations are printed as they occur.
fn run(image: &Path, board: Board, source: Option<u64>, cost: u64, twin: Option<&Twin>) -> Result<(), String> {
    let usual = usual_surroundings(&board);
    let surroundings = match source {
        None => usual,
        Some(rate) => {
            let rate = Some(rate).filter(|rate| *rate > 0);
            Surroundings { crystal: usual.crystal.and(rate), external_clock: usual.external_clock.and(rate), ..usual }
        }
    };
    let (name, described) = (board.argument.clone(), board.clone());
    let subject = Subject { board, image: Image::read(image)?, tampers: &[] };
    let mut board = subject.start_at(surroundings, cost)?;
    let mut told = 0;
    let opened = |paths: &Paths<'_>| {
        let line = paths.line;
        println!("{name} at {line}: give the host's commands --port {line} --board {name}");
        if let Some(can) = paths.can {
            println!("CAN bus at {can}: slcan");
        }
    };
    port::serve(&mut board, twin.is_some(), opened, |board| {
        for violation in &board.machine().wires.violations.all()[told..] {
            eprintln!("{violation}, in {}", board.image.function(violation.pc));
        }
        told = board.machine().wires.violations.all().len();
    })?;
    checks::clean(&board)?;
    twin.map_or(Ok(()), |twin| compare(&board, &described, twin))
}

/// Compares the frames of a session with the twin's.
fn compare(board: &board_model::cpu::Board<'_>, described: &Board, twin: &Twin) -> Result<(), String> {
    let joint = &mut named::load(&twin.joint).map_err(|failure| failure.to_string())?.file;
    joint.surroundings.control_rate = twin.rate.unwrap_or_else(|| default_drive_rate(&joint.parameters, described));
    let processor = described.processor();
    let drive = DriveOf { maker: &twin.maker, id: twin.id, joint, processor };
    let bus = &board.machine().wires.can;
    let count = drive.compare(bus)?;
    let (taken, ticks, lost) = (bus.taken.len(), bus.ticks, bus.overruns);
    println!("ok       {taken} frames to the image in {ticks} ticks, {lost} lost; its {count} frames are the twin's");
    Ok(())
}

/// Runs all checks, even after a failure, and counts the failures.
fn check(only_board: Option<Board>, only: Option<&str>, full: bool) -> Result<(), String> {
    let mut images = Images::prepare()?;
    let (mut failed, mut ran) = (0, 0);
    let wanted = |board: &Board, name: &str| {
        only_board.as_ref().is_none_or(|wanted| wanted == board) && only.is_none_or(|text| name.contains(text))
    };
    let mut boards = Board::presets().map_err(|failure| failure.to_string())?;
    boards.extend(only_board.clone().filter(|board| !boards.contains(board)));
    for board in &boards {
        let is_first = boards::with(board.chip())? == *board;
        let chosen = |check: &&Named| wanted(board, check.name) && (full || !check.is_long);
        for check in checks::ALL.iter().filter(chosen) {
            for work in check.works(board, is_first) {
                let subject = Subject { board: board.clone(), image: images.get(board, work)?, tampers: &[] };
                ran += 1;
                let start = Instant::now();
                let outcome = (check.run)(&subject);
                let what = format!("{}, {}: {}", board.name(), work.name(), check.name);
                let seconds = start.elapsed().as_secs_f64();
                match (outcome, known::failing(board.chip().name(), check.name)) {
                    (Ok(found), None) => println!("ok       {what} ({found}; {seconds:.1} s)"),
                    (Err(message), Some(follows)) => {
                        let first = message.lines().next().unwrap_or_default();
                        println!("known    {what}: {follows} ({first}; {seconds:.1} s)");
                    }
                    (Ok(_), Some(_)) => {
                        failed += 1;
                        println!("FAILED   {what}: passes, and is known to fail: take it off the list in known.rs");
                    }
                    (Err(message), None) => {
                        failed += 1;
                        println!("FAILED   {what} ({seconds:.1} s)\n{message}");
                    }
                }
            }
        }
    }
    let (missed, met) = known::violations();
    met.iter().for_each(|line| println!("known    {line}"));
    if only_board.is_none() && only.is_none() {
        failed += missed.len();
        missed.iter().for_each(|line| println!("FAILED   {line}: was not met: take it off the list in known.rs"));
    }
    for mistake in planted::ALL.iter().filter(|mistake| full || mistake.in_short) {
        let Mistake { what, chip, work, check, tampers, .. } = mistake;
        let board = boards::with(*chip)?;
        if !wanted(&board, what) {
            continue;
        }
        ran += 1;
        let image = images.get(&board, *work)?;
        let what = format!("{}, planted: {what}", board.name());
        let subject = Subject { board, image, tampers };
        match check(&subject) {
            Err(message) => println!("caught   {what} ({})", message.lines().next().unwrap_or_default()),
            Ok(_) => {
                failed += 1;
                println!("FAILED   {what}: nothing was noticed");
            }
        }
    }
    if ran == 0 {
        let full = if full { "" } else { ", or --full for the long ones" };
        return Err(format!("no check has `{}` in its name: leave --only out for all{full}", only.unwrap_or_default()));
    }
    if failed == 0 { Ok(()) } else { Err(format!("{failed} checks failed")) }
}

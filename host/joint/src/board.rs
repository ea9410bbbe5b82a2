//! `joint board`: shows a board file or reports every error in it; lists the boards that come with the program.

use std::path::PathBuf;

use board::device::board::Board as TargetBoard;
use board::device::prediction::ORIGIN;
use board_file::{BitTiming, Board, ExternalClock, Level, Output, PRESETS, Pin, SpiSlave, named};
use clap::ValueEnum;
use parameters::JointParameters;
use report::document::{Sheet, terminal};
use report::failure::Outcome;
use report::output;

use crate::image::ImageRole;

/// Arguments of `joint board`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Check a board file and show its pins, clock and memory, or report every error in it
    Check(CheckArguments),
    /// List the boards that come with the program
    List,
}

/// Arguments of `joint board check`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint board check my_board.toml
  joint board check odrive-3.6
  joint board check nucleo-g474re --joint joints/l1.toml    which roles fit for another joint

Exit code 2 if an image cannot be built for the board; what is wrong is shown at its place.")]
struct CheckArguments {
    /// Board file (TOML), or the name of one in boards/
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Joint that the roles are predicted for: a joint file (TOML), or the name of a preset
    #[arg(long, value_name = "FILE", default_value = "q1")]
    joint: PathBuf,
}

/// Checks a board file, or lists the presets.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    match &arguments.action {
        Action::Check(check) => {
            let description = named::load(&check.file)?.board;
            let joint = joint_file::named::load(&check.joint)?.file.parameters;
            let board =
                TargetBoard { argument: check.file.display().to_string(), file: check.file.clone(), description };
            let mut page = board_page(&board.description);
            add_roles(&mut page, &board, &joint);
            let shown = terminal(&page.document());
            let warnings = board.description.warnings.iter().map(|warning| format!("warning: {warning}\n"));
            output::print(&(shown + &warnings.collect::<String>()))
        }
        Action::List => {
            let mut page = Sheet::new("Boards".to_owned());
            page.heading("With a file in boards/");
            for name in PRESETS {
                let board = named::load(name.as_ref())?.board;
                page.row(name, format!("{}: {}", board.chip_name, board.description));
            }
            output::print(&terminal(&page.document()))
        }
    }
}

/// Adds the predicted fit of each role, in size and in time.
fn add_roles(page: &mut Sheet, board: &TargetBoard, joint: &JointParameters) {
    page.heading(&format!("Roles for {}, predicted: no image is built", joint.name));
    for role in ImageRole::value_variants() {
        let Some(value) = role.to_possible_value() else { continue };
        let verdict = match (role, board.description.can_line()) {
            (ImageRole::SpiObserver, _) if !board.has_spi_slave() => {
                "not on this board: its file has no [spi_slave]".to_owned()
            }
            (ImageRole::Drive, Err(why)) => format!("not on this board: {why}"),
            _ => role.predict(joint, board, role.default_rate(joint, board)).to_string(),
        };
        page.row(value.get_name(), verdict);
    }
    page.row("predicted from", ORIGIN);
}

fn board_page(board: &Board) -> Sheet {
    let mut page = Sheet::new(match board.description.as_str() {
        "" => board.name.to_string(),
        description => format!("{}: {description}", board.name),
    });
    page.heading("Chip");
    page.row("order name", &board.chip_name);
    page.row("core clock", megahertz(board.core_rate()));
    let [first, second] = board.slots();
    page.row("flash", format!("{} KiB, {} KiB for an image", board.flash_bytes >> 10, board.image_bytes() >> 10));
    page.row("stored parameters", format!("at {:#010x} and {:#010x}", first.address, second.address));
    page.row("RAM", format!("{} KiB", board.ram_bytes >> 10));
    page.heading("Clock");
    page.row(
        "source",
        match board.clock {
            ExternalClock::None => "the chip's own oscillator".to_owned(),
            ExternalClock::Crystal(frequency) => format!("crystal of {}, measured before use", megahertz(frequency)),
            ExternalClock::Signal(frequency) => format!("signal of {}, measured before use", megahertz(frequency)),
        },
    );
    page.heading("Pins");
    let serial = &board.serial;
    let line = format!("{}: {} out, {} in, {} baud", serial.unit, serial.send.pin, serial.receive.pin, serial.baud);
    page.row("line to the host", line);
    page.row("supply latch", output(board.supply));
    page.row("enable", output(board.enable));
    page.row("status light", output(board.light));
    page.row(
        "slave on SPI",
        match &board.spi_slave {
            None => "none".to_owned(),
            Some(SpiSlave { unit, select, clock, out, input }) => {
                format!("{unit}: {} select, {} clock, {} out, {} in", select.pin, clock.pin, out.pin, input.pin)
            }
        },
    );
    can_rows(&mut page, board);
    let without_use = board.unused_line_pins();
    if !without_use.is_empty() {
        page.heading("Not used by any image");
        for (key, pin) in without_use {
            page.row(key, pin.to_string());
        }
    }
    page.heading("Never driven");
    for (pin, what) in &board.never_driven {
        page.row(&Pin::to_string(pin), what);
    }
    page
}

/// Pins, rates and transceiver of the CAN line.
fn can_rows(page: &mut Sheet, board: &Board) {
    let Some(can) = &board.can else {
        page.row("CAN", "none");
        return;
    };
    page.row("CAN", format!("{}: {} out, {} in", can.unit, can.send.pin, can.receive.pin));
    page.row("CAN bit rate", bit_rate(can.bitrate, &can.timing));
    if let Some((rate, timing)) = can.data_bitrate.zip(can.data_timing) {
        page.row("CAN data bit rate", bit_rate(rate, &timing));
    }
    page.row("CAN transceiver", can.missing_transceiver().unwrap_or_else(|| "on the board".to_owned()));
    if let Some(sentence) = board.inaccurate_can_clock() {
        page.row("CAN clock", sentence);
    }
}

fn bit_rate(rate: u32, timing: &BitTiming) -> String {
    let BitTiming { prescaler, before, after, .. } = timing;
    let point = f64::from(timing.sample_point()) / 10.0;
    format!(
        "{} kbit/s: prescaler {prescaler}, segments {before} and {after}, sampled at {point} %",
        f64::from(rate) / 1e3
    )
}

fn output(output: Option<Output>) -> String {
    match output {
        None => "none".to_owned(),
        Some(Output { pin, on }) => format!("{pin}, on when {}", if on == Level::High { "high" } else { "low" }),
    }
}

fn megahertz(frequency: u32) -> String {
    format!("{} MHz", f64::from(frequency) / 1e6)
}

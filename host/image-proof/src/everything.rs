//! Second part of `joint hil --check`: the image of every board and the reach of its tick, clippy over the firmware,
//! the proofs about the step on the emulated board, and the tests that need the emulated board.

use std::path::Path;
use std::process::Stdio;

use link::messages::Role;

use crate::roles;
use crate::tick::Exception;
use crate::{board_model, bound, costs, same_bits, sizes, tick, worst_case};
use board::device::board::{Board, Chip};
use board::device::image;
use board::device::lint;
use board::device::tick_time;
use board::device::tool;
use board::device::toolchain::Toolchain;
use joint_file::named;
use report::failure::{Failure, Outcome};
use report::output;
use report::progress::Progress;
use report::workspace::workspace;

/// Runs all checks; the first failure ends them.
pub fn check(tick_rate: u32, progress: &Progress) -> Outcome<()> {
    let say = |line: &str| progress.print_message(line);
    progress.stage("preparing the toolchain");
    let toolchain = Toolchain::prepare(&say)?;
    let joint = named::load(Path::new("q1"))?.file.parameters;
    let mut seen: Vec<Chip> = Vec::new();
    for board in &Board::presets()? {
        // Boards with the same chip differ in pins and clock only, so the roles are checked on the first one.
        let is_first = !seen.contains(&board.chip());
        seen.push(board.chip());
        let control_rate = |role| tick_time::default_control_rate(&joint, board, role);
        let roles = [
            (Role::Plant, tick_rate),
            (Role::Observer, control_rate(Role::Observer)),
            (Role::Loop, control_rate(Role::Loop)),
        ];
        let built = if is_first && image::has_room_for_all(board) { &roles[..] } else { &roles[..1] };
        for &(role, rate) in built {
            let what = format!("role {} for {}", image::role_name(role), board.name());
            progress.stage(&format!("building the image of {what}"));
            let image = image::build_image(&toolchain, &image::preset_file("q1"), board, role, rate, false, &say)?;
            let (flash, ram) = (image.flash_bytes, image.ram_bytes);
            let reach = tick::reach(&image.elf, Exception::SysTick)?;
            tick::check(&reach).map_err(|failure| failure.while_doing(format_args!("image of {what}")))?;
            let (functions, stack) = (reach.functions, tick::stack(&reach));
            sizes::check(board.chip(), image::role_name(role), &image)?;
            progress.clear();
            output::print(&format!(
                "ok       image of {what}: {flash} B of flash, {ram} B of RAM; its tick: {functions} functions, none can \
                 panic, at most {stack} B of stack\n"
            ))?;
        }
        if is_first && board.has_spi_slave() {
            progress.stage("building the image of a slave on SPI");
            let joint = image::preset_file("q1");
            let built = image::build_spi_slave(&toolchain, &joint, board, image::SPI_RATE, false, &say)?;
            sizes::check(board.chip(), "spi-observer", &built)?;
            let bytes = built.flash_bytes;
            progress.clear();
            output::print(&format!("ok       image of a slave on SPI for {}: {bytes} B of flash\n", board.name()))?;
        }
        if let (true, Ok(can)) = (is_first, board.description.can_line()) {
            progress.stage("building the image of a drive on CAN");
            let joint = image::preset_file("q1");
            let drive = image::DriveOnBus { maker: image::usual_maker(can), id: 1 };
            let rate = control_rate(Role::Loop);
            let built = image::build_drive(&toolchain, &joint, board, &drive, rate, false, &say)?;
            sizes::check(board.chip(), image::DRIVE, &built)?;
            // The timer's interrupt requests the tick, which is the handler of PendSV.
            let mut found = Vec::new();
            for exception in [Exception::SysTick, Exception::PendSv] {
                let reach = tick::reach(&built.elf, exception)?;
                let place = format_args!("image of a drive on CAN for {}", board.name());
                tick::check(&reach).map_err(|failure| failure.while_doing(place))?;
                found.push((reach.functions, tick::stack(&reach)));
            }
            let functions: usize = found.iter().map(|(functions, _)| functions).sum();
            let stack: u32 = found.iter().map(|(_, stack)| stack).sum();
            let (flash, ram) = (built.flash_bytes, built.ram_bytes);
            progress.clear();
            output::print(&format!(
                "ok       image of a drive on CAN for {}: {flash} B of flash, {ram} B of RAM; its tick: {functions} functions, \
                 none can panic, at most {stack} B of stack\n",
                board.name()
            ))?;
        }
        if !is_first {
            continue;
        }
        progress.stage(&format!("linting the firmware for {}", board.name()));
        lint::clippy(&toolchain, board, &say)?;
        progress.clear();
        output::print(&format!("ok       clippy for {}\n", board.name()))?;
    }
    proofs(&toolchain, progress)?;
    board_model::prepare(progress)?;
    // Each keeps about one core busy.
    std::thread::scope(|scope| {
        let model = scope.spawn(board_model::check);
        let tests = emulator_tests();
        tests.and(model.join().unwrap_or_else(|_| Err(Failure::new("the check on the model of the boards panicked"))))
    })
}

/// Equal bits, instructions and worst case, of this program against the emulated board.
fn proofs(toolchain: &Toolchain, progress: &Progress) -> Outcome<()> {
    let say = |line: &str| progress.print_message(line);
    progress.stage("comparing bits between the emulated board and this program");
    let runs = same_bits::compare(&same_bits::on_board(toolchain, &say)?)?;
    progress.clear();
    output::print(&format!("ok       {runs} runs of the step, equal in every bit on the board and on this host\n"))?;
    progress.stage("searching for the worst case on the emulated board");
    let elf = worst_case::build(toolchain, &say)?;
    let found = worst_case::search(&elf)?;
    progress.clear();
    for search in &found {
        output::print(&format!("{search}\n"))?;
    }
    progress.stage("bounding the step from its machine code");
    let bounds = bound::bound_steps(&elf, &found)?;
    let lines = bound::check(&bounds, &found)?;
    progress.clear();
    output::print(&format!("{}\nok       no state exceeds its bound\n", lines.join("\n")))?;
    progress.stage("counting instructions on the emulated board");
    let lines = costs::check(&costs::count(toolchain, &say)?, &found, &bounds)?;
    progress.clear();
    output::print(&format!("{}\nok       instructions as predicted\n", lines.join("\n")))?;
    worst_case::check(&found)?;
    progress.stage("counting the instructions of the roles on the emulated board");
    let loads = roles::count(toolchain, &say)?;
    progress.clear();
    for load in &loads {
        output::print(&format!("{load}\n"))?;
    }
    roles::check(&loads)?;
    output::print("ok       roles within their control period\n")?;
    output::print("ok       worst case of a step within its budget\n")
}

/// Runs the tests that `cargo test` ignores, with cargo's own output; the packages and thus the features are those that
/// `cargo test` has just built.
fn emulator_tests() -> Outcome<()> {
    let status = tool::cargo()
        .arg("test")
        .args(["emulated_board", "same_bits", "tick_audit"].iter().flat_map(|name| ["--test", name]))
        .args(["--", "--ignored"])
        .current_dir(workspace())
        .stdin(Stdio::null())
        .status()
        .map_err(|error| Failure::new(format!("cannot run cargo for the tests on the emulated board: {error}")))?;
    match status.success() {
        true => output::print("ok       tests on the emulated board\n"),
        false => Err(Failure::check_failed(format!("tests on the emulated board failed ({status})"))),
    }
}

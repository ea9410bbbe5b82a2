//! Linked images of every role: the tick cannot reach a panic and its stack is bounded; an image that violates this is rejected.

use board::device::board::Board;
use board::device::image::{DriveOnBus, build_drive, build_image, default_drive_rate, preset_file};
use board::device::measuring::build_measuring;
use board::device::toolchain::Toolchain;
use host_tests::extent::is_long;
use image_proof::tick::{self, Exception};
use link::messages::Role;
use virtual_drive::maker::NAMES;

/// No path of the tick ends in a panic, and its stack has a bound.
#[test]
#[ignore = "needs the compiler for the board: run by `cargo joint hil --check`"]
fn tick_cannot_panic_and_bounds_its_stack() {
    let say = |line: &str| println!("{line}");
    let toolchain = Toolchain::prepare(&say).expect("a toolchain for the board");
    for (role, rate) in [(Role::Plant, 20_000), (Role::Observer, 10_000), (Role::Loop, 10_000)] {
        let image = build_image(&toolchain, &preset_file("q1"), &Board::emulated(), role, rate, false, &say);
        let reach = tick::reach(&image.expect("an image").elf, Exception::SysTick).expect("an image that can be read");
        println!("{role:?}: {} B of stack: {:?}", tick::stack(&reach), reach.deepest);
        tick::check(&reach).unwrap_or_else(|failure| panic!("{failure}"));
    }
}

/// No path of a drive's tick ends in a panic, and its stack has a bound: CiA 402, whose server is the largest, or with
/// `LONG_TESTS` every maker. The other makers of the short form are in `cargo joint hil --check`.
#[test]
#[ignore = "needs the compiler for the board: run by `cargo joint hil --check`"]
fn drives_cannot_panic_and_bound_their_stack() {
    let say = |line: &str| println!("{line}");
    let toolchain = Toolchain::prepare(&say).expect("a toolchain for the board");
    let board = Board::presets().expect("boards").into_iter().find(|board| board.name() == "nucleo-g474re");
    let board = board.expect("a board with CAN FD");
    let joint = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint").parameters;
    let mut failures = Vec::new();
    for maker in NAMES.into_iter().filter(|maker| is_long() || maker.word == "cia402") {
        let (drive, rate) = (DriveOnBus { maker, id: 1 }, default_drive_rate(&joint, &board));
        let image = build_drive(&toolchain, &preset_file("q1"), &board, &drive, rate, false, &say).expect("an image");
        for exception in [Exception::SysTick, Exception::PendSv] {
            let reach = tick::reach(&image.elf, exception).expect("an image that can be read");
            println!("{} {exception:?}: {} B of stack: {:?}", maker.word, tick::stack(&reach), reach.deepest);
            failures.extend(tick::check(&reach).err().map(|failure| format!("{}: {failure}", maker.word)));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Planted faults are all found and named.
#[test]
#[ignore = "needs the compiler for the board: run by `cargo joint hil --check`"]
fn planted_faults_are_found_and_named() {
    let say = |line: &str| println!("{line}");
    let toolchain = Toolchain::prepare(&say).expect("a toolchain for the board");
    let elf = build_measuring(&toolchain, "planted_faults", &[], 20_000, &say).expect("an image");
    let failure =
        tick::check(&tick::reach(&elf, Exception::SysTick).expect("an image that can be read")).expect_err("faults");
    println!("{failure}");
    for fault in [
        "may_panic -> core::panicking::panic_bounds_check",
        "the tick can call in a ring: planted_faults::faults::calls_itself",
        "the tick calls through a pointer",
        "takes_stack 3",
    ] {
        assert!(failure.message().contains(fault), "{fault} is not in: {failure}");
    }
    assert_eq!(failure.exit_code(), 1);
}

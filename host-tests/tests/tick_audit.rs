//! Linked images of every role: the tick cannot reach a panic and its stack is bounded; an image that violates this is rejected.

use board::device::board::Board;
use board::device::image::{build_image, preset_file};
use board::device::measuring::build_measuring;
use board::device::toolchain::Toolchain;
use image_proof::tick::{self, Exception};
use link::messages::Role;

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

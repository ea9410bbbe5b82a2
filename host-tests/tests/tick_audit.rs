//! The linked image of the plant role: its tick cannot reach a panic, and its stack is bounded; an image in which that
//! is not so is refused.

use joint::proof::tick;
use joint::target::board::Board;
use joint::target::image::{build_image, preset_file};
use joint::target::toolchain::Toolchain;
use link::messages::Role;

#[test]
#[ignore = "needs the compiler for the board: run by `cargo joint hil --check`"]
fn the_tick_cannot_panic_and_its_stack_is_bounded() {
    let say = |line: &str| println!("{line}");
    let toolchain = Toolchain::prepare(&say).expect("a toolchain for the board");
    let image = build_image(&toolchain, &preset_file("q1"), Board::Stm32f405, Role::Plant, 20_000, &say);
    let reach = tick::reach(&image.expect("an image").elf).expect("an image that can be read");
    println!("{reach:#?}");
    tick::judge(&reach).unwrap_or_else(|failure| panic!("{failure}"));
}

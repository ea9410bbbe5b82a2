//! The step's f32 results are the same in every bit on this host in this build, in the builds that the known digests
//! came from, and on the emulated board, whatever the caller has set the floating-point unit to. The release build is
//! compared with the board by `joint hil --check`.

use joint::proof::same_bits::{compare, on_board};
use joint::target::emulator;
use joint::target::toolchain::Toolchain;

#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn this_build_s_results_are_the_board_s_in_every_bit() {
    let say = |line: &str| println!("{line}");
    let toolchain = Toolchain::prepare(&say).expect("a toolchain for the board");
    emulator::ensure(&say).expect("an emulator");
    let board = on_board(&toolchain, &say).expect("a measurement");
    compare(&board).unwrap_or_else(|failure| panic!("{failure}"));
}

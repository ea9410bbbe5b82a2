//! f32 results of the step agree in every bit between this build, earlier builds and the emulated board, for any state of the caller's
//! floating-point unit. `joint hil --check` compares itself with the board in the same way, and host/c-library/tests/host.rs compares the
//! optimised library with this build.

use std::fs;
use std::path::Path;

use board::device::emulator;
use board::device::toolchain::Toolchain;
use image_proof::joints::TEST_JOINTS;
use image_proof::same_bits::{InMode, compare, on_board, on_host};

/// Digests recorded from earlier builds, on any machine.
const KNOWN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/data/step_digests.csv");
/// Environment variable that rewrites the recorded digests.
const WRITE: &str = "WRITE_STEP_DIGESTS";

fn here(in_mode: InMode<'_>) -> String {
    let digests = TEST_JOINTS.iter().map(|joint| on_host(joint, in_mode).expect("a sound joint"));
    let lines: Vec<_> = digests.map(|digests| format!("{digests}\n")).collect();
    format!("joint,tables,long motion,infinite torques,tiny numbers,contact changes\n{}", lines.concat())
}

/// Digests of the step equal the recorded ones.
#[test]
fn step_digests_equal_recorded_ones() {
    let found = here(&|work| work());
    if std::env::var_os(WRITE).is_some() {
        fs::write(Path::new(KNOWN), &found).expect("a file that can be written");
    }
    let known = fs::read_to_string(KNOWN).expect("the known digests");
    assert!(
        found == known,
        "the step gives other bits than before. If it was changed on purpose, write the digests anew:\n\
         {WRITE}=1 cargo test -p host-tests --test same_bits\nfound:\n{found}known:\n{known}"
    );
}

/// Flush-to-zero and denormals-are-zero of the caller change no bit.
#[test]
#[cfg(target_arch = "x86_64")]
fn flush_to_zero_changes_no_bit() {
    let plain = here(&|work| work());
    for (name, bits) in [("FTZ", 1 << 15), ("DAZ", 1 << 6), ("FTZ and DAZ", 1 << 15 | 1 << 6)] {
        assert_eq!(here(&|work| x86::with_mode(bits, work)), plain, "with {name}");
    }
}

#[test]
#[cfg(not(target_arch = "x86_64"))]
fn flush_to_zero_changes_no_bit() {
    println!("not tried on this processor: only MXCSR of x86-64 is known here; the emulated board is tried anyway");
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::asm;

    /// Runs `work` with additional bits of MXCSR set.
    pub fn with_mode(bits: u32, work: &mut dyn FnMut()) {
        let (mut before, mut unchanged) = (0_u32, 0_u32);
        // SAFETY: stores a register to a place of its size.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut before) };
        let changed = before | bits;
        // SAFETY: only flush-to-zero and denormals-are-zero are added, which a caller in C may have set too; the step under these modes is
        // the subject of the test. Rounding and traps stay unchanged, and the register is restored below.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const changed) };
        work();
        // SAFETY: stores and loads as above; the previous value is restored.
        unsafe { asm!("stmxcsr [{}]", "ldmxcsr [{}]", in(reg) &raw mut unchanged, in(reg) &raw const before) };
        assert_eq!(unchanged & bits, bits, "the mode did not last");
    }
}

/// Results of this build equal the board's in every bit.
#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn board_equals_this_build_in_every_bit() {
    let say = |line: &str| println!("{line}");
    let toolchain = Toolchain::prepare(&say).expect("a toolchain for the board");
    emulator::ensure(&say).expect("an emulator");
    let board = on_board(&toolchain, &say).expect("a measurement");
    compare(&board).unwrap_or_else(|failure| panic!("{failure}"));
}

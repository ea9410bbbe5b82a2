//! Support for binaries that run in the emulator only: SysTick as an instruction counter, lines for the host by
//! semihosting, and an exit that the host can tell from a crash. Not valid on silicon: there SysTick counts cycles, and
//! semihosting waits for a debugger.

use core::fmt;
use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::{debug, hprintln};
use model_core::gears::Tables;

/// SysTick counts per thousand instructions: the host runs the emulator at 64 ns per instruction (`-icount shift=6`)
/// with a timer of 168 MHz. Whole numbers of instructions up to [`LONGEST`] are exact.
const COUNTS_PER_THOUSAND: u64 = 10_752;
/// SysTick has 24 bits.
const COUNTS: u32 = 1 << 24;
/// Greatest number of instructions in one measurement.
pub const LONGEST: u32 = (COUNTS as u64 * 1000 / COUNTS_PER_THOUSAND) as u32;

/// Last line of a complete run.
const END: &str = "end of measurement";

/// Joints of this image: written by the build script for the files that it was given.
pub mod measured {
    #![allow(missing_docs, dead_code, unused_imports, clippy::all, clippy::excessive_precision)]
    include!(concat!(env!("OUT_DIR"), "/measured.rs"));
}

/// Visitor of all joints.
pub trait Visitor {
    /// Visits a joint by name and tables.
    fn joint<const N: usize>(&mut self, name: &str, tables: &'static Tables<f32, N>);
}

/// Counts instructions.
#[derive(Debug)]
pub struct InstructionCounter {
    /// Instructions of an empty measurement.
    own: u32,
}

impl InstructionCounter {
    /// Starts the counter; takes SysTick.
    pub fn start(mut systick: SYST) -> Self {
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(COUNTS - 1);
        systick.clear_current();
        systick.enable_counter();
        let mut counter = Self { own: 0 };
        counter.own = counter.count(|| ());
        counter
    }

    /// Counts the instructions of the work, less those of counting. The work must be a call that is not inlined, or the
    /// compiler may move it out of the measurement.
    #[inline(always)]
    pub fn count(&self, work: impl FnOnce()) -> u32 {
        let before = black_box(SYST::get_current());
        work();
        let after = black_box(SYST::get_current());
        // SysTick counts down and wraps.
        let counts = u64::from(before.wrapping_sub(after) % COUNTS);
        let instructions = (counts * 1000 + COUNTS_PER_THOUSAND / 2) / COUNTS_PER_THOUSAND;
        (instructions as u32).saturating_sub(self.own)
    }
}

/// Prints a line on the host.
pub fn print_line(line: fmt::Arguments<'_>) {
    hprintln!("{}", line);
}

/// Ends the emulator: the measurement is complete.
pub fn finish() -> ! {
    hprintln!("{}", END);
    end(debug::EXIT_SUCCESS)
}

fn end(status: debug::ExitStatus) -> ! {
    loop {
        debug::exit(status);
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    end(debug::EXIT_FAILURE)
}

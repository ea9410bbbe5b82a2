//! For binaries that run in the emulator alone: SysTick as a counter of instructions, lines for the host by
//! semihosting, and an end that the host can tell from a crash. On silicon none of it holds: there SysTick counts
//! cycles, and semihosting waits for a debugger.

use core::fmt;
use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::{debug, hprintln};
use model_core::gears::Tables;

/// SysTick counts in a thousand instructions: the host runs the emulator at 64 ns an instruction (`-icount shift=6`)
/// beside a timer of 168 MHz. A whole number of instructions is then found exactly, up to [`LONGEST`].
const COUNTS_PER_THOUSAND: u64 = 10_752;
/// SysTick has 24 bits.
const COUNTS: u32 = 1 << 24;
/// Most instructions that can be counted in one go.
pub const LONGEST: u32 = (COUNTS as u64 * 1000 / COUNTS_PER_THOUSAND) as u32;

/// Last line of a run that came to its end.
const END: &str = "end of measurement";

/// The joints of this image: written by the build script for the files that it was told.
pub mod measured {
    #![allow(missing_docs, dead_code, unused_imports, clippy::all, clippy::excessive_precision)]
    include!(concat!(env!("OUT_DIR"), "/measured.rs"));
}

/// Sees one joint after the other.
pub trait Visitor {
    /// Its name and tables.
    fn joint<const N: usize>(&mut self, name: &str, tables: &'static Tables<f32, N>);
}

/// Counts instructions.
#[derive(Debug)]
pub struct InstructionCounter {
    /// What it takes to count nothing.
    own: u32,
}

impl InstructionCounter {
    /// Takes SysTick for itself.
    pub fn start(mut systick: SYST) -> Self {
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(COUNTS - 1);
        systick.clear_current();
        systick.enable_counter();
        let mut counter = Self { own: 0 };
        counter.own = counter.count(|| ());
        counter
    }

    /// Instructions that the work takes, less what counting takes. The work must be a call that is not inlined, or the
    /// compiler may move it out of the measurement.
    #[inline(always)]
    pub fn count(&self, work: impl FnOnce()) -> u32 {
        let before = black_box(SYST::get_current());
        work();
        let after = black_box(SYST::get_current());
        // It counts down and wraps.
        let counts = u64::from(before.wrapping_sub(after) % COUNTS);
        let instructions = (counts * 1000 + COUNTS_PER_THOUSAND / 2) / COUNTS_PER_THOUSAND;
        (instructions as u32).saturating_sub(self.own)
    }
}

/// Prints a line on the host.
pub fn say(line: fmt::Arguments<'_>) {
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

#![cfg_attr(target_os = "none", no_std, no_main)]
//! Digests of the trial motions of every joint of this image, for each floating-point mode that a caller may have set.

#[cfg(target_os = "none")]
mod measurement {
    use core::arch::asm;

    use cortex_m_rt::entry;
    use firmware::measuring::{self, Visitor, measured};
    use model_core::gears::Tables;
    use stimuli::motion;

    /// Bits of FPSCR: flush denormal results and operands to zero; default NaN.
    const FLUSH_TO_ZERO: u32 = 1 << 24;
    const DEFAULT_NAN: u32 = 1 << 25;
    const MODES: [u32; 4] = [0, FLUSH_TO_ZERO, DEFAULT_NAN, FLUSH_TO_ZERO | DEFAULT_NAN];

    struct Digests;

    impl Visitor for Digests {
        fn joint<const N: usize>(&mut self, name: &str, tables: &'static Tables<f32, N>) {
            for mode in MODES {
                set_mode(mode);
                let motion::Digests { long, unbounded, tiny, changes } = motion::digests(tables);
                let (flush, default_nan) = (mode & FLUSH_TO_ZERO != 0, mode & DEFAULT_NAN != 0);
                measuring::print_line(format_args!(
                    "{name},{flush},{default_nan},{:016x},{long:016x},{unbounded:016x},{tiny:016x},{changes}",
                    tables.digest
                ));
            }
        }
    }

    #[entry]
    fn main() -> ! {
        measured::visit(&mut Digests);
        measuring::finish()
    }

    fn set_mode(mode: u32) {
        // SAFETY: these two bits only change the results of floating-point instructions, as the trial intends; rounding
        // stays to nearest.
        unsafe { asm!("vmsr fpscr, {mode}", mode = in(reg) mode) };
    }
}

/// Empty on a host.
#[cfg(not(target_os = "none"))]
fn main() {}

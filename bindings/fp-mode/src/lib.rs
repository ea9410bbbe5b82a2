#![no_std]
//! Standard mode of the floating-point unit: round to nearest, subnormals kept, NaN propagated, no traps. A caller may
//! have set another mode (`-ffast-math` does); each function sets the standard mode and restores the caller's. A thread
//! begins in the mode of the thread that started it.

use unit::{enter, leave};

/// Runs work in the standard mode.
#[inline(always)]
pub fn standard<R>(work: impl FnOnce() -> R) -> R {
    let before = enter();
    let result = work();
    leave(before);
    result
}

#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
mod unit {
    use core::arch::asm;

    /// FPSCR: alternative half precision, default NaN, flush to zero, rounding.
    const MODES: u32 = 0b11111 << 22;

    #[inline(always)]
    pub fn enter() -> u32 {
        let before: u32;
        // SAFETY: reads a register that every caller with hardware floating point may read.
        unsafe { asm!("vmrs {}, fpscr", out(reg) before) };
        if before & MODES != 0 {
            // SAFETY: sets the mode that this code was compiled for; `leave` restores the caller's.
            unsafe { asm!("vmsr fpscr, {}", in(reg) before & !MODES) };
        }
        before
    }

    #[inline(always)]
    pub fn leave(before: u32) {
        if before & MODES != 0 {
            // SAFETY: restores the caller's mode.
            unsafe { asm!("vmsr fpscr, {}", in(reg) before) };
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod unit {
    use core::arch::asm;

    /// MXCSR: everything masked, nearest, subnormals kept.
    const STANDARD: u32 = 0x1f80;

    #[inline(always)]
    pub fn enter() -> u32 {
        let (mut before, standard) = (0_u32, STANDARD);
        // SAFETY: stores a register to a place of its size, and loads it with the mode that this code was compiled for.
        unsafe { asm!("stmxcsr [{}]", "ldmxcsr [{}]", in(reg) &raw mut before, in(reg) &raw const standard) };
        before
    }

    #[inline(always)]
    pub fn leave(before: u32) {
        // SAFETY: restores the caller's mode.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const before) };
    }
}

#[cfg(target_arch = "aarch64")]
mod unit {
    use core::arch::asm;

    #[inline(always)]
    pub fn enter() -> u64 {
        let before: u64;
        // SAFETY: FPCR zero is the mode that this code was compiled for.
        unsafe { asm!("mrs {}, fpcr", "msr fpcr, xzr", out(reg) before) };
        before
    }

    #[inline(always)]
    pub fn leave(before: u64) {
        // SAFETY: restores the caller's mode.
        unsafe { asm!("msr fpcr, {}", in(reg) before) };
    }
}

#[cfg(not(any(all(target_arch = "arm", target_abi = "eabihf"), target_arch = "x86_64", target_arch = "aarch64")))]
compile_error!(
    "the mode of this processor's floating-point unit is not known here: add it to bindings/fp-mode/src/lib.rs"
);

//! Whether what drives the clock from outside can be trusted: it is measured in terms of the internal oscillator before the core
//! runs from it. A board with another crystal than its file says would run too fast, or have no line.

use link::messages::{Clock, ClockSource};

use super::bounded_wait::wait_until;
use super::pac;

/// Measures the external clock.
#[cfg(family = "stm32f4")]
pub type CaptureTimer = pac::TIM11;
/// Measures the external clock.
#[cfg(not(family = "stm32f4"))]
pub type CaptureTimer = pac::TIM17;

/// The chip's own oscillator.
pub struct Internal {
    /// What it runs at [Hz].
    pub rate: u32,
    /// What it is exact to [ppm].
    pub tolerance: u32,
}

/// What the board's file says of it, and what was found.
pub struct External {
    /// As the file says [Hz].
    pub frequency: u32,
    /// It comes from elsewhere, and is no crystal.
    pub is_signal: bool,
    /// As measured [Hz]; nothing if it did not start.
    pub measured: Option<u32>,
}

/// What a crystal is exact to, or a clock from elsewhere, which is one of somebody's [ppm].
const EXTERNAL_TOLERANCE: u32 = 100;

/// What the core clock is made of, before the PLL has been tried.
pub fn judged(external: Option<External>, internal: &Internal) -> Clock {
    let source = match external {
        None => ClockSource::Internal,
        Some(External { measured: None, .. }) => ClockSource::DidNotStart,
        Some(External { frequency, measured: Some(measured), .. }) if !is_near(frequency, measured) => {
            ClockSource::OtherFrequency { measured }
        }
        Some(External { is_signal: true, .. }) => ClockSource::Signal,
        Some(_) => ClockSource::Crystal,
    };
    let tolerance = if source.is_external() { EXTERNAL_TOLERANCE } else { internal.tolerance };
    Clock { source, tolerance }
}

/// Part of a frequency that what is measured may differ by [ppm]: crystals in use (24, 25 and 26 MHz) lie four percent apart, and at
/// room temperature the internal oscillator is exact to one.
const NEAR: u64 = 30_000;

fn is_near(frequency: u32, measured: u32) -> bool {
    u64::from(frequency.abs_diff(measured)) * 1_000_000 <= u64::from(frequency) * NEAR
}

/// What the timer catches: every eighth rising edge (3) of its input (1).
const CATCH: u32 = 1 | 3 << 2;
const PERIODS: u32 = 8;
/// So many times.
const TIMES: u32 = 16;

/// The external clock [Hz], by a timer that runs at the internal oscillator's rate and whose input is that clock, divided.
/// 0 if nothing comes.
pub fn measure(timer: &CaptureTimer, divider: u32, internal: &Internal) -> u32 {
    // SAFETY: any count may be the last before 0, and the timer may catch what it likes.
    unsafe {
        timer.arr().write(|w| w.bits(0xffff));
        timer.ccmr1_input().write(|w| w.bits(CATCH));
    }
    timer.egr().write(|w| w.ug().set_bit());
    timer.ccer().write(|w| w.cc1e().set_bit());
    timer.cr1().write(|w| w.cen().set_bit());
    let catch = || {
        let caught = wait_until(|| timer.sr().read().cc1if().bit_is_set());
        // Reading the count takes the flag back.
        caught.then(|| timer.ccr1().read().bits() as u16)
    };
    // The first begins anywhere.
    let mut last = catch().and_then(|_| catch());
    let mut counts = 0;
    for _ in 0..TIMES {
        let next = catch();
        let (Some(from), Some(to)) = (last, next) else { return 0 };
        counts += u32::from(to.wrapping_sub(from));
        last = next;
    }
    timer.cr1().write(|w| w.cen().clear_bit());
    let periods = u64::from(TIMES * PERIODS * divider);
    (u64::from(internal.rate) * periods).checked_div(counts.into()).unwrap_or(0) as u32
}

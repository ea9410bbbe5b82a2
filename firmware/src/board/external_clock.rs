//! Check of the external clock: its frequency is measured with the internal oscillator before the core runs from it.
//! With another crystal than in the board file the board would run too fast, or have no serial line.

use link::messages::{Clock, ClockSource};

use super::bounded_wait::wait_until;
use super::pac;

/// Measures the external clock.
#[cfg(family = "stm32f4")]
pub type CaptureTimer = pac::TIM11;
/// Measures the external clock.
#[cfg(not(family = "stm32f4"))]
pub type CaptureTimer = pac::TIM17;

/// Internal oscillator of the chip.
pub struct Internal {
    /// Frequency [Hz].
    pub rate: u32,
    /// Tolerance [ppm].
    pub tolerance: u32,
}

/// External clock by the board file and by measurement.
pub struct External {
    /// Frequency by the board file [Hz].
    pub frequency: u32,
    /// The clock is an external signal, not a crystal.
    pub is_signal: bool,
    /// Measured frequency [Hz]; `None` if the clock did not start.
    pub measured: Option<u32>,
}

/// Tolerance of a crystal or of an external signal [ppm].
const EXTERNAL_TOLERANCE: u32 = 100;

/// Source of the core clock by the measurement, before the PLL starts.
pub fn select_clock(external: Option<External>, internal: &Internal) -> Clock {
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

/// Largest relative difference between measured and stated frequency [ppm]: crystals in use (24, 25 and 26 MHz) differ
/// by four percent, and at room temperature the internal oscillator is exact to one percent.
const NEAR: u64 = 30_000;

fn is_near(frequency: u32, measured: u32) -> bool {
    u64::from(frequency.abs_diff(measured)) * 1_000_000 <= u64::from(frequency) * NEAR
}

/// Capture setting of the timer: every eighth rising edge (3) of its input (1).
const CATCH: u32 = 1 | 3 << 2;
const PERIODS: u32 = 8;
/// Number of captures.
const TIMES: u32 = 16;

/// Measures the external clock [Hz] with a timer that runs from the internal oscillator and captures the divided
/// external clock. Returns 0 without edges.
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
        // Reading the count clears the flag.
        caught.then(|| timer.ccr1().read().bits() as u16)
    };
    // The first interval is incomplete.
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

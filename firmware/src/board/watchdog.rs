//! Independent watchdog, equal on all boards: resets the board if it is not fed for half a second. Idle feeds it. The
//! emulated board has no watchdog; writes have no effect there.

use super::bounded_wait::wait_until;
use super::pac::IWDG;

/// Time to the reset [ms].
const COUNTS: u16 = 500;

/// Counts to the reset while flash is written, which may block the core for seconds; a count is then eight
/// milliseconds.
const WRITING: u16 = 1000;

/// Running watchdog.
pub struct Watchdog(IWDG);

impl Watchdog {
    /// Starts the watchdog, which cannot be stopped.
    pub fn start(registers: IWDG) -> Self {
        registers.kr().write(|w| w.key().start());
        registers.kr().write(|w| w.key().unlock());
        // The 32 kHz oscillator by 32: a count is a millisecond.
        registers.pr().write(|w| w.pr().divide_by32());
        registers.rlr().write(|w| w.rl().set(COUNTS));
        // If the settings fail, the longest time stays in force, which is harmless.
        let _ = wait_until(|| registers.sr().read().bits() == 0);
        let mut watchdog = Self(registers);
        watchdog.feed();
        watchdog
    }

    /// Extends the time during a flash write, then restores it.
    pub fn while_writing<T>(&mut self, write: impl FnOnce() -> T) -> T {
        self.0.kr().write(|w| w.key().unlock());
        self.0.pr().write(|w| w.pr().divide_by256());
        self.0.rlr().write(|w| w.rl().set(WRITING));
        let _ = wait_until(|| self.0.sr().read().bits() == 0);
        self.feed();
        let written = write();
        self.0.kr().write(|w| w.key().unlock());
        self.0.pr().write(|w| w.pr().divide_by32());
        self.0.rlr().write(|w| w.rl().set(COUNTS));
        let _ = wait_until(|| self.0.sr().read().bits() == 0);
        self.feed();
        written
    }

    /// Feeds the watchdog.
    pub fn feed(&mut self) {
        self.0.kr().write(|w| w.key().feed());
    }
}

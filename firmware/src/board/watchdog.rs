//! The independent watchdog, the same on all boards: resets the board when it is not fed for half a second. Idle
//! feeds it. The emulated board has none: there the writes have no effect.

use super::bounded_wait::wait_until;
use super::pac::IWDG;

/// Milliseconds to the reset.
const COUNTS: u16 = 500;

/// Counts while flash is written, which may hold the core up for seconds; a count is then eight milliseconds.
const WRITING: u16 = 1000;

/// A running watchdog.
pub struct Watchdog(IWDG);

impl Watchdog {
    /// Starts it. It cannot be stopped again.
    pub fn start(registers: IWDG) -> Self {
        registers.kr().write(|w| w.key().start());
        registers.kr().write(|w| w.key().unlock());
        // The 32 kHz oscillator by 32: a count is a millisecond.
        registers.pr().write(|w| w.pr().divide_by32());
        registers.rlr().write(|w| w.rl().set(COUNTS));
        // Settings that were not taken up leave its longest time in force: no harm.
        let _ = wait_until(|| registers.sr().read().bits() == 0);
        let mut watchdog = Self(registers);
        watchdog.feed();
        watchdog
    }

    /// Allows a longer time while flash is written, then the usual one.
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

    /// Puts the reset off.
    pub fn feed(&mut self) {
        self.0.kr().write(|w| w.key().feed());
    }
}

//! Status light: slow blinking when stopped, quick blinking in a run, three flashes and a pause in the safe state. The
//! caller provides time and state.

use core::convert::Infallible;
use core::sync::atomic::Ordering::Relaxed;

use embedded_hal::digital::OutputPin;

use crate::queues::Progress;

/// Pattern of the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pattern {
    /// Ready for a run.
    Stopped,
    /// Run in progress.
    Running,
    /// Safe state.
    Tripped,
}

impl Pattern {
    /// Returns the pattern for the progress of a run.
    pub fn of(progress: &Progress) -> Self {
        if progress.tripped.load(Relaxed) {
            Self::Tripped
        } else if progress.running.load(Relaxed) {
            Self::Running
        } else {
            Self::Stopped
        }
    }

    /// Returns `true` if the light is on at a time [ms].
    pub fn is_on(self, milliseconds: u32) -> bool {
        match self {
            Self::Stopped => milliseconds % 2000 < 1000,
            Self::Running => milliseconds % 200 < 100,
            Self::Tripped => milliseconds % 1500 < 900 && milliseconds % 300 < 150,
        }
    }
}

/// Status light on an output.
#[derive(Debug)]
pub struct StatusLight<P> {
    output: P,
}

impl<P: OutputPin<Error = Infallible>> StatusLight<P> {
    /// Status light on this output, initially off.
    pub fn new(mut output: P) -> Self {
        let Ok(()) = output.set_low();
        Self { output }
    }

    /// Sets the light by the pattern at a time [ms].
    pub fn show(&mut self, pattern: Pattern, milliseconds: u32) {
        let Ok(()) = self.output.set_state(pattern.is_on(milliseconds).into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flashes(pattern: Pattern, milliseconds: u32) -> usize {
        (1..milliseconds).filter(|&time| pattern.is_on(time) && !pattern.is_on(time - 1)).count()
    }

    #[test]
    fn flash_counts_distinct() {
        assert_eq!(flashes(Pattern::Stopped, 6000), 2);
        assert_eq!(flashes(Pattern::Running, 6000), 29);
        assert_eq!(flashes(Pattern::Tripped, 6000), 11);
    }
}

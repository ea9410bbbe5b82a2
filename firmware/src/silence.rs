//! How long the host has not been heard of, in ticks of the board's own clock: whatever was sent before, and whether the tick
//! steps or waits.

/// What is known of the host in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Host {
    /// It has said something since the tick before.
    HasSpoken,
    /// It was heard of within the timeout.
    IsThere,
    /// It was not.
    IsSilent,
}

/// Counts the ticks without a frame, in a run or not.
#[derive(Debug, Clone)]
pub struct Silence {
    timeout: u32,
    /// Ticks in a row without a frame.
    quiet: u32,
    /// Frames heard so far.
    frames: u32,
}

impl Silence {
    /// From power-up on; silent in the `timeout`'th tick in a row without a frame.
    pub const fn new(timeout: u32) -> Self {
        Self { timeout, quiet: 0, frames: 0 }
    }

    /// A run with a timeout of its own is about to begin in this tick; `false` if that is over with it, so many frames having
    /// been heard: idle has been long about the reset.
    pub fn allows(&mut self, timeout: u32, frames: u32) -> bool {
        let in_time = frames != self.frames || self.quiet.saturating_add(1) < timeout;
        if in_time {
            self.timeout = timeout;
        }
        in_time
    }

    /// A tick that finds so many frames heard; the count wraps.
    #[inline]
    pub fn after(&mut self, frames: u32) -> Host {
        if frames != self.frames {
            (self.frames, self.quiet) = (frames, 0);
            return Host::HasSpoken;
        }
        self.quiet = self.quiet.saturating_add(1);
        if self.quiet >= self.timeout { Host::IsSilent } else { Host::IsThere }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_begins_anew_with_every_frame_and_the_count_may_wrap() {
        let mut silence = Silence::new(3);
        for frames in [u32::MAX, 0, 1, 2] {
            assert_eq!(silence.after(frames), Host::HasSpoken);
            assert_eq!([silence.after(frames), silence.after(frames)], [Host::IsThere; 2]);
        }
        assert_eq!([silence.after(2), silence.after(2)], [Host::IsSilent; 2]);
        assert_eq!(silence.after(3), Host::HasSpoken);
    }

    #[test]
    fn a_run_begins_by_a_frame_of_late_only() {
        let mut silence = Silence::new(3);
        assert!(silence.allows(2, 1), "the reset has just been heard");
        assert_eq!(silence.after(1), Host::HasSpoken);
        assert!(silence.allows(2, 1));
        assert_eq!(silence.after(1), Host::IsThere);
        assert!(!silence.allows(2, 1) && silence.allows(3, 1));
        assert_eq!(silence.after(1), Host::IsThere);
        assert!(!silence.allows(3, 1));
    }
}

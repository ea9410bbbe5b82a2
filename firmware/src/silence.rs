//! Detection of a silent host, in ticks of the board's own clock, independent of message types and of steps.

/// State of the host in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Host {
    /// A frame has arrived since the last tick.
    HasSpoken,
    /// The last frame is more recent than the timeout.
    IsThere,
    /// No frame has arrived within the timeout.
    IsSilent,
}

/// Counts ticks without a frame, inside and outside of runs.
#[derive(Debug, Clone)]
pub struct Silence {
    timeout: u32,
    /// Ticks in a row without a frame.
    quiet: u32,
    /// Frames heard so far.
    frames: u32,
}

impl Silence {
    /// State at power-up; the host is silent in the `timeout`-th tick in a row without a frame.
    pub const fn new(timeout: u32) -> Self {
        Self { timeout, quiet: 0, frames: 0 }
    }

    /// Sets the timeout of a run that begins in this tick; `frames` is the number of frames so far. Returns `false` if
    /// this timeout has already elapsed, because idle took long to handle the reset.
    pub fn allows(&mut self, timeout: u32, frames: u32) -> bool {
        let in_time = frames != self.frames || self.quiet.saturating_add(1) < timeout;
        if in_time {
            self.timeout = timeout;
        }
        in_time
    }

    /// Updates the state in a tick with `frames` frames so far; the count wraps.
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

    /// Also if the tick count wraps.
    #[test]
    fn frame_restarts_silence() {
        let mut silence = Silence::new(3);
        for frames in [u32::MAX, 0, 1, 2] {
            assert_eq!(silence.after(frames), Host::HasSpoken);
            assert_eq!([silence.after(frames), silence.after(frames)], [Host::IsThere; 2]);
        }
        assert_eq!([silence.after(2), silence.after(2)], [Host::IsSilent; 2]);
        assert_eq!(silence.after(3), Host::HasSpoken);
    }

    #[test]
    fn only_recent_frame_starts_run() {
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

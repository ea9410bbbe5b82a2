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

/// Counts the ticks without a frame.
#[derive(Debug, Clone)]
pub struct Silence {
    timeout: u32,
    /// Ticks left until the timeout is over.
    left: u32,
    /// Frames heard so far.
    frames: u32,
}

impl Silence {
    /// From now on, so many frames having been heard; silent in the `timeout`'th tick in a row without another.
    pub fn new(timeout: u32, frames: u32) -> Self {
        Self { timeout, left: timeout, frames }
    }

    /// A tick that finds so many frames heard; the count wraps.
    #[inline]
    pub fn after(&mut self, frames: u32) -> Host {
        if frames != self.frames {
            (self.frames, self.left) = (frames, self.timeout);
            return Host::HasSpoken;
        }
        self.left = self.left.saturating_sub(1);
        if self.left == 0 { Host::IsSilent } else { Host::IsThere }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_begins_anew_with_every_frame_and_the_count_may_wrap() {
        let mut silence = Silence::new(3, u32::MAX);
        for frames in [0, 1, 2] {
            assert_eq!(silence.after(frames), Host::HasSpoken);
            assert_eq!([silence.after(frames), silence.after(frames)], [Host::IsThere; 2]);
        }
        assert_eq!([silence.after(2), silence.after(2)], [Host::IsSilent; 2]);
        assert_eq!(silence.after(3), Host::HasSpoken);
    }

    #[test]
    fn a_run_in_which_nothing_is_heard_is_silent_in_time() {
        let mut silence = Silence::new(3, 7);
        assert_eq!(
            [silence.after(7), silence.after(7), silence.after(7)],
            [Host::IsThere, Host::IsThere, Host::IsSilent]
        );
    }
}

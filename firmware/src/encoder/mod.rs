//! Encoder drivers: sources of counts for the observer, and the failures of a reading. Each type of encoder has a file
//! of its own.

mod as5047p;

use core::fmt;

pub use as5047p::As5047p;
use model_core::observer::Reading;

/// Source of one reading per control tick.
pub trait CountSource {
    /// Counts per turn, after which counts wrap.
    const COUNTS_PER_TURN: u32;

    /// Returns the newest reading; `now` is the time of the call in ticks of the observer's clock.
    fn read(&mut self, now: u32) -> Result<Reading, EncoderFault>;
}

/// Reason for a tick without reading; the observer gets no reading then.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EncoderFault {
    /// The bus could not transfer.
    Bus,
    /// No answer: the line stays at one level.
    Missing,
    /// The answer's parity is wrong.
    Parity,
    /// The encoder reports an error; content of its error register, if it is known.
    Reported(u16),
    /// The magnet's field is too weak: too far away, or the wrong magnet.
    MagnetTooWeak,
    /// The magnet's field is too strong: too near.
    MagnetTooStrong,
    /// No magnet or no rotating shaft in front of the encoder.
    MagnetLost,
    /// No angle was requested in the last tick: the next tick provides it.
    Pending,
}

impl fmt::Display for EncoderFault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus => formatter.write_str("the encoder's bus could not transfer: look at its set-up"),
            Self::Missing => formatter.write_str("no encoder answers: look at its supply, chip select and data line"),
            Self::Parity => formatter.write_str("the encoder's answer has a wrong parity: shorten the line or slow it"),
            Self::Reported(flags) => write!(formatter, "the encoder reports an error (register {flags:#06x})"),
            Self::MagnetTooWeak => formatter.write_str("the encoder's magnet is too weak: bring it nearer"),
            Self::MagnetTooStrong => formatter.write_str("the encoder's magnet is too strong: move it away"),
            Self::MagnetLost => {
                formatter.write_str("the encoder sees no magnet: look whether it is still in its place")
            }
            Self::Pending => formatter.write_str("the encoder has not been asked for an angle yet"),
        }
    }
}

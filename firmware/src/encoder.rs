//! Encoder drivers: sources of counts for the observer, and the ways in which a reading can fail. Each kind of encoder has a
//! file of its own.

mod as5047p;

use core::fmt;

pub use as5047p::As5047p;
use model_core::observer::Reading;

/// Gives a reading once a control tick.
pub trait CountSource {
    /// Counts in a turn, after which they wrap.
    const COUNTS_PER_TURN: u32;

    /// The newest reading; `now` is the time at which it is asked for, in ticks of the observer's clock.
    fn read(&mut self, now: u32) -> Result<Reading, EncoderFault>;
}

/// Why there is no reading in this tick. The observer is then given none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EncoderFault {
    /// The bus could not transfer.
    Bus,
    /// Nothing answers: the line stays at one level.
    Missing,
    /// The answer's parity is wrong.
    Parity,
    /// The encoder reports an error; its error register as far as it is known.
    Reported(u16),
    /// The magnet's field is too weak: too far away, or the wrong magnet.
    MagnetTooWeak,
    /// The magnet's field is too strong: too near.
    MagnetTooStrong,
    /// There is no magnet, or nothing that turns before the encoder.
    MagnetLost,
    /// No angle was asked for in the tick before: the next one brings it.
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

//! The other end of SPI: a chip that observes and compensates as the slave of a motor controller. After every transfer
//! it takes the frame that came, works on it, and has the answer ready for the next; a transfer that broke costs that
//! answer only.

use core::fmt;

use super::ControllerPort;
use super::spi::{FRAME_BYTES, Frame, SpiGuest};

/// The hardware of a slave: frames of one length, moved without the core while the master clocks.
pub trait SlaveBus {
    /// After the master has ended a transfer: the frame that came in. Whatever happened, the next [`SlaveBus::arm`] begins
    /// anew.
    fn finish(&mut self) -> Result<&Frame, Broken>;

    /// The next transfer brings this frame.
    fn arm(&mut self, next: &Frame);
}

/// Why a transfer received no frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Broken {
    /// The master ended it early: so many bytes were missing.
    Short(u16),
    /// Bytes came faster than they could be taken, or more of them than a frame has.
    Overrun,
}

impl fmt::Display for Broken {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short(bytes) => {
                write!(formatter, "a transfer ended {bytes} bytes early: the master's frames are too short")
            }
            Self::Overrun => {
                formatter.write_str("bytes were lost in a transfer: slow the master's clock, or shorten its frames")
            }
        }
    }
}

/// What became of the transfers so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Transfers {
    /// Answered.
    pub answered: u32,
    /// With a wrong checksum, or no frame of ours.
    pub damaged: u32,
    /// Ended early.
    pub short: u32,
    /// Overrun.
    pub overrun: u32,
}

/// The slave at work.
pub struct SpiSlave<B, P> {
    bus: B,
    guest: SpiGuest<P>,
    transfers: Transfers,
}

impl<B: SlaveBus, P: ControllerPort> SpiSlave<B, P> {
    /// In front of a controller; the first transfer brings an empty frame, which the master finds damaged.
    pub fn new(mut bus: B, controller: P) -> Self {
        bus.arm(&[0; FRAME_BYTES]);
        Self { bus, guest: SpiGuest::new(controller), transfers: Transfers::default() }
    }

    /// After every transfer, when the master lets go of the chip select. The master has to leave as much time before the next
    /// one as a step of observer and compensation takes.
    pub fn serve(&mut self) {
        let counts = &mut self.transfers;
        let (next, count) = match self.bus.finish() {
            Ok(frame) => match self.guest.answer(frame) {
                Some(next) => (next, &mut counts.answered),
                None => ([0; FRAME_BYTES], &mut counts.damaged),
            },
            Err(Broken::Short(_)) => ([0; FRAME_BYTES], &mut counts.short),
            Err(Broken::Overrun) => ([0; FRAME_BYTES], &mut counts.overrun),
        };
        *count = count.saturating_add(1);
        self.bus.arm(&next);
    }

    /// What became of the transfers so far.
    pub fn transfers(&self) -> Transfers {
        self.transfers
    }
}

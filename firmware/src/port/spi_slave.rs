//! SPI slave that runs observer and compensation for a motor controller. After every transfer it processes the received
//! frame and prepares the answer for the next transfer; a broken transfer loses its own answer only.

use core::fmt;

use super::ControllerPort;
use super::spi::{FRAME_BYTES, Frame, SpiGuest};

/// Hardware of a slave: moves frames of fixed length without the core while the master clocks.
pub trait SlaveBus {
    /// Returns the received frame after the master has ended a transfer. After an error, too, the next
    /// [`SlaveBus::arm`] starts afresh.
    fn finish(&mut self) -> Result<&Frame, Broken>;

    /// Sets the frame that the next transfer sends.
    fn arm(&mut self, next: &Frame);
}

/// Reason for a transfer without a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Broken {
    /// The master ended the transfer early; number of missing bytes.
    Short(u16),
    /// Bytes arrived faster than the slave could take them, or more bytes than a frame has.
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

/// Counts of transfers so far, by result.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Transfers {
    /// Answered transfers.
    pub answered: u32,
    /// Frames with a wrong checksum or without valid content.
    pub damaged: u32,
    /// Transfers ended early.
    pub short: u32,
    /// Transfers with lost or surplus bytes.
    pub overrun: u32,
}

/// SPI slave with bus and controller.
pub struct SpiSlave<B, P> {
    bus: B,
    guest: SpiGuest<P>,
    transfers: Transfers,
}

impl<B: SlaveBus, P: ControllerPort> SpiSlave<B, P> {
    /// Slave that uses this controller; the first transfer sends an empty frame, which the master rejects as damaged.
    pub fn new(mut bus: B, controller: P) -> Self {
        bus.arm(&[0; FRAME_BYTES]);
        Self { bus, guest: SpiGuest::new(controller), transfers: Transfers::default() }
    }

    /// Handles a finished transfer; to be called when the master releases chip select. The master must pause before the
    /// next transfer for the time of one step of observer and compensation.
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

    /// Counts of transfers so far, by result.
    pub fn transfers(&self) -> Transfers {
        self.transfers
    }
}

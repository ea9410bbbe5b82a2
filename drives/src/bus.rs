//! A drive on its bus: the protocols answer frames, and send frames of their own accord.

use crate::drive::Drive;
use crate::frame::Frame;
use crate::frame::Send;

/// Drive on a CAN bus as its clients see it.
pub trait CanServer {
    /// Handles a frame from the bus; a frame for another drive is ignored.
    fn receive(&mut self, frame: &Frame, drive: &mut Drive, send: Send<'_>);

    /// Runs once each control period, after [`Drive::step`]: cyclic frames, reactions to faults.
    fn tick(&mut self, drive: &mut Drive, send: Send<'_>);

    /// Notes that the CAN controller went off the bus (`is_off`) or returned. Most makers leave that to their watchdog,
    /// since no frame arrives meanwhile.
    fn bus_off(&mut self, is_off: bool, drive: &mut Drive, send: Send<'_>) {
        let _ = (is_off, drive, send);
    }
}

/// Drive on a serial bus as its clients see it.
pub trait SerialServer {
    /// Handles a byte from the bus; sends whole packets.
    fn receive(&mut self, byte: u8, drive: &mut Drive, send: &mut dyn FnMut(&[u8]));

    /// Runs once each control period, after [`Drive::step`]: answers that had to wait, reactions to faults.
    fn tick(&mut self, drive: &mut Drive, send: &mut dyn FnMut(&[u8]));
}

//! Node on a CAN bus, whatever its registers: joining the bus, error counters, bus-off (ISO 11898-1).

use crate::wires::{Time, Wires};

/// Error count of a warning.
pub const WARNING: u32 = 96;
/// Error count of error passive.
pub const PASSIVE: u32 = 128;
/// Largest error count of a node on the bus.
pub const OFF: u32 = 255;

/// Code of the last error: a recessive bit was read as dominant.
const BIT_ERROR: u32 = 4;
/// Code of the last error: nobody acknowledged.
const NO_ACKNOWLEDGEMENT: u32 = 3;

/// State of a node.
#[derive(Debug, Default)]
pub struct CanNode {
    /// Transmit and receive error counter.
    pub errors: [u32; 2],
    /// Code of the last error; 0 after a good frame.
    pub last_error: u32,
    /// True after bus-off, until the recovery.
    pub is_off: bool,
    /// Time at which the recovery from bus-off ends.
    recovers_at: Option<Time>,
    /// Time at which the node joins the bus: after 11 recessive bits.
    pub joins_at: Option<Time>,
    /// True once the node has joined the bus.
    pub is_active: bool,
    /// True if the bit timing is that of the bus.
    pub is_on_rate: bool,
}

impl CanNode {
    /// Begins to join the bus, after the recovery if the node is off.
    pub fn join(&mut self, wires: &Wires) {
        if self.is_off {
            self.recover(wires);
        }
        self.joins_at = Some(wires.now + wires.can.bits(11));
    }

    /// Leaves the bus.
    pub fn leave(&mut self) {
        (self.is_active, self.joins_at, self.recovers_at) = (false, None, None);
    }

    /// Begins the recovery from bus-off: 128 times 11 recessive bits.
    pub fn recover(&mut self, wires: &Wires) {
        self.recovers_at = Some(wires.now + wires.can.bits(128 * 11));
    }

    /// Ends what is due; a held bus lets nobody join.
    pub fn pass_time(&mut self, wires: &Wires) {
        if wires.can.is_held {
            return;
        }
        if self.joins_at.is_some_and(|time| time <= wires.now) {
            (self.joins_at, self.is_active) = (None, true);
        }
        if self.recovers_at.is_some_and(|time| time <= wires.now) {
            (self.recovers_at, self.is_off, self.errors) = (None, false, [0; 2]);
        }
    }

    /// True while the node takes part in the bus, given routed pins.
    pub fn takes_part(&self) -> bool {
        self.is_active && !self.is_off && self.is_on_rate
    }

    /// Notes a frame that was sent.
    pub fn sent(&mut self) {
        (self.errors[0], self.last_error) = (self.errors[0].saturating_sub(1), 0);
    }

    /// Notes a frame that was received.
    pub fn received(&mut self) {
        self.errors[1] = self.errors[1].saturating_sub(1);
    }

    /// Notes a frame that could not be sent; returns `true` if the node is off the bus now.
    pub fn failed(&mut self, is_destroyed: bool, wires: &mut Wires) -> bool {
        if is_destroyed {
            (self.errors[0], self.last_error) = (self.errors[0] + 8, BIT_ERROR);
        } else {
            // A missing acknowledgement does not count beyond error passive.
            self.errors[0] = if self.errors[0] >= PASSIVE { self.errors[0] } else { self.errors[0] + 8 };
            self.last_error = NO_ACKNOWLEDGEMENT;
        }
        wires.can.after_error(wires.now);
        self.is_off = self.errors[0] > OFF;
        self.is_off
    }

    /// Time of the next change that needs no access.
    pub fn next_event(&self) -> Option<Time> {
        self.joins_at.into_iter().chain(self.recovers_at).min()
    }

    /// Checks a bit rate [bit/s] and a sample point [thousandths of a bit] against the bus; returns the fault.
    pub fn check_rate(rate: u64, bus: u64, point: u64) -> Option<String> {
        // ISO 11898-1: both ends together within 1.58 % at most.
        if rate.abs_diff(bus) * 200 > bus {
            return Some(format!("gives {rate} bit/s where the bus has {bus}"));
        }
        let is_early_or_late = !(700..=900).contains(&point);
        is_early_or_late.then(|| format!("samples at {}.{} % of a bit", point / 10, point % 10))
    }
}

//! Process data objects: values of a mapping in the bytes of a frame, and the state of each PDO.

use super::dictionary::{Address, mapped_address};
use heapless::Vec;

/// Data of a PDO.
pub type Data = Vec<u8, 8>;

/// Appends a value in its bytes; false if the PDO is full.
pub fn pack(data: &mut Data, raw: u32, size: usize) -> bool {
    raw.to_le_bytes().iter().take(size).all(|byte| data.push(*byte).is_ok())
}

/// Values of a mapping in order: address and value. Ends early if the data is short.
pub fn unpack<'d>(mappings: &'d [u32], data: &'d [u8]) -> impl Iterator<Item = (Address, u32)> + 'd {
    let mut at = 0;
    mappings.iter().map_while(move |mapping| {
        let size = size_of_mapping(*mapping);
        let bytes = data.get(at..at + size)?;
        at += size;
        let mut raw = [0; 4];
        raw.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
        Some((mapped_address(*mapping), u32::from_le_bytes(raw)))
    })
}

/// Bytes of an entry of a mapping.
pub fn size_of_mapping(mapping: u32) -> usize {
    (mapping & 0xFF) as usize / 8
}

/// RPDO.
#[derive(Debug, Clone)]
pub(super) struct Receive {
    /// Data that waits for a SYNC.
    pub pending: Option<Data>,
    /// Time of the last frame [us], once there was one.
    pub seen: Option<u64>,
}

impl Receive {
    /// Before the first frame.
    pub const NONE: Self = Self { pending: None, seen: None };
}

/// TPDO.
#[derive(Debug, Clone)]
pub(super) struct Transmit {
    /// Data of the last frame.
    pub last: Data,
    /// Time of the last frame [us].
    pub sent: u64,
    /// SYNCs since the last frame.
    pub syncs: u8,
}

impl Transmit {
    /// Before the first frame.
    pub const NONE: Self = Self { last: Data::new(), sent: 0, syncs: 0 };
}

/// Reason to send a TPDO.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Trigger {
    Sync,
    Time,
    Remote,
}

/// Parameters of a TPDO.
#[derive(Debug, Clone, Copy)]
pub(super) struct Timing {
    pub transmission: u8,
    /// Inhibit time [0.1 ms].
    pub inhibit: u32,
    /// Event timer [ms]; 0 without one.
    pub event: u32,
}

impl Transmit {
    /// True if the trigger sends the data now.
    pub fn is_due(&mut self, trigger: Trigger, timing: Timing, data: &Data, now: u64) -> bool {
        let is_new = *data != self.last;
        let elapsed = now.saturating_sub(self.sent);
        match (trigger, timing.transmission) {
            (Trigger::Remote, _) => true,
            (Trigger::Sync, 0) => is_new,
            (Trigger::Sync, every @ 1..=240) => {
                self.syncs = self.syncs.saturating_add(1);
                self.syncs >= every
            }
            (Trigger::Time, 254 | 255) => {
                let is_event = timing.event > 0 && elapsed >= 1000 * u64::from(timing.event);
                is_event || is_new && (self.last.is_empty() || elapsed >= 100 * u64::from(timing.inhibit))
            }
            _ => false,
        }
    }

    /// Notes a frame.
    pub fn note(&mut self, data: Data, now: u64) {
        *self = Self { last: data, sent: now, syncs: 0 };
    }
}

/// True for a transmission type that the drive supports.
pub(super) fn is_transmission(kind: u32) -> bool {
    matches!(kind, 0..=240 | 253..=255)
}

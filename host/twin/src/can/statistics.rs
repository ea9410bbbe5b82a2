//! Counts of the bus: frames, destroyed frames, identifiers that collided.

use std::collections::{BTreeMap, BTreeSet};

/// Collision of an identifier: how often, and its senders.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Collision {
    /// Frames that collided.
    pub count: u64,
    /// Indices of the nodes that sent them.
    pub nodes: BTreeSet<usize>,
}

/// Counts of the bus.
#[derive(Debug, Clone, Default)]
pub struct Statistics {
    /// Frames that all nodes on the bus received.
    pub frames: u64,
    /// Frames that errors destroyed, each attempt counted.
    pub destroyed: u64,
    /// Attempts without an acknowledgement, because no other node was on the bus.
    pub unacknowledged: u64,
    /// Time that frames and errors took [s].
    pub busy: f64,
    /// Collisions by identifier; true for 29 bits.
    pub collisions: BTreeMap<(u32, bool), Collision>,
}

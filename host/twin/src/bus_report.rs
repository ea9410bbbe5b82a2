//! Figures of a CAN bus for the summary and the control socket.

use serde::Serialize;

use crate::bus::Bus;

/// Figures of a CAN bus since the start.
#[derive(Debug, Clone, Serialize)]
pub struct BusReport {
    /// Frames that were received.
    pub frames: u64,
    /// Frames that errors destroyed, each attempt counted.
    pub destroyed: u64,
    /// Attempts that no other node acknowledged.
    pub unacknowledged: u64,
    /// Frames that found the queue of their drive full.
    pub lost: u64,
    /// Share of the time in which the bus was busy [-].
    pub load: f64,
    /// Identifiers that several nodes sent at the same time.
    pub collisions: Vec<CollisionReport>,
    /// Nodes that went off the bus.
    pub off: Vec<OffReport>,
}

/// Identifier that several nodes sent at the same time.
#[derive(Debug, Clone, Serialize)]
pub struct CollisionReport {
    /// Identifier as hexadecimal digits: 3 for 11 bits, 8 for 29 bits.
    pub id: String,
    /// Frames that collided.
    pub count: u64,
    /// Names of the nodes.
    pub nodes: Vec<String>,
}

/// Node that went off the bus.
#[derive(Debug, Clone, Serialize)]
pub struct OffReport {
    /// Name of the node.
    pub node: String,
    /// Times.
    pub count: u64,
}

impl BusReport {
    /// Figures of a bus; `None` for a serial bus.
    pub fn new(bus: &Bus<'_>) -> Option<Self> {
        let can = bus.can.as_ref()?;
        let statistics = &can.statistics;
        let nodes = || (0..=bus.joints.len()).map(|index| (index, can.node(index)));
        let collisions = statistics.collisions.iter().map(|((id, is_extended), collision)| CollisionReport {
            id: if *is_extended { format!("{id:08X}") } else { format!("{id:03X}") },
            count: collision.count,
            nodes: collision.nodes.iter().map(|index| bus.node_name(*index)).collect(),
        });
        let off = nodes().filter(|(_, node)| node.bus_offs > 0);
        Some(Self {
            frames: statistics.frames,
            destroyed: statistics.destroyed,
            unacknowledged: statistics.unacknowledged,
            lost: nodes().map(|(_, node)| node.overflows).sum(),
            load: statistics.busy / bus.time().max(f64::MIN_POSITIVE),
            collisions: collisions.collect(),
            off: off.map(|(index, node)| OffReport { node: bus.node_name(index), count: node.bus_offs }).collect(),
        })
    }

    /// Lines for the terminal; empty for a bus without a load and without errors.
    pub fn text(&self) -> String {
        let Self { destroyed, unacknowledged, lost, load, .. } = self;
        let mut text = String::new();
        if *load > 0.0 {
            text += &format!("bus:      {:.1} % busy, {destroyed} frames destroyed", 100.0 * load);
            if *unacknowledged > 0 {
                text += &format!(", {unacknowledged} without acknowledgement");
            }
            if *lost > 0 {
                text += &format!(", {lost} lost in a full queue");
            }
            text.push('\n');
        }
        for CollisionReport { id, count, nodes } in &self.collisions {
            text += &format!(
                "warning:  {} sent the identifier {id} at the same time, {count} times: give each an identifier of its own\n",
                nodes.join(" and ")
            );
        }
        for OffReport { node, count } in &self.off {
            text += &format!("warning:  bus-off: {node}, {count} x\n");
        }
        text
    }
}

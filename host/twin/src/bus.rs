//! Joints on one bus: every packet reaches all drives, and the client.
//!
//! The client's adapter is node 0 of a CAN bus, the joints follow in the order of the command line. The adapter always
//! acknowledges, and all clients of socketcand share it. A serial bus has no arbitration and takes no time.

use std::collections::VecDeque;

use drives::Frame;
use scenario::rig::RunError;

use crate::can::{ErrorState, Event, Medium, Rate};
use crate::joint::Joint;
use crate::protocol::Server;
use wires::Packet;

/// Packets on a serial bus that one packet of the client or one period may cause. Drives whose answers answer each
/// other would go on for ever. On a CAN bus that takes no time the later ones wait for the next period.
const MAX_CHAIN: usize = 256;
/// Node of the client's adapter.
const CLIENT: usize = 0;

/// Joints on one bus.
pub struct Bus<'d> {
    /// Joints in the order of the command line.
    pub joints: Vec<Joint<'d>>,
    /// CAN bus; `None` for a serial bus.
    pub can: Option<Medium>,
    /// Packets that were cut off because of `MAX_CHAIN`.
    pub cut_off: u64,
}

/// Packet on its way on a serial bus, and the index of the joint that sent it.
type Sent = (Option<usize>, Packet);

/// Node of a joint.
const fn node(joint: usize) -> usize {
    joint + 1
}

impl<'d> Bus<'d> {
    /// Bus with its joints. A CAN bus without a rate takes no time for its frames.
    pub fn new(joints: Vec<Joint<'d>>, rate: Option<Rate>, seed: u64) -> Self {
        let is_can = joints.iter().all(|joint| matches!(joint.server, Server::Can(_)));
        let can = is_can.then(|| Medium::new(node(joints.len()), rate, seed));
        Self { joints, can, cut_off: 0 }
    }

    /// Time of the joints [s].
    pub fn time(&self) -> f64 {
        self.joints.first().map_or(0.0, Joint::time)
    }

    /// Name of a node.
    pub fn node_name(&self, node: usize) -> String {
        let joint = node.checked_sub(1).and_then(|joint| self.joints.get(joint));
        joint.map_or_else(|| "the client".to_owned(), |joint| format!("{} = {}", joint.id, joint.name))
    }

    /// Number of frames of the client that wait for the bus.
    pub fn client_backlog(&self) -> usize {
        self.can.as_ref().map_or(0, |can| can.node(CLIENT).waiting())
    }

    /// True while a frame waits for the bus or is on its way.
    pub fn is_busy(&self) -> bool {
        self.can.as_ref().is_some_and(Medium::is_busy)
    }

    /// Sets the share of a joint's frames that noise destroys [-]; `None` for the frames of the client.
    pub fn set_noise(&mut self, joint: Option<usize>, share: f64) {
        if let Some(can) = &mut self.can {
            can.set_noise(joint.map_or(CLIENT, node), share);
        }
    }

    /// Takes a joint off the bus.
    pub fn force_off(&mut self, joint: usize) {
        if let Some(can) = &mut self.can {
            can.force_off(node(joint));
        }
    }

    /// State and error counters of a joint on a CAN bus.
    pub fn can_state(&self, joint: usize) -> Option<(ErrorState, (u16, u16))> {
        let can = self.can.as_ref()?.node(node(joint));
        Some((can.state(), can.counters()))
    }

    /// Takes a packet of the client; returns the packets that the client receives.
    pub fn receive(&mut self, packet: Packet) -> Vec<Packet> {
        let time = self.time();
        match (packet, &mut self.can) {
            (Packet::Frame(frame), Some(can)) => {
                can.enqueue(CLIENT, frame, time);
                self.run(time)
            }
            (packet, _) => self.deliver(VecDeque::from([(None, packet)])),
        }
    }

    /// Runs one control period of all joints; returns the packets that the client receives.
    pub fn period(&mut self) -> Result<Vec<Packet>, RunError> {
        let mut sent: VecDeque<Sent> = VecDeque::new();
        for (index, joint) in self.joints.iter_mut().enumerate() {
            joint.step()?;
            let time = joint.time();
            let Joint { drive, server, .. } = joint;
            match (server, &mut self.can) {
                (Server::Can(server), Some(can)) => {
                    server.tick(drive, &mut |frame: Frame| can.enqueue(node(index), frame, time));
                }
                (Server::Serial(server), _) => {
                    let send = &mut |bytes: &[u8]| sent.push_back((Some(index), Packet::Bytes(bytes.to_vec())));
                    server.tick(drive, send);
                }
                _ => {}
            }
        }
        Ok(if self.can.is_some() { self.run(self.time()) } else { self.deliver(sent) })
    }

    /// Runs the CAN bus up to a time [s]; returns the frames that the client receives.
    fn run(&mut self, until: f64) -> Vec<Packet> {
        let Self { joints, can: Some(can), .. } = self else { return Vec::new() };
        let mut for_client = Vec::new();
        for _ in 0..MAX_CHAIN {
            let Some(event) = can.next(until) else { break };
            match event {
                Event::Received { senders, frame, time } => {
                    for (index, joint) in joints.iter_mut().enumerate() {
                        if senders.contains(&node(index)) || !can.node(node(index)).is_on_bus() {
                            continue;
                        }
                        if let Joint { drive, server: Server::Can(server), .. } = joint {
                            server.receive(&frame, drive, &mut |answer: Frame| can.enqueue(node(index), answer, time));
                        }
                    }
                    if !senders.contains(&CLIENT) && can.node(CLIENT).is_on_bus() {
                        for_client.push(Packet::Frame(frame));
                    }
                }
                Event::Off(node) => report(joints, can, node, until, true),
                Event::Back(node, time) => report(joints, can, node, time, false),
            }
        }
        for_client
    }

    /// Delivers packets of a serial bus to all drives but their sender, and what these answer, until the bus is silent.
    fn deliver(&mut self, mut waiting: VecDeque<Sent>) -> Vec<Packet> {
        let mut for_client = Vec::new();
        let mut delivered = 0;
        while let Some((sender, packet)) = waiting.pop_front() {
            if delivered == MAX_CHAIN {
                self.cut_off += waiting.len() as u64 + 1;
                break;
            }
            delivered += 1;
            for (index, joint) in self.joints.iter_mut().enumerate() {
                if sender != Some(index) {
                    hand_over(joint, &packet, &mut |answer| waiting.push_back((Some(index), answer)));
                }
            }
            if sender.is_some() {
                for_client.push(packet);
            }
        }
        for_client
    }
}

/// Tells a drive that its node left the bus or returned at a time [s].
fn report(joints: &mut [Joint<'_>], can: &mut Medium, node: usize, time: f64, is_off: bool) {
    let joint = node.checked_sub(1).and_then(|joint| joints.get_mut(joint));
    if let Some(Joint { drive, server: Server::Can(server), .. }) = joint {
        server.bus_off(is_off, drive, &mut |frame: Frame| can.enqueue(node, frame, time));
    }
}

fn hand_over(joint: &mut Joint<'_>, packet: &Packet, send: &mut dyn FnMut(Packet)) {
    let Joint { drive, server: Server::Serial(server), .. } = joint else { return };
    let Packet::Bytes(bytes) = packet else { return };
    for byte in bytes {
        server.receive(*byte, drive, &mut |answer: &[u8]| send(Packet::Bytes(answer.to_vec())));
    }
}

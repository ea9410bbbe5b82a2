//! Joints on one bus: every packet reaches all drives, and the client.

use std::collections::VecDeque;

use drives::Frame;
use scenario::rig::RunError;

use crate::joint::Joint;
use crate::protocol::Server;
use wires::Packet;

/// Packets that one packet of the client or one period may cause. Drives whose answers answer each other would go on
/// for ever.
const MAX_CHAIN: usize = 256;

/// Joints on one bus.
pub struct Bus<'d> {
    /// Joints in the order of the command line.
    pub joints: Vec<Joint<'d>>,
    /// Packets that were cut off because of `MAX_CHAIN`.
    pub cut_off: u64,
}

/// Packet on its way, and the index of the joint that sent it.
type Sent = (Option<usize>, Packet);

impl<'d> Bus<'d> {
    /// Bus with its joints.
    pub fn new(joints: Vec<Joint<'d>>) -> Self {
        Self { joints, cut_off: 0 }
    }

    /// Delivers a packet of the client; returns the packets that the drives send.
    pub fn receive(&mut self, packet: Packet) -> Vec<Packet> {
        self.deliver(VecDeque::from([(None, packet)]))
    }

    /// Runs one control period of all joints; returns the packets that the drives send.
    pub fn period(&mut self) -> Result<Vec<Packet>, RunError> {
        let mut sent: VecDeque<Sent> = VecDeque::new();
        for (index, joint) in self.joints.iter_mut().enumerate() {
            joint.step()?;
            let Joint { drive, server, .. } = joint;
            match server {
                Server::Can(server) => {
                    server.tick(drive, &mut |frame: Frame| sent.push_back((Some(index), Packet::Frame(frame))));
                }
                Server::Serial(server) => {
                    let send = &mut |bytes: &[u8]| sent.push_back((Some(index), Packet::Bytes(bytes.to_vec())));
                    server.tick(drive, send);
                }
            }
        }
        Ok(if sent.is_empty() { Vec::new() } else { self.deliver(sent) })
    }

    /// Delivers packets to all drives but their sender, and what these answer, until the bus is silent.
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

fn hand_over(joint: &mut Joint<'_>, packet: &Packet, send: &mut dyn FnMut(Packet)) {
    let Joint { drive, server, .. } = joint;
    match (server, packet) {
        (Server::Can(server), Packet::Frame(frame)) => {
            server.receive(frame, drive, &mut |answer: Frame| send(Packet::Frame(answer)));
        }
        (Server::Serial(server), Packet::Bytes(bytes)) => {
            for byte in bytes {
                server.receive(*byte, drive, &mut |answer: &[u8]| send(Packet::Bytes(answer.to_vec())));
            }
        }
        _ => {}
    }
}

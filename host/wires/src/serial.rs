//! Bytes of a serial bus, unchanged, cut at the ends of instruction packets.

use drives::feetech::Receiver;

use super::{Packet, Received, Wire};

/// Serial line.
#[derive(Debug, Default)]
pub struct Serial {
    receiver: Receiver,
}

impl Wire for Serial {
    fn receive(&mut self, bytes: &[u8]) -> Vec<Received> {
        let mut received = Vec::new();
        let mut begun = Vec::new();
        for byte in bytes {
            begun.push(*byte);
            if self.receiver.receive(*byte).is_some() {
                received.push(Received::Packet(Packet::Bytes(std::mem::take(&mut begun))));
            }
        }
        if !begun.is_empty() {
            received.push(Received::Part(begun));
        }
        received
    }

    fn encode(&mut self, packet: &Packet) -> Option<Vec<u8>> {
        match packet {
            Packet::Bytes(bytes) => Some(bytes.clone()),
            Packet::Frame(_) => None,
        }
    }
}

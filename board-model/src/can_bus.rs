//! CAN bus outside of the chip: one other node, for any number of clients. The peripheral that is connected to the bus
//! moves it forward; errors are those that the other node makes.

use std::collections::VecDeque;

use bus_wires::bits::{Bits, Duration, ERROR_FRAME, INTERMISSION, priority};
use drives::Frame;

use crate::wires::{Pin, Time, cycles};

/// Connection of the bus.
#[derive(Debug, Clone, Copy, Default)]
pub struct CanCable {
    /// Peripheral of the board, by the number that ends its name; 0 without a bus.
    pub unit: u32,
    /// Pin to the transceiver.
    pub send: Pin,
    /// Pin from the transceiver.
    pub receive: Pin,
    /// Bit rate [bit/s].
    pub bitrate: u64,
    /// Second bit rate, for data of CAN FD frames [bit/s].
    pub data_bitrate: Option<u64>,
}

/// Node on the bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Node {
    /// Board, with the number of the mailbox.
    Board(usize),
    /// Other node.
    Other,
}

/// Frame on the bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Transfer {
    /// Frame.
    pub frame: Frame,
    /// Sender.
    pub sender: Node,
    /// End of the frame, before the pause between frames.
    pub end: Time,
    /// True if the other node destroys it by a dominant bit.
    pub is_destroyed: bool,
}

/// Frame with the number of ticks that had begun.
pub type Logged = (u32, Frame);

/// The bus.
#[derive(Debug)]
pub struct CanBus {
    /// Connection.
    pub cable: CanCable,
    /// Frames that the other node wants to send.
    pub to_board: VecDeque<Frame>,
    /// Frames that the other node received.
    pub to_others: Vec<Frame>,
    /// Frames that the core took from the peripheral.
    pub taken: Vec<Logged>,
    /// Frames that the core handed to the peripheral.
    pub handed: Vec<Logged>,
    /// Changes that the core read of whether its peripheral is off the bus, each with the number of ticks that had begun.
    pub seen_off: Vec<(u32, bool)>,
    /// Ticks of the core that have begun.
    pub ticks: u32,
    /// True if the other node acknowledges the board's frames.
    pub acknowledges: bool,
    /// Frames of the board that the other node will destroy.
    pub destroys: u32,
    /// True if the bus is held dominant, as by a short circuit.
    pub is_held: bool,
    /// Frames that the board lost because its FIFO was full.
    pub overruns: u32,
    transfer: Option<Transfer>,
    /// Time at which the next frame may begin.
    free_at: Time,
}

impl CanBus {
    /// Silent bus with a node that acknowledges.
    pub fn new(cable: CanCable) -> Self {
        Self {
            cable,
            to_board: VecDeque::new(),
            to_others: Vec::new(),
            taken: Vec::new(),
            handed: Vec::new(),
            seen_off: Vec::new(),
            ticks: 0,
            acknowledges: true,
            destroys: 0,
            is_held: false,
            overruns: 0,
            transfer: None,
            free_at: 0,
        }
    }

    /// Duration of bits at the first rate.
    pub fn bits(&self, count: u64) -> Time {
        cycles(count, self.cable.bitrate)
    }

    /// Transfer that has ended by now.
    pub fn ended(&mut self, now: Time) -> Option<Transfer> {
        self.transfer.take_if(|transfer| transfer.end <= now)
    }

    /// Begins the next frame if the bus is free; `own` is the board's candidate with its mailbox. The lower identifier
    /// wins. Returns whether a frame began.
    pub fn begin(&mut self, own: Option<(usize, &Frame)>, now: Time) -> bool {
        if self.transfer.is_some() || self.is_held || self.cable.bitrate == 0 {
            return false;
        }
        let own_wins = match (own, self.to_board.front()) {
            (Some((_, own)), Some(other)) => priority(own) < priority(other),
            (Some(_), None) => true,
            (None, _) => false,
        };
        let (sender, frame) = match own.filter(|_| own_wins) {
            Some((place, frame)) => (Node::Board(place), frame.clone()),
            None => match self.to_board.front() {
                Some(frame) => (Node::Other, frame.clone()),
                None => return false,
            },
        };
        let start = self.free_at.max(now);
        let length = duration(&frame, &self.cable);
        let is_destroyed = sender != Node::Other && self.destroys > 0;
        if is_destroyed {
            self.destroys -= 1;
        }
        let end = start + length;
        self.free_at = end + self.bits(INTERMISSION.into());
        self.transfer = Some(Transfer { frame, sender, end, is_destroyed });
        true
    }

    /// Lets the other node send frames before all others that wait.
    pub fn send_first(&mut self, frames: Vec<Frame>) {
        // The first one may be on the bus.
        let place = self.to_board.len().min(1);
        for frame in frames.into_iter().rev() {
            self.to_board.insert(place, frame);
        }
    }

    /// Logs that the core has read whether its peripheral is off the bus.
    pub fn note_seen_off(&mut self, is_off: bool) {
        if is_off != self.seen_off.last().is_some_and(|(_, last)| *last) {
            self.seen_off.push((self.ticks, is_off));
        }
    }

    /// Ends the other node's frame: if the board has not received it, the other node sends it again.
    pub fn end_reception(&mut self, by_board: bool) {
        if by_board {
            self.to_board.pop_front();
        }
    }

    /// Lets the next frame wait for an error frame.
    pub fn after_error(&mut self, now: Time) {
        self.free_at = now + self.bits((ERROR_FRAME + INTERMISSION).into());
    }

    /// Time of the end of the frame on the bus.
    pub fn next_event(&self) -> Option<Time> {
        self.transfer.as_ref().map(|transfer| transfer.end)
    }
}

/// Duration of a frame, from its start to the end of its last field.
fn duration(frame: &Frame, cable: &CanCable) -> Time {
    let Duration { nominal, data } = Bits::new(frame).duration();
    cycles(nominal.into(), cable.bitrate) + cycles(data.into(), cable.data_bitrate.unwrap_or(cable.bitrate))
}

#[cfg(test)]
mod tests {
    use super::*;
    use drives::frame::{extended, standard};

    #[test]
    fn second_rate_shortens_data() {
        let frame = Frame::flexible(extended(0x8001), &[0x55; 48], 0).unwrap();
        let slow = CanCable { bitrate: 1_000_000, ..CanCable::default() };
        let fast = CanCable { data_bitrate: Some(5_000_000), ..slow };
        assert!(duration(&frame, &fast) * 3 < duration(&frame, &slow));
    }

    #[test]
    fn frames_follow_one_another() {
        let cable = CanCable { unit: 1, bitrate: 1_000_000, ..CanCable::default() };
        let mut bus = CanBus::new(cable);
        bus.to_board.push_back(Frame::classic(standard(1), &[0; 8]).unwrap());
        let own = Frame::classic(standard(0), &[]).unwrap();
        assert!(bus.begin(Some((0, &own)), 0));
        assert!(!bus.begin(None, 0));
        let first = bus.ended(Time::MAX).unwrap();
        assert_eq!(first.sender, Node::Board(0));
        assert!(bus.begin(None, first.end));
        assert!(bus.next_event().unwrap() > first.end + bus.bits(100));
    }
}

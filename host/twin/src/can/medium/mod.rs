//! Wire that all nodes share: one frame at a time, chosen by arbitration; errors destroy frames for all nodes.
//!
//! Once the bus is idle, the waiting frame with the lowest key wins (see `wires::bits::priority`). Two nodes that send the
//! same identifier both go on, up to the first bit in which their frames differ:
//!
//! - The node whose recessive bit is hidden has an error. If it is error active, its flag destroys the frame: both
//!   senders count an error of the transmitter, all others one of the receiver, and both frames are sent again.
//! - If it is error passive, its flag disturbs nobody: the other frame goes on.
//! - Frames without a difference are one frame on the wire.
//!
//! Without a bit rate a frame takes no time; error frames, repeated frames and the return from bus-off take the time that
//! they need at [`Rate::USUAL`].

use std::collections::VecDeque;

use drives::Frame;
use scenario::random::RandomStream;
use wires::bits::{Bits, Duration, ERROR_FRAME, INTERMISSION, priority};

use super::node::{ErrorState, Node};
use super::statistics::Statistics;

/// Bits of an idle bus that a node off the bus counts as one sequence.
const SEQUENCE: f64 = 11.0;
/// Bits that an error-passive transmitter waits before its next frame.
const SUSPENSION: f64 = 8.0;

/// Bit rates [bit/s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Of all bits but the data of CAN FD with bit rate switch.
    pub nominal: f64,
    /// Of the data of CAN FD with bit rate switch.
    pub data: f64,
}

impl Rate {
    /// Rates of the drives' makers: 1 Mbit/s, and 5 Mbit/s for the data of moteus.
    pub const USUAL: Self = Self { nominal: 1e6, data: 5e6 };
}

/// Event on the bus.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// All nodes on the bus but those that sent received a frame.
    Received {
        /// Indices of the nodes that sent.
        senders: Vec<usize>,
        /// Frame.
        frame: Frame,
        /// Time of its end [s].
        time: f64,
    },
    /// A node went off the bus.
    Off(usize),
    /// A node returned to the bus at a time [s].
    Back(usize, f64),
}

/// End of a frame on its way.
#[derive(Debug)]
enum Outcome {
    /// Received by all nodes but its senders; sent by these of them.
    Received(Vec<usize>),
    /// Destroyed for all.
    Destroyed,
    /// Not acknowledged.
    Unacknowledged,
}

/// Transmission on its way.
#[derive(Debug)]
struct Transmission {
    /// Nodes that sent.
    senders: Vec<usize>,
    /// Nodes that an error stopped while the frame went on.
    stopped: Vec<usize>,
    outcome: Outcome,
    end: f64,
}

/// Bus with its nodes.
#[derive(Debug)]
pub struct Medium {
    nodes: Vec<Node>,
    /// `None` for frames that take no time.
    rate: Option<Rate>,
    /// Time up to which the bus is decided [s].
    time: f64,
    transmission: Option<Transmission>,
    events: VecDeque<Event>,
    random: RandomStream,
    /// Counts.
    pub statistics: Statistics,
}

impl Medium {
    /// Bus with nodes; the queue of the first one has no limit.
    pub fn new(nodes: usize, rate: Option<Rate>, seed: u64) -> Self {
        let first = std::iter::once_with(Node::unlimited);
        Self {
            nodes: first.chain(std::iter::repeat_with(Node::default)).take(nodes).collect(),
            rate,
            time: 0.0,
            transmission: None,
            events: VecDeque::new(),
            random: RandomStream::new(seed, "can"),
            statistics: Statistics::default(),
        }
    }

    /// Node.
    pub fn node(&self, index: usize) -> &Node {
        &self.nodes[index]
    }

    /// Sets the share of a node's frames that noise destroys [-].
    pub fn set_noise(&mut self, index: usize, share: f64) {
        self.nodes[index].noise = share;
    }

    /// Takes a node off the bus.
    pub fn force_off(&mut self, index: usize) {
        if self.nodes[index].force_off() {
            self.events.push_back(Event::Off(index));
        }
    }

    /// Adds a frame to the queue of a node at a time [s].
    pub fn enqueue(&mut self, index: usize, frame: Frame, time: f64) {
        self.nodes[index].enqueue(frame, time);
    }

    /// True while a frame waits in a node on the bus, or is on its way.
    pub fn is_busy(&self) -> bool {
        self.transmission.is_some() || self.nodes.iter().any(|node| node.front().is_some())
    }

    /// Next event up to a time [s]; `None` once there is no more.
    pub fn next(&mut self, until: f64) -> Option<Event> {
        loop {
            if let Some(event) = self.events.pop_front() {
                return Some(event);
            }
            if let Some(transmission) = self.transmission.take_if(|transmission| transmission.end <= until) {
                self.finish(transmission);
                continue;
            }
            if self.transmission.is_some() {
                return None;
            }
            let waiting = self.nodes.iter().filter_map(|node| Some(node.front()?.1)).reduce(f64::min);
            let start = waiting.map_or(until, |since| since.max(self.time)).min(until);
            self.idle(start);
            if !self.events.is_empty() {
                continue;
            }
            if waiting.is_none_or(|since| since > until) {
                return None;
            }
            self.begin(start);
        }
    }

    /// Lets the bus be idle until a time [s].
    fn idle(&mut self, until: f64) {
        let rate = self.rate.unwrap_or(Rate::USUAL).nominal;
        self.recover((until - self.time).max(0.0) * rate / SEQUENCE, until);
        self.time = self.time.max(until);
    }

    /// Counts sequences of recessive bits for the nodes off the bus.
    fn recover(&mut self, sequences: f64, time: f64) {
        for (index, node) in self.nodes.iter_mut().enumerate() {
            if node.recover(sequences) {
                self.events.push_back(Event::Back(index, time));
            }
        }
    }

    /// Lets the nodes whose frames wait arbitrate at a time [s], and decides what becomes of the frame.
    fn begin(&mut self, start: f64) {
        let contenders =
            |node: &Node| node.front().filter(|(_, since)| *since <= start).map(|(frame, _)| priority(frame));
        let Some(key) = self.nodes.iter().filter_map(contenders).min() else { return };
        let senders: Vec<usize> =
            (0..self.nodes.len()).filter(|index| contenders(&self.nodes[*index]) == Some(key)).collect();
        let (mut alive, mut stopped) = (senders.clone(), Vec::new());
        let frames: Vec<(usize, Bits)> =
            senders.iter().filter_map(|index| Some((*index, Bits::new(self.nodes[*index].front()?.0)))).collect();
        let bits = |index: usize| frames.iter().find(|(sender, _)| *sender == index).map(|(_, bits)| bits);
        let mut destroyed_at = None;
        while let Some(difference) = first_difference(&alive, bits) {
            let loses = |index: &usize| bits(*index).is_some_and(|bits| bits.is_recessive(difference));
            let (losers, winners): (Vec<usize>, Vec<usize>) = alive.iter().partition(|index| loses(index));
            if losers.iter().any(|index| self.nodes[*index].state() != ErrorState::ErrorPassive) {
                destroyed_at = Some(difference as u32);
                break;
            }
            stopped.extend(losers);
            alive = winners;
        }
        if senders.len() > 1 && (destroyed_at.is_some() || !stopped.is_empty()) {
            self.note_collision(&senders);
        }
        let Duration { nominal, data } =
            alive.first().and_then(|index| bits(*index)).map(Bits::duration).unwrap_or_default();
        let is_noisy = alive.iter().any(|index| self.random.uniform() < self.nodes[*index].noise);
        if destroyed_at.is_none() && is_noisy {
            destroyed_at = Some((self.random.uniform() * f64::from(nominal)) as u32);
        }
        let is_alone = (0..self.nodes.len()).all(|index| senders.contains(&index) || !self.nodes[index].is_on_bus());
        let usual = self.rate.unwrap_or(Rate::USUAL);
        let time =
            |nominal: u32, data: u32| f64::from(nominal + INTERMISSION) / usual.nominal + f64::from(data) / usual.data;
        let (outcome, time) = match destroyed_at {
            Some(bits) => (Outcome::Destroyed, time(bits + ERROR_FRAME, 0)),
            None if is_alone => (Outcome::Unacknowledged, time(nominal + ERROR_FRAME, data)),
            None if self.rate.is_none() => (Outcome::Received(alive), 0.0),
            None => (Outcome::Received(alive), time(nominal, data)),
        };
        self.statistics.busy += time;
        self.transmission = Some(Transmission { senders, stopped, outcome, end: start + time });
    }

    fn finish(&mut self, transmission: Transmission) {
        let Transmission { senders, stopped, outcome, end } = transmission;
        self.time = end;
        match outcome {
            Outcome::Received(alive) => {
                self.statistics.frames += 1;
                stopped.iter().for_each(|index| self.fail_to_send(*index));
                let sent: Vec<Frame> = alive.iter().filter_map(|index| self.nodes[*index].sent()).collect();
                let others = self.nodes.iter_mut().enumerate().filter(|(index, _)| !senders.contains(index));
                others.filter(|(_, node)| node.is_on_bus()).for_each(|(_, node)| node.received());
                if let Some(frame) = sent.into_iter().next() {
                    self.events.push_back(Event::Received { senders: senders.clone(), frame, time: end });
                }
            }
            Outcome::Destroyed => {
                self.statistics.destroyed += 1;
                let others = self.nodes.iter_mut().enumerate().filter(|(index, _)| !senders.contains(index));
                others.filter(|(_, node)| node.is_on_bus()).for_each(|(_, node)| node.fail_to_receive());
                senders.iter().for_each(|index| self.fail_to_send(*index));
            }
            Outcome::Unacknowledged => {
                self.statistics.unacknowledged += 1;
                for index in &senders {
                    if self.nodes[*index].state() == ErrorState::ErrorActive {
                        self.fail_to_send(*index);
                    }
                }
            }
        }
        let rate = self.rate.unwrap_or(Rate::USUAL).nominal;
        for index in senders {
            if self.nodes[index].state() == ErrorState::ErrorPassive {
                self.nodes[index].suspended_until = end + SUSPENSION / rate;
            }
        }
        // The end of each frame has 11 recessive bits.
        self.recover(1.0, end);
    }

    fn fail_to_send(&mut self, index: usize) {
        if self.nodes[index].fail_to_send() {
            self.events.push_back(Event::Off(index));
        }
    }

    fn note_collision(&mut self, senders: &[usize]) {
        let Some((frame, _)) = senders.first().and_then(|index| self.nodes[*index].front()) else { return };
        let identifier = (frame.raw_id(), frame.extended_id().is_some());
        let collision = self.statistics.collisions.entry(identifier).or_default();
        collision.count += 1;
        collision.nodes.extend(senders);
    }
}

/// First bit in which the frames of nodes differ.
fn first_difference<'b>(alive: &[usize], bits: impl Fn(usize) -> Option<&'b Bits>) -> Option<usize> {
    let first = bits(*alive.first()?)?;
    alive.iter().skip(1).filter_map(|index| first.difference(bits(*index)?)).min()
}

#[cfg(test)]
mod tests;

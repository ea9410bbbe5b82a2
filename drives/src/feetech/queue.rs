//! Answers that have to wait: the return delay, and the order of several servos on one bus.
//!
//! After [`Instruction::SyncRead`](super::Instruction::SyncRead) the servos answer in the order of the identifiers in
//! the instruction. Each counts the answers before its own. If one of them stays away, the bus is silent for
//! [`SLOT`] for each answer that is missing.

use heapless::Vec;

use super::packet::{Bytes, MAX_PARAMETERS, Packet};

/// Silence for each missing answer [s]. Longer than the longest return delay and packet at 1 Mbit/s, 0.5 ms and 2.6 ms.
const SLOT: f32 = 4e-3;

/// Distance of two answers to a broadcast ping [s]. LeRobot 0.4 waits for 3 ms for each identifier.
pub(super) const PING_SLOT: f32 = 3e-3;

/// Place in a synchronous read.
#[derive(Debug, Clone)]
struct Place {
    /// Identifiers that answer before and have not answered yet.
    earlier: Vec<u8, MAX_PARAMETERS>,
    address: u8,
    length: u8,
    /// Silence on the bus [control periods].
    silence: u32,
}

/// Answer that waits for its time.
#[derive(Debug, Clone)]
struct Delayed {
    bytes: Bytes,
    /// Time that is left [control periods].
    periods: u32,
}

/// Answers that have to wait.
#[derive(Debug, Clone, Default)]
pub(super) struct Queue {
    place: Option<Place>,
    delayed: Option<Delayed>,
}

impl Queue {
    /// Drops everything: a new instruction is there.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Keeps an answer for some time [control periods].
    pub fn delay(&mut self, bytes: Bytes, periods: u32) {
        self.delayed = Some(Delayed { bytes, periods });
    }

    /// Waits for the answers of other servos to a synchronous read.
    pub fn wait(&mut self, earlier: &[u8], address: u8, length: u8) {
        self.place = Vec::from_slice(earlier).ok().map(|earlier| Place { earlier, address, length, silence: 0 });
    }

    /// Notes that there is a byte on the bus.
    pub fn hear(&mut self) {
        if let Some(place) = &mut self.place {
            place.silence = 0;
        }
    }

    /// Notes the packet of another servo; returns the read whose turn it is. A packet that is no answer to the read ends
    /// the wait.
    pub fn note(&mut self, packet: &Packet) -> Option<(u8, u8)> {
        let place = self.place.as_mut()?;
        let index = place.earlier.iter().position(|id| *id == packet.id);
        let is_answer = packet.parameters().len() == usize::from(place.length);
        let Some(index) = index.filter(|_| is_answer) else {
            self.place = None;
            return None;
        };
        place.earlier = Vec::from_slice(place.earlier.get(index + 1..)?).ok()?;
        place.earlier.is_empty().then(|| self.take_turn())?
    }

    /// Runs one control period of `period` [s]; returns the read whose turn it is after a silence.
    pub fn tick(&mut self, period: f32) -> Option<(u8, u8)> {
        let place = self.place.as_mut()?;
        place.silence = place.silence.saturating_add(1);
        let is_over = place.silence >= periods(SLOT * place.earlier.len() as f32, period);
        is_over.then(|| self.take_turn())?
    }

    fn take_turn(&mut self) -> Option<(u8, u8)> {
        self.place.take().map(|place| (place.address, place.length))
    }

    /// Runs one control period; returns the answer whose delay is over.
    pub fn due(&mut self) -> Option<Bytes> {
        let delayed = self.delayed.as_mut()?;
        delayed.periods = delayed.periods.saturating_sub(1);
        if delayed.periods == 0 { self.delayed.take().map(|delayed| delayed.bytes) } else { None }
    }
}

/// Control periods of `period` [s] that a time lasts [s], rounded up.
pub(super) fn periods(time: f32, period: f32) -> u32 {
    // A tenth of a permille absorbs the rounding of the quotient.
    libm::ceilf(time / period.max(f32::MIN_POSITIVE) * 0.9999) as u32
}

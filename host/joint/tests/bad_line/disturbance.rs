//! Disturbances of one direction of a line. Position (in bytes), kind and size are drawn from a seed.

use std::collections::VecDeque;
use std::time::Duration;

use link::PROTOCOL_VERSION;
use link::framing::encode;
use link::messages::ToBoard;
use model_core::numbers::random::splitmix64;

/// Longest flood [bytes]: sixteen times the board's buffer.
const FLOOD: u32 = 16 * 1024;

/// Direction of the bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    ToBoard,
    ToHost,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Garbage,
    Flips,
    Cut,
    Delay,
    Zeros,
    Noise,
    Hellos,
    HalfFrame,
    OtherHello,
    Twice,
}

const KINDS: [Kind; 10] = [
    Kind::Garbage,
    Kind::Flips,
    Kind::Cut,
    Kind::Delay,
    Kind::Zeros,
    Kind::Noise,
    Kind::Hellos,
    Kind::HalfFrame,
    Kind::OtherHello,
    Kind::Twice,
];

/// A disturbance at a position in the stream.
#[derive(Debug, Clone, Copy)]
struct Event {
    /// Bytes before the disturbance.
    at: u32,
    kind: Kind,
    /// Waits for the end of the current frame.
    between_frames: bool,
}

/// Random numbers from a seed.
struct Draw(u64);

impl Draw {
    fn below(&mut self, end: u32) -> u32 {
        (((splitmix64(&mut self.0) >> 32) * u64::from(end)) >> 32) as u32
    }

    fn bytes(&mut self, count: u32) -> impl Iterator<Item = u8> + use<'_> {
        (0..count).map(|_| self.below(256) as u8)
    }
}

/// One direction of the line.
pub struct LineFaults {
    direction: Direction,
    events: VecDeque<Event>,
    draw: Draw,
    passed: u32,
    /// Bytes of an undisturbed run.
    run_length: Option<u32>,
    /// Bytes still to be corrupted (`flips`) or dropped (`cut`).
    flips: u32,
    cut: u32,
    /// Frame in progress, the last complete frame, and the last long one: a hello.
    frame: Vec<u8>,
    last: Vec<u8>,
    hello: Vec<u8>,
}

impl LineFaults {
    /// Returns an undisturbed line.
    pub fn undisturbed(direction: Direction) -> Self {
        let (frame, last, hello) = (vec![], vec![], vec![]);
        Self {
            direction,
            events: VecDeque::new(),
            draw: Draw(0),
            passed: 0,
            run_length: None,
            flips: 0,
            cut: 0,
            frame,
            last,
            hello,
        }
    }

    /// Draws new disturbances from a seed and returns them as text. The bytes before the first call are an undisturbed
    /// run and give its length.
    pub fn begin(&mut self, seed: u64) -> String {
        let run_length = *self.run_length.get_or_insert(self.passed);
        self.draw = Draw(seed.wrapping_mul(2) + u64::from(self.direction == Direction::ToHost));
        let draw = &mut self.draw;
        let mut events: Vec<Event> = (0..draw.below(4))
            .map(|_| {
                let (at, kind) = (draw.below(run_length), KINDS[draw.below(KINDS.len() as u32) as usize]);
                Event { at, kind, between_frames: draw.below(2) == 0 }
            })
            .collect();
        events.sort_by_key(|event| event.at);
        self.passed = 0;
        let words = events.iter().map(|event| format!(" {:?} at {}", event.kind, event.at)).collect();
        self.events = events.into();
        words
    }

    /// Ends all disturbances. Dropped or truncated bytes stay lost.
    pub fn end(&mut self) {
        self.events.clear();
        (self.flips, self.cut) = (0, 0);
    }

    /// Passes bytes through the line; returns the output in pieces, each with its delay.
    pub fn transmit(&mut self, bytes: &[u8]) -> Vec<(Duration, Vec<u8>)> {
        let mut pieces = vec![(Duration::ZERO, vec![])];
        for &byte in bytes {
            self.passed += 1;
            self.carry(byte, &mut pieces);
            let (passed, between) = (self.passed, self.frame.is_empty());
            let is_due = |event: &mut Event| event.at <= passed && (between || !event.between_frames);
            while let Some(event) = self.events.pop_front_if(is_due) {
                self.apply(event.kind, &mut pieces);
            }
        }
        pieces
    }

    fn carry(&mut self, byte: u8, pieces: &mut [(Duration, Vec<u8>)]) {
        self.frame.push(byte);
        if byte == 0 {
            self.last = std::mem::take(&mut self.frame);
            // The hello is the longest message that a board sends before a run.
            if self.hello.is_empty() && self.last.len() > 40 {
                self.hello = self.last.clone();
            }
        }
        if self.cut > 0 {
            self.cut -= 1;
            return;
        }
        let changed = if self.flips > 0 { byte ^ (1 << self.draw.below(8)) } else { byte };
        self.flips = self.flips.saturating_sub(1);
        pieces.last_mut().expect("a piece").1.push(changed);
    }

    fn apply(&mut self, kind: Kind, pieces: &mut Vec<(Duration, Vec<u8>)>) {
        let mut more = Vec::new();
        match kind {
            Kind::Garbage => {
                let count = 1 + self.draw.below(64);
                more.extend(self.draw.bytes(count));
            }
            Kind::Flips => self.flips = 1 + self.draw.below(20),
            Kind::Cut => self.cut = 1 + self.draw.below(700),
            Kind::Delay => pieces.push((Duration::from_millis(u64::from(20 + self.draw.below(280))), vec![])),
            Kind::Zeros => more.resize(self.draw.below(FLOOD) as usize, 0),
            Kind::Noise => {
                let count = self.draw.below(FLOOD);
                more.extend(self.draw.bytes(count));
            }
            Kind::Hellos => (0..1 + self.draw.below(200)).for_each(|_| more.extend(self.other_hello())),
            Kind::HalfFrame => more.extend(&self.last[..self.last.len() / 2]),
            Kind::OtherHello => more.extend(self.other_hello()),
            Kind::Twice => more.extend(&self.last),
        }
        pieces.last_mut().expect("a piece").1.extend(more);
    }

    /// Hello of another session: of another host, or the board's own earlier one.
    fn other_hello(&self) -> Vec<u8> {
        match self.direction {
            Direction::ToHost => self.hello.clone(),
            Direction::ToBoard => {
                encode(&ToBoard::Hello { protocol: PROTOCOL_VERSION + 1 }).expect("a short message").to_vec()
            }
        }
    }
}

//! Whether the motor goes where the torque drives it. With a motor encoder or a torque of the wrong sign every loop runs away,
//! and no other check of the encoders sees it: counts and motion fit each other.
//!
//! Symbols: U mean torque of a block, p angle that the motor turns in it, T its length, J inertia of motor and link at the motor.
//! Over two neighbouring blocks, with the torque weighted as the second difference of the angle weights the acceleration,
//!
//! ```text
//! X_k = (U_k + U_(k-1)) / 2        A_k = J (p_k - p_(k-1)) / T^2      (1)
//! x   = X_k - X_(k-2)              y   = A_k - A_(k-2)                (2)
//! ```
//!
//! Of a joint that is rightly wired y = x, more of it while the motor swings or turns alone, less with a heavier link; of one that is
//! not y = -x. A load is in A, and hardly in y: it does not change with the torque. Each pair whose x is large votes.
//!
//! A loop that runs away soon gives all its torque, and then nothing changes any more. So while the motor is faster with each block
//! against a large torque, the compensation is asked to give none in half of the blocks. A load that is stronger than the motor
//! looks the same until then; and what then votes right is that load.

use crate::numbers::Real;
use crate::observer::estimates::TorqueResponse;
use crate::observer::tables::ResponseTable;

/// Votes for the right sign, less those for the wrong one, after which it is not asked again.
const RIGHT: i8 = 6;

/// Votes for the wrong sign, less those for the right one, from which on a motor that runs against its torque has the wrong one.
const WRONG: i8 = 4;

/// Blocks with the motor faster and faster against the torque, less others, from which on it is said to run against it.
const AGAINST: u8 = 2;

/// Blocks after which torques are compared.
const APART: usize = 2;

/// Blocks of a test without torque, the first lowest, and their number: in turns of different lengths, so that nothing swings with them.
const PATTERN: u32 = 0b00_0011_0001_1110_0111;
const PATTERN_BLOCKS: u8 = 18;

/// Blocks in a row without a gap in the readings, and without a throw, that a comparison takes.
const WHOLE: u8 = 4;

/// Votes and what they come from.
#[derive(Debug, Clone, Copy)]
pub struct ResponseCheck<T: Real> {
    response: TorqueResponse,
    /// Votes for the right sign less those for the wrong one.
    votes: i8,
    /// Blocks in which the motor ran against the torque, and was faster with each, less those in which it did not.
    against: u8,
    /// Blocks since it was said to.
    tested: u8,
    /// Periods in this block.
    periods: u16,
    /// Sum of the torque in it [N m].
    torque: T,
    /// Angle turned in it [rad].
    turned: T,
    /// Sum of the torque and angle of the block before.
    before: [T; 2],
    /// X and A of the last two blocks, the latest first [N m].
    pairs: [[T; 2]; APART],
    /// Blocks in a row in which teeth have thrown nothing, as far as that matters.
    whole: u8,
}

impl<T: Real> ResponseCheck<T> {
    /// Part of a change of torque that the change of acceleration is at least, to vote [-]: that of a link six times as heavy as the
    /// joint file says.
    const LEAST: T = T::SIXTH;

    pub fn new() -> Self {
        Self {
            response: TorqueResponse::Unknown,
            votes: 0,
            against: 0,
            tested: 0,
            periods: 0,
            torque: T::ZERO,
            turned: T::ZERO,
            before: [T::ZERO; 2],
            pairs: [[T::ZERO; 2]; APART],
            whole: 0,
        }
    }

    /// What is known so far.
    pub fn response(&self) -> TorqueResponse {
        self.response
    }

    /// Begins a block anew, after a reading or a torque that cannot be used. What was voted stays.
    #[cold]
    pub fn interrupt(&mut self) {
        let response = if self.is_decided() { self.response } else { TorqueResponse::Unknown };
        *self = Self { response, votes: self.votes, ..Self::new() };
    }

    /// Whether nothing is asked any more.
    fn is_decided(&self) -> bool {
        matches!(self.response, TorqueResponse::Right | TorqueResponse::Reversed)
    }

    /// Takes the torque [N m] and the angle that the motor has turned [rad] in a control period.
    #[inline(always)]
    pub fn step(&mut self, table: &ResponseTable<T>, torque: T, turned: T) {
        if self.is_decided() {
            return;
        }
        self.torque += torque;
        self.turned += turned;
        self.periods += 1;
        if self.periods >= table.block {
            self.close(table);
        }
    }

    /// Ends a block.
    #[cold]
    fn close(&mut self, table: &ResponseTable<T>) {
        let now = [self.torque, self.turned];
        let [torque_before, turned_before] = core::mem::replace(&mut self.before, now);
        (self.torque, self.turned, self.periods) = (T::ZERO, T::ZERO, 0);
        // (1)
        let mean = T::HALF * table.per_block * (now[0] + torque_before);
        let acceleration = table.inertia * (now[1] - turned_before);
        let [last, [mean_then, acceleration_then]] = self.pairs;
        self.pairs = [[mean, acceleration], last];
        // What teeth throw is faster than what a torque can do to the motor alone.
        let most = table.alone * if mean.abs() > table.large { mean.abs() } else { table.large };
        self.whole = if acceleration.abs() > most { 0 } else { self.whole.saturating_add(1).min(WHOLE) };
        if self.whole < WHOLE {
            self.response = TorqueResponse::Unknown;
            return;
        }
        if now[1] * turned_before < T::ZERO {
            // A motor that turns round does not run away.
            (self.against, self.tested) = (0, 0);
        } else if mean.abs() > table.large {
            let is_against = now[1] * mean < T::ZERO && acceleration * mean < -Self::LEAST * mean * mean;
            self.against = if is_against { self.against.saturating_add(1) } else { self.against.saturating_sub(1) };
        }
        // (2)
        self.vote(table, mean - mean_then, acceleration - acceleration_then);
        let tests = self.tests();
        self.response = match self.votes {
            votes if votes >= RIGHT => TorqueResponse::Right,
            votes if votes <= -WRONG && self.tested > 0 => TorqueResponse::Reversed,
            _ if tests => TorqueResponse::Tested,
            _ => TorqueResponse::Unknown,
        };
    }

    /// Whether the next block is one without torque: some of them are from when the motor is said to run against its torque until it no
    /// longer does at all.
    fn tests(&mut self) -> bool {
        let goes_on = self.against >= AGAINST || self.tested > 0 && self.against > 0;
        // A load that sets in makes the motor go against a torque that grows: only what a test shows counts for the wrong sign.
        if self.tested == 0 {
            self.votes = self.votes.max(0);
        }
        self.tested = if goes_on { self.tested % PATTERN_BLOCKS + 1 } else { 0 };
        goes_on && PATTERN >> (self.tested - 1) & 1 == 1
    }

    /// Takes a change of torque and the change of acceleration that it came with, as torque [N m].
    fn vote(&mut self, table: &ResponseTable<T>, torque: T, acceleration: T) {
        if torque.abs() <= table.large {
            return;
        }
        let least = Self::LEAST * torque.abs();
        let along = if torque > T::ZERO { acceleration } else { -acceleration };
        if along > least {
            self.votes = self.votes.saturating_add(1);
        } else if along < -least {
            self.votes = self.votes.saturating_sub(1);
        }
    }
}

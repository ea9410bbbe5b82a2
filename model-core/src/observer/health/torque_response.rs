//! Sign check of torque and motor encoder (O25). With a wrong sign every loop runs away, and no other check of the
//! encoders detects it: counts and motion are consistent.
//!
//! Symbols: U mean torque of a block, p angle turned by the motor in a block, T length of a block, J inertia of motor
//! and link at the motor. Over two neighbouring blocks, torque and acceleration are weighted alike:
//!
//! ```text
//! X_k = (U_k + U_(k-1)) / 2        A_k = J (p_k - p_(k-1)) / T^2      (1)
//! x   = X_k - X_(k-2)              y   = A_k - A_(k-2)                (2)
//! ```
//!
//! A correctly wired joint has y = x: y is larger while the motor swings or turns alone, smaller with a heavier link. A
//! joint with a wrong sign has y = -x. A constant load is in A but cancels in y. Every pair with a large x votes.
//!
//! A loop that runs away soon saturates, and x becomes zero. While the motor accelerates against a large torque, the
//! compensation is therefore asked for no torque in half of the blocks. A load stronger than the motor looks like a
//! wrong sign until this test; the test then votes for the right sign.

use super::thresholds::TorqueResponseThresholds;
use crate::estimates::TorqueResponse;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;
use crate::observer::tables::ResponseTable;

/// Blocks between two compared torques.
const APART: usize = 2;

/// Blocks of a test without torque as bits, lowest first, and their number. Pulses of unequal length excite no
/// oscillation.
const PATTERN: u32 = 0b00_0011_0001_1110_0111;
const PATTERN_BLOCKS: u8 = 18;

/// Votes and their evidence.
#[derive(Debug, Clone, Copy, Default)]
pub struct TorqueResponseCheck<T: Real> {
    response: TorqueResponse,
    /// Votes for the right sign less votes for the wrong sign.
    votes: i8,
    /// Blocks in which the motor accelerated against the torque, less all other blocks with a large torque.
    against_torque: u8,
    /// Place in the test pattern, from 1; 0 without a test.
    test_block: u8,
    /// Periods in this block.
    periods: u16,
    /// Sum of the torque in this block [N m].
    torque: T,
    /// Angle turned in this block [rad].
    turned: T,
    /// Sum of the torque and angle turned of the last block.
    last_block: [T; 2],
    /// X and A of the last two blocks, the latest first [N m].
    pairs: [[T; 2]; APART],
    /// Consecutive blocks without a tooth impact, saturated.
    undisturbed_blocks: u8,
}
state_words! {
    struct TorqueResponseCheck<T> {
        response, votes, against_torque, test_block, periods, torque, turned, last_block, pairs, undisturbed_blocks,
    }
}

impl<T: Real> TorqueResponseCheck<T> {
    const LIMITS: TorqueResponseThresholds<T> = TorqueResponseThresholds::TUNED;

    /// Result so far.
    pub fn response(&self) -> TorqueResponse {
        self.response
    }

    /// Starts a new block after an unusable reading or torque. The votes are kept.
    #[cold]
    pub fn interrupt(&mut self) {
        let response = if self.is_decided() { self.response } else { TorqueResponse::Unknown };
        *self = Self { response, votes: self.votes, ..Self::default() };
    }

    /// Returns true once the check has ended.
    fn is_decided(&self) -> bool {
        matches!(self.response, TorqueResponse::Right | TorqueResponse::Reversed)
    }

    /// Adds the torque [N m] and the angle turned by the motor [rad] of a control period.
    #[inline(always)]
    pub fn step(&mut self, table: &ResponseTable<T>, torque: T, turned: T) {
        if self.is_decided() {
            return;
        }
        self.torque += torque;
        self.turned += turned;
        self.periods += 1;
        if self.periods >= table.block {
            self.close_block(table);
        }
    }

    /// Ends a block.
    #[cold]
    fn close_block(&mut self, table: &ResponseTable<T>) {
        let now = [self.torque, self.turned];
        let [torque_before, turned_before] = core::mem::replace(&mut self.last_block, now);
        (self.torque, self.turned, self.periods) = (T::ZERO, T::ZERO, 0);
        // (1)
        let mean = T::HALF * table.per_block * (now[0] + torque_before);
        let acceleration = table.inertia * (now[1] - turned_before);
        let [last, [mean_then, acceleration_then]] = self.pairs;
        self.pairs = [[mean, acceleration], last];
        // A tooth impact accelerates the motor more than the torque can.
        let largest = table.alone * if mean.abs() > table.large { mean.abs() } else { table.large };
        self.undisturbed_blocks = if acceleration.abs() > largest {
            0
        } else {
            self.undisturbed_blocks.saturating_add(1).min(Self::LIMITS.undisturbed_blocks)
        };
        if self.undisturbed_blocks < Self::LIMITS.undisturbed_blocks {
            self.response = TorqueResponse::Unknown;
            return;
        }
        if now[1] * turned_before < T::ZERO {
            // A motor that reverses does not run away.
            (self.against_torque, self.test_block) = (0, 0);
        } else if mean.abs() > table.large {
            let is_against = now[1] * mean < T::ZERO && acceleration * mean < -Self::LIMITS.min_response * mean * mean;
            self.against_torque =
                if is_against { self.against_torque.saturating_add(1) } else { self.against_torque.saturating_sub(1) };
        }
        // (2)
        self.vote(table, mean - mean_then, acceleration - acceleration_then);
        let is_torque_free = self.advance_test();
        self.response = match self.votes {
            votes if votes >= Self::LIMITS.right_votes => TorqueResponse::Right,
            votes if votes <= -Self::LIMITS.wrong_votes && self.test_block > 0 => TorqueResponse::Reversed,
            _ if is_torque_free => TorqueResponse::Tested,
            _ => TorqueResponse::Unknown,
        };
    }

    /// Returns true if the next block carries no torque. A test starts once the motor runs against its torque and lasts
    /// until it no longer does.
    fn advance_test(&mut self) -> bool {
        let continues =
            self.against_torque >= Self::LIMITS.against_blocks || self.test_block > 0 && self.against_torque > 0;
        // A load that sets in drives the motor against a growing torque: only votes during a test count for the wrong
        // sign.
        if self.test_block == 0 {
            self.votes = self.votes.max(0);
        }
        self.test_block = if continues { self.test_block % PATTERN_BLOCKS + 1 } else { 0 };
        continues && PATTERN >> (self.test_block - 1) & 1 == 1
    }

    /// Votes on a change of torque and the resulting change of acceleration, as a torque [N m].
    fn vote(&mut self, table: &ResponseTable<T>, torque: T, acceleration: T) {
        if torque.abs() <= table.large {
            return;
        }
        let smallest = Self::LIMITS.min_response * torque.abs();
        let response = if torque > T::ZERO { acceleration } else { -acceleration };
        if response > smallest {
            self.votes = self.votes.saturating_add(1);
        } else if response < -smallest {
            self.votes = self.votes.saturating_sub(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::Q1;

    const BLOCK: u16 = 4;

    fn table() -> ResponseTable<f32> {
        // A motor whose speed rises by 1/16 rad per period and newton metre has the inertia 1.
        ResponseTable { block: BLOCK, per_block: 0.25, inertia: 1.0, large: 0.5, alone: 4.0 }
    }

    /// Drives a motor for `blocks` blocks, without torque while the check asks for it. `sign`: sign of the response.
    fn drive(check: &mut TorqueResponseCheck<f32>, sign: f32, blocks: u16, torque: impl Fn(u16) -> f32) {
        let mut speed = 0.0;
        for period in 0..blocks * BLOCK {
            let wanted = torque(period / BLOCK);
            let torque = if check.response() == TorqueResponse::Tested { 0.0 } else { wanted };
            speed += sign * torque / 16.0;
            check.step(&table(), torque, speed);
        }
    }

    /// Torque that changes its sign every three blocks.
    fn swinging(block: u16) -> f32 {
        if (block / 3).is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    #[test]
    fn right_sign_is_found() {
        let mut check = TorqueResponseCheck::default();
        drive(&mut check, 1.0, 40, swinging);
        assert_eq!(check.response(), TorqueResponse::Right);
    }

    #[test]
    fn right_sign_needs_votes() {
        let mut check = TorqueResponseCheck::default();
        let votes = TorqueResponseThresholds::<f32>::TUNED.right_votes;
        check.votes = votes - 2;
        check.vote(&table(), 1.0, 1.0);
        assert_eq!(check.votes, votes - 1);
        check.vote(&table(), -1.0, -1.0);
        assert_eq!(check.votes, votes);
        check.vote(&table(), 1.0, -1.0);
        assert_eq!(check.votes, votes - 1);
    }

    #[test]
    fn reversed_sign_is_found_under_constant_torque() {
        let mut check = TorqueResponseCheck::default();
        drive(&mut check, -1.0, 60, |_| 1.0);
        assert_eq!(check.response(), TorqueResponse::Reversed);
    }

    #[test]
    fn small_torque_does_not_vote() {
        let mut check = TorqueResponseCheck::default();
        drive(&mut check, 1.0, 60, |block| 0.24 * swinging(block));
        assert_eq!((check.response(), check.votes), (TorqueResponse::Unknown, 0));
    }

    #[test]
    fn weak_response_does_not_vote() {
        let mut check = TorqueResponseCheck::default();
        check.vote(&table(), 1.0, 0.16);
        check.vote(&table(), 1.0, -0.16);
        assert_eq!(check.votes, 0);
        check.vote(&table(), 1.0, 0.17);
        assert_eq!(check.votes, 1);
    }

    #[test]
    fn tooth_impact_pauses_check() {
        let mut check = TorqueResponseCheck::default();
        drive(&mut check, 1.0, 6, swinging);
        assert_eq!(check.undisturbed_blocks, 4);
        for _ in 0..BLOCK {
            check.step(&table(), 1.0, 10.0);
        }
        assert_eq!((check.undisturbed_blocks, check.response()), (0, TorqueResponse::Unknown));
    }

    #[test]
    fn interrupt_keeps_votes_and_decision() {
        let mut check = TorqueResponseCheck::<f32> { votes: 3, response: TorqueResponse::Tested, ..Default::default() };
        check.interrupt();
        assert_eq!((check.votes, check.response()), (3, TorqueResponse::Unknown));
        check.response = TorqueResponse::Reversed;
        check.interrupt();
        assert_eq!(check.response(), TorqueResponse::Reversed);
    }

    /// First block with a response of a motor with a reversed sign under a constant torque, and the votes then and a
    /// block before.
    fn reversed_until(response: TorqueResponse) -> (u16, [i8; 2]) {
        let after = |blocks| {
            let mut check = TorqueResponseCheck::default();
            drive(&mut check, -1.0, blocks, |_| 1.0);
            check
        };
        let first = (1..100).find(|blocks| after(*blocks).response() == response).expect("the response");
        (first, [first - 1, first].map(|blocks| after(blocks).votes))
    }

    #[test]
    fn four_votes_show_reversed_sign() {
        assert_eq!(reversed_until(TorqueResponse::Reversed).1, [-3, -4]);
    }

    #[test]
    fn two_blocks_against_torque_start_test() {
        // The first comparison needs four blocks without an impact.
        assert_eq!(reversed_until(TorqueResponse::Tested).0, 5);
    }

    #[test]
    fn quarter_of_the_motor_limit_votes() {
        // Q1's motor has 2.5 N m.
        let votes = |torque: f32| {
            let mut check = TorqueResponseCheck::default();
            check.vote(&Q1.response, torque, torque);
            check.votes
        };
        assert_eq!([0.62, 0.63, -0.62, -0.63].map(votes), [0, 1, 0, 1]);
    }
}

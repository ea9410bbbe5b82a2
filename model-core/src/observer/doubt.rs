//! Whether what teeth at rest show belongs to what was learnt: it is learnt, left out, or the width is doubted, for teeth
//! wear, and in the end everything else too. When teeth are at rest is left to `interval`.

use super::interval::rests;
use super::motion::{Shown, magnitude};
use super::regressors::Regressors;
use super::state::Observer;
use crate::numbers::Real;

/// Surprise, in standard deviations, that does not belong to the model.
const GATE: i32 = 5;

/// Surprises in a row after which the width counts as wrong: one may be a blow.
const FEW: u8 = 2;

/// Surprises in a row after which everything that was learnt counts as wrong.
const TOO_MANY: u8 = 12;

/// Intervals with force between the flanks after which the width counts as wrong: three blocks.
const CONTRADICTED: u8 = 24;

/// Times that the width may be doubted before everything else is too.
const DOUBTS: u8 = 3;

/// Ways without surprise on each flank after which a width counts as learnt, and doubts of it are forgotten: a quarter of
/// a second of contact.
const TRUSTED: u8 = 32;

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Force at rest between the flanks, bias and stiction aside, says that they are not where they were learnt to be.
    pub(super) fn contradict(&mut self, way: T, shown: Shown<T>) {
        let known = &self.knowledge;
        let [half_gap, _] = self.shape();
        let thrice = T::THREE * known.steady_force_deviation + T::TWO * magnitude(self.bias.friction);
        let between = known.width_is_known && magnitude(way) < half_gap - known.blur;
        let against = between && rests(shown) && magnitude(self.interval.steady) > thrice;
        self.doubts.contradicted = if against { self.doubts.contradicted + 1 } else { 0 };
        if self.doubts.contradicted >= CONTRADICTED {
            self.doubts.contradicted = 0;
            self.doubt_narrow();
        }
    }

    /// The gap seems narrower than was learnt. Teeth do not grow: if it had been seen on both flanks for long, the output
    /// encoder fails.
    fn doubt_narrow(&mut self) {
        let [back, drive] = self.doubts.trusted;
        if back.min(drive) < TRUSTED {
            self.doubt();
        } else {
            self.disbelieve();
        }
    }

    /// The width is not what was learnt. If it had not been seen on both flanks for long, or that has been said too often,
    /// nothing else is sure either.
    fn doubt(&mut self) {
        let [back, drive] = core::mem::take(&mut self.doubts.trusted);
        self.doubts.doubted += 1;
        if back.min(drive) < TRUSTED || self.doubts.doubted > DOUBTS {
            self.doubts.doubted = 0;
            self.learner.reopen();
        } else {
            self.learner.doubt_width();
        }
    }

    /// On which flank teeth came to rest: by force, or by how they came there. True if it is known.
    pub(super) fn tell_flank(&mut self) -> bool {
        let (regressors, way) = self.block.full();
        let told = self.block.side();
        let side = if told == T::ZERO {
            self.tell_by_way(&regressors, way)
        } else {
            self.anchor.ride().told(told);
            told
        };
        self.anchor.put(&regressors, way, side);
        self.block.tell(side);
        side != T::ZERO
    }

    /// On which flank teeth came to rest, by the way; 0 if that is not known. Then what the way depends on beside the flank
    /// is learnt, if it is known at least that it is one.
    fn tell_by_way(&mut self, regressors: &Regressors<T, P>, way: T) -> T {
        let tables = self.tables;
        let [half_gap, _] = self.shape();
        let Some(weighed) = self.anchor.weigh(&tables.learner, &self.learner, regressors, way) else { return T::ZERO };
        let side = self.anchor.side(&tables.learner, &weighed, regressors, half_gap, tables.levers.output);
        if self.motion.is_sharp(self.anchor.ride().half_gap_at_least(half_gap)) {
            // Teeth also turn round inside the gap, for a moment at rest: then nothing has stopped them; and they leave a
            // flank slowly, at rest for a while: then they carry nothing any more.
            let force = if self.anchor.was_on(side) { self.interval.steady } else { self.interval.rested };
            let felt = side * force > self.knowledge.steady_force_deviation;
            let side = if felt { side } else { self.anchor.ride().side() };
            if side != T::ZERO {
                return side;
            }
        }
        let belongs = weighed.surprise * weighed.surprise < T::from_i32(GATE * GATE) * weighed.expected;
        if belongs && self.anchor.ride().lasts(half_gap) {
            self.places.relearn(&mut self.learner, |learner| learner.learn(&tables.learner, &weighed));
        }
        T::ZERO
    }

    /// Takes a way in settled contact into the learner, unless it does not belong to the model.
    pub(super) fn take_rest(&mut self) {
        let table = &self.tables.learner;
        let [half_gap, _] = self.shape();
        let (regressors, way) = self.block.full();
        let weight = table.weight * self.block.worth(table, self.knowledge.width_is_known);
        let weighed = self.learner.weigh(table, &regressors, way, weight);
        if weighed.surprise * weighed.surprise > T::from_i32(GATE * GATE) * weighed.expected {
            self.doubts.surprises += 1;
            let worth = half_gap * self.tables.contact.known_part;
            if self.doubts.surprises >= TOO_MANY {
                self.doubts.surprises = 0;
                self.learner.reopen();
            } else if self.doubts.surprises == FEW && magnitude(weighed.surprise) * table.noise > worth {
                if self.block.side() * weighed.surprise < T::ZERO {
                    self.doubt_narrow();
                } else {
                    self.doubt();
                }
            }
            return;
        }
        self.doubts.surprises = 0;
        let [back, drive] = &mut self.doubts.trusted;
        let trusted = if self.block.side() > T::ZERO { &mut *drive } else { &mut *back };
        *trusted = trusted.saturating_add(1);
        if (*back).min(*drive) > TRUSTED {
            self.doubts.doubted = 0;
        }
        self.places.relearn(&mut self.learner, |learner| learner.learn(table, &weighed));
    }
}

//! Whether what teeth at rest show belongs to what was learnt: it is learnt, left out, or the width is doubted, for teeth
//! wear, and in the end everything else too. When teeth are at rest is left to `interval`.

use super::Observer;
use super::interval::rests;
use super::learner::Regressors;
use super::motion::{Shown, magnitude};
use super::regressors::HALF_GAP;
use crate::real::Real;

/// Surprise, in standard deviations, that does not belong to the model.
const GATE: i32 = 5;

/// Surprises in a row after which the width counts as wrong: one may be a blow.
const FEW: u32 = 2;

/// Surprises in a row after which everything that was learnt counts as wrong.
const TOO_MANY: u32 = 12;

/// Intervals with force between the flanks after which the width counts as wrong: three blocks.
const CONTRADICTED: u32 = 24;

/// Times that the width may be doubted before everything else is too.
const DOUBTS: u32 = 3;

/// Ways without surprise on each flank after which a width counts as learnt, and doubts of it are forgotten: a quarter of
/// a second of contact.
const TRUSTED: u32 = 32;

/// What speaks against what was learnt.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Doubts {
    /// Intervals in a row with force between the flanks.
    contradicted: u32,
    /// Ways in a row that did not belong to the model.
    surprises: u32,
    /// Ways without surprise on the back side and on the drive side since the width was doubted.
    trusted: [u32; 2],
    /// How often it was.
    doubted: u32,
}

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
            self.doubt();
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

    /// Learns from teeth at rest, if it is known on which flank: by force, or by how they came there.
    pub(super) fn take_rest(&mut self, regressors: &Regressors<T, P>, way: T) {
        let [told, ..] = regressors.as_slice() else { return };
        let told = *told;
        let tables = self.tables;
        let lever = tables.levers.output;
        let side = if told == T::ZERO {
            let side = self.anchor.side(&tables.learner, &self.learner, regressors, way, lever);
            // Teeth also turn round inside the gap, for a moment at rest: then they carry nothing.
            if side * self.interval.steady > self.knowledge.steady_force_deviation { side } else { T::ZERO }
        } else {
            told
        };
        self.anchor.put(regressors, way, side);
        if side != T::ZERO {
            let mut regressors = *regressors;
            if let Some(half_gap) = regressors.get_mut(HALF_GAP) {
                *half_gap = side;
            }
            self.take_way(&regressors, way);
        }
    }

    /// Takes a way in settled contact into the learner, unless it does not belong to the model.
    fn take_way(&mut self, regressors: &Regressors<T, P>, way: T) {
        let table = &self.tables.learner;
        let [half_gap, _] = self.shape();
        let worth = half_gap * self.tables.contact.known_part;
        let surprise = way - self.learner.way(regressors);
        let variance = self.learner.variance(table, regressors) + table.noise * table.noise;
        if surprise * surprise > T::from_i32(GATE * GATE) * variance {
            self.doubts.surprises += 1;
            if self.doubts.surprises >= TOO_MANY {
                self.doubts.surprises = 0;
                self.learner.reopen();
            } else if self.doubts.surprises == FEW && magnitude(surprise) > worth {
                self.doubt();
            }
            return;
        }
        self.doubts.surprises = 0;
        let drives = regressors.first().is_some_and(|side| *side > T::ZERO);
        let [back, drive] = &mut self.doubts.trusted;
        let trusted = if drives { &mut *drive } else { &mut *back };
        *trusted = trusted.saturating_add(1);
        if (*back).min(*drive) > TRUSTED {
            self.doubts.doubted = 0;
        }
        self.learner.learn(table, regressors, way);
    }
}

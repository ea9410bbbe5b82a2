//! An interval: means over a few periods, and what lasts longer. What they show is left to `learning`.

use super::motion::Shown;
use super::now::Now;
use crate::numbers::Real;
use parameters::ContactState;

/// Intervals of rest on a flank after which contact counts as settled: the window of the speed has passed, and the
/// swing of an impact with it.
const SETTLED_AFTER: u8 = 3;

/// Sums over the periods of an interval, and what lasts longer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval<T: Real> {
    pub periods: u16,
    sums: Mean<T>,
    pub part: Part,
    /// Direction of the motor's dry friction, mean over the last interval.
    pub direction: T,
    /// Nearer side of the gap then.
    pub nearer: T,
    /// Flank of the last rest that was learnt from.
    pub learnt_on: ContactState,
    /// Side on which contact settled last, unless the teeth have left it since.
    pub side: T,
    /// Mesh force over the last interval [N].
    pub force: T,
    /// Flank on which the teeth were pressed then.
    pub pressed: ContactState,
    /// Mesh force over a few intervals [N].
    pub steady: T,
    /// Mesh force over the whole rest, landing included [N].
    pub rested: T,
    /// Intervals in a row well inside the gap.
    pub open_for: u8,
}

/// What is averaged.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mean<T: Real> {
    pub raw: T,
    pub lost: T,
    pub force: T,
    pub direction: T,
}

impl<T: Real> Mean<T> {
    const NONE: Self = Self { raw: T::ZERO, lost: T::ZERO, force: T::ZERO, direction: T::ZERO };
}

impl<T: Real> Interval<T> {
    pub fn new() -> Self {
        Self {
            periods: 0,
            sums: Mean::NONE,
            part: Part::Done,
            direction: T::ZERO,
            nearer: T::ONE,
            learnt_on: ContactState::Separated,
            side: T::ZERO,
            force: T::ZERO,
            pressed: ContactState::Separated,
            steady: T::ZERO,
            rested: T::ZERO,
            open_for: 0,
        }
    }

    pub fn add(&mut self, now: &Now<T>) {
        self.sums.raw += now.raw;
        self.sums.lost += now.lost;
        self.sums.force += now.force;
        self.sums.direction += now.direction;
        self.periods += 1;
    }

    /// Sums become means.
    pub fn close(&mut self, per_periods: T) -> Mean<T> {
        let Mean { raw, lost, force, direction } = core::mem::replace(&mut self.sums, Mean::NONE);
        self.periods = 0;
        Mean {
            raw: raw * per_periods,
            lost: lost * per_periods,
            force: force * per_periods,
            direction: direction * per_periods,
        }
    }
}

/// What of an interval's work is next: each period does a part of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// Nothing is left.
    Done,
    /// What the link answered to the force; whether there is a rest to learn from besides.
    Answer(bool),
    /// On which flank the teeth came to rest.
    Tell,
    /// Learning it, if it belongs to what was learnt.
    Learn,
    /// How much is known now.
    Know,
    /// Saying it.
    Say,
}

/// Whether the teeth have been at rest for long enough.
pub(super) fn rests<T: Real>(shown: Shown<T>) -> bool {
    matches!(shown, Shown::Still(intervals) if intervals >= SETTLED_AFTER)
}

//! A learning interval: means over a few control periods, what they show, and what of the work that follows is next.

use super::fusion::Fused;
use super::travel::Travel;
use crate::gears::Flank;
use crate::numbers::Real;

/// Intervals of rest on a flank after which contact counts as settled: the window of the speed has passed, and the
/// swing of an impact with it.
const SETTLED_AFTER: u8 = 3;

/// Sums over the periods of an interval, and what lasts longer.
#[derive(Debug, Clone, Copy)]
pub struct Interval<T: Real> {
    pub periods: u16,
    sums: Mean<T>,
    pub task: Task,
    /// Direction of the motor's dry friction, mean over the last interval.
    pub direction: T,
    /// Nearer side of the gap then.
    pub nearer: Flank,
    /// Flank of the last rest that was learnt from.
    pub learnt_on: Option<Flank>,
    /// Flank on which contact settled last, unless the teeth have left it since.
    pub flank: Option<Flank>,
    /// Mesh force over the last interval [N].
    pub force: T,
    /// Flank of loaded contact then.
    pub loaded: Option<Flank>,
    /// Mesh force over a few intervals [N].
    pub steady: T,
    /// Mesh force over the whole rest, landing included [N].
    pub rested: T,
    /// Intervals in a row well inside the gap.
    pub open_for: u8,
}

/// What is averaged.
#[derive(Debug, Clone, Copy)]
pub struct Mean<T: Real> {
    pub measured: T,
    pub lost: T,
    pub force: T,
    pub direction: T,
}

impl<T: Real> Mean<T> {
    const NONE: Self = Self { measured: T::ZERO, lost: T::ZERO, force: T::ZERO, direction: T::ZERO };
}

impl<T: Real> Interval<T> {
    pub fn new() -> Self {
        Self {
            periods: 0,
            sums: Mean::NONE,
            task: Task::Done,
            direction: T::ZERO,
            nearer: Flank::Drive,
            learnt_on: None,
            flank: None,
            force: T::ZERO,
            loaded: None,
            steady: T::ZERO,
            rested: T::ZERO,
            open_for: 0,
        }
    }

    pub fn add(&mut self, fused: &Fused<T>) {
        self.sums.measured += fused.measured;
        self.sums.lost += fused.lost;
        self.sums.force += fused.force;
        self.sums.direction += fused.direction;
        self.periods += 1;
    }

    /// Sums become means.
    pub fn close(&mut self, per_periods: T) -> Mean<T> {
        let Mean { measured, lost, force, direction } = core::mem::replace(&mut self.sums, Mean::NONE);
        self.periods = 0;
        Mean {
            measured: measured * per_periods,
            lost: lost * per_periods,
            force: force * per_periods,
            direction: direction * per_periods,
        }
    }
}

/// Whether teeth rest in an interval that may be learnt from, and on which flank.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rest {
    /// They do not, as far as is known.
    No,
    /// They do; `None` if it is not known on which flank.
    On(Option<Flank>),
}

/// What of an interval's work is next: each period does one task, so that none has to do them all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// Nothing is left.
    Done,
    /// What the link answered to the force; whether there is a rest to learn from besides.
    Inertia(bool),
    /// On which flank the teeth came to rest.
    Flank,
    /// Whether a rest on a flank belongs to what was learnt.
    Weigh,
    /// Learning from it.
    Learn,
    /// How uncertain everything is now.
    Uncertainty,
    /// What follows from it until the next interval.
    Conclude,
}

/// Whether the teeth have been at rest for long enough.
pub fn rests<T: Real>(travel: Travel<T>) -> bool {
    matches!(travel, Travel::AtRest(intervals) if intervals >= SETTLED_AFTER)
}

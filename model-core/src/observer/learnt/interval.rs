//! Learning interval: means over a few control periods, and the next task of the work after the interval.

use super::fusion::Fused;
use super::travel::Travel;
use crate::gears::Flank;
use crate::numbers::Real;

/// Intervals of rest on a flank after which contact counts as settled: the window of the speed is over, and the
/// oscillation after an impact has decayed.
const SETTLED_AFTER: u8 = 3;

/// Sums over the periods of an interval, and values that outlast the interval.
#[derive(Debug, Clone, Copy)]
pub struct Interval<T: Real> {
    pub periods: u16,
    sums: Mean<T>,
    pub task: Task,
    /// Direction of the motor's dry friction, mean over the last interval.
    pub direction: T,
    /// Nearer flank in the last interval.
    pub nearer: Flank,
    /// Flank of the last rest that updated the parameters.
    pub learnt_on: Option<Flank>,
    /// Flank of the last settled contact, until the teeth leave it.
    pub flank: Option<Flank>,
    /// Mean mesh force in the last interval [N].
    pub force: T,
    /// Flank of loaded contact in the last interval.
    pub loaded: Option<Flank>,
    /// Mesh force averaged over a few intervals [N].
    pub steady: T,
    /// Mesh force averaged over the whole rest, landing included [N].
    pub rested: T,
    /// Consecutive intervals well inside the gap.
    pub open_for: u8,
}

/// Averaged quantities.
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

    /// Returns the means and clears the sums.
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

/// Rest of the teeth in an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rest {
    /// No rest is known.
    No,
    /// Rest on a flank; `None` for an unknown flank.
    On(Option<Flank>),
}

/// Next task after an interval: each period does one task, so that the load is spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// No task is left.
    Done,
    /// Updates the inertia from the link's response to the force; true if a rest follows.
    Inertia(bool),
    /// Determines the flank of the rest.
    Flank,
    /// Accepts or rejects a rest on a flank.
    Weigh,
    /// Updates the parameters with the rest.
    Learn,
    /// Updates the variances.
    Uncertainty,
    /// Updates the values that hold until the next interval.
    Conclude,
}

/// Returns true once the teeth have been at rest long enough.
pub fn rests<T: Real>(travel: Travel<T>) -> bool {
    matches!(travel, Travel::AtRest(intervals) if intervals >= SETTLED_AFTER)
}

//! Learning interval: means over a few control periods, and the next task of the work after the interval.

use super::mesh_measurement::MeshMeasurement;
use super::thresholds::FLANK;
use super::travel::Travel;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::state_words::{Layout, Reader, StateWords, Writer, state_words};

/// Sums over the periods of an interval, and values that outlast the interval.
#[derive(Debug, Clone, Copy)]
pub struct Interval<T: Real> {
    pub periods: u16,
    sums: IntervalMean<T>,
    pub task: Task,
    /// Direction of the motor's dry friction, mean over the last interval.
    pub direction: T,
    /// Nearer flank in the last interval.
    pub nearer_flank: Flank,
    /// Flank of the last dwell that updated the parameters.
    pub updated_on: Option<Flank>,
    /// Flank of the last settled contact, until the teeth leave it.
    pub settled_flank: Option<Flank>,
    /// Mean mesh force in the last interval [N].
    pub force: T,
    /// Flank of loaded contact in the last interval.
    pub loaded_flank: Option<Flank>,
    /// Mesh force averaged over a few intervals [N].
    pub steady_force: T,
    /// Mesh force averaged over the whole dwell, landing included [N].
    pub dwell_force: T,
    /// Consecutive intervals well inside the gap.
    pub open_intervals: u8,
}
state_words! {
    struct Interval<T> {
        periods, sums, task, direction, nearer_flank, updated_on, settled_flank, force, loaded_flank, steady_force,
        dwell_force, open_intervals,
    }
}

/// Averaged quantities.
#[derive(Debug, Clone, Copy)]
pub struct IntervalMean<T: Real> {
    pub raw_deflection: T,
    pub motor_force: T,
    pub force: T,
    pub direction: T,
}
state_words! { struct IntervalMean<T> { raw_deflection, motor_force, force, direction } }

impl<T: Real> IntervalMean<T> {
    const NONE: Self = Self { raw_deflection: T::ZERO, motor_force: T::ZERO, force: T::ZERO, direction: T::ZERO };
}

impl<T: Real> Interval<T> {
    pub fn new() -> Self {
        Self {
            periods: 0,
            sums: IntervalMean::NONE,
            task: Task::Done,
            direction: T::ZERO,
            nearer_flank: Flank::Drive,
            updated_on: None,
            settled_flank: None,
            force: T::ZERO,
            loaded_flank: None,
            steady_force: T::ZERO,
            dwell_force: T::ZERO,
            open_intervals: 0,
        }
    }

    pub fn add(&mut self, measurement: &MeshMeasurement<T>) {
        self.sums.raw_deflection += measurement.raw_deflection;
        self.sums.motor_force += measurement.motor_force;
        self.sums.force += measurement.force;
        self.sums.direction += measurement.direction;
        self.periods += 1;
    }

    /// Returns the means and clears the sums.
    pub fn close(&mut self, per_periods: T) -> IntervalMean<T> {
        let IntervalMean { raw_deflection, motor_force, force, direction } =
            core::mem::replace(&mut self.sums, IntervalMean::NONE);
        self.periods = 0;
        IntervalMean {
            raw_deflection: raw_deflection * per_periods,
            motor_force: motor_force * per_periods,
            force: force * per_periods,
            direction: direction * per_periods,
        }
    }
}

/// Rest of the teeth in an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dwell {
    /// No dwell is known.
    No,
    /// Rest on a flank; `None` for an unknown flank.
    On(Option<Flank>),
}

/// Next task after an interval: each period does one task, so that the load is spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// No task is left.
    Done,
    /// Updates the inertia from the link's response to the force; true if a dwell follows.
    Inertia(bool),
    /// Determines the flank of the dwell.
    Flank,
    /// Accepts or rejects a dwell on a flank.
    CheckDwell,
    /// Updates the parameters with the dwell.
    UpdateParameters,
    /// Updates the variances.
    Uncertainty,
    /// Updates the values that hold until the next interval.
    UpdateLimits,
}

impl StateWords for Task {
    const LAYOUT: Layout = Layout::EMPTY.with("task", u32::LAYOUT).with("dwell_follows", bool::LAYOUT);

    fn write(&self, to: &mut Writer) {
        let (task, dwell_follows) = match *self {
            Self::Done => (0, false),
            Self::Inertia(dwell_follows) => (1, dwell_follows),
            Self::Flank => (2, false),
            Self::CheckDwell => (3, false),
            Self::UpdateParameters => (4, false),
            Self::Uncertainty => (5, false),
            Self::UpdateLimits => (6, false),
        };
        to.word(task);
        dwell_follows.write(to);
    }

    fn read(from: &mut Reader) -> Self {
        let (task, dwell_follows) = (from.word(), bool::read(from));
        match task {
            1 => Self::Inertia(dwell_follows),
            2 => Self::Flank,
            3 => Self::CheckDwell,
            4 => Self::UpdateParameters,
            5 => Self::Uncertainty,
            6 => Self::UpdateLimits,
            _ => Self::Done,
        }
    }
}

/// Returns true once the teeth have been at rest long enough.
pub fn is_settled<T: Real>(travel: Travel<T>) -> bool {
    matches!(travel, Travel::AtRest(intervals) if intervals >= FLANK.settled_intervals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rest_settles_after_limit() {
        assert!(!is_settled(Travel::<f32>::AtRest(FLANK.settled_intervals - 1)));
        assert!(is_settled(Travel::<f32>::AtRest(FLANK.settled_intervals)));
        assert!(!is_settled(Travel::<f32>::Undecided) && !is_settled(Travel::Crossing(1.0, 1.0)));
    }

    #[test]
    fn closed_interval_is_mean() {
        let mut interval = Interval::<f32>::new();
        for force in [1.0, 3.0] {
            interval.add(&MeshMeasurement {
                flank_shift: 0.0,
                raw_deflection: 2.0,
                deflection: 0.0,
                rate: 0.0,
                travel: 0.0,
                motor_force: force,
                direction: 1.0,
                force,
            });
        }
        let mean = interval.close(0.5);
        assert_eq!((mean.force, mean.raw_deflection, interval.periods), (2.0, 2.0, 0));
        assert_eq!(interval.close(0.5).force, 0.0);
    }
}

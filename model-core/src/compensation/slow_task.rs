//! Distribution of the slow tasks over three control periods, so that no tick bears all of them.

use crate::numbers::Real;
use crate::numbers::state_words::state_words;

/// Task of a control period, in addition to computing the torque.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SlowTask {
    /// Check of the loop by the monitor.
    Monitor,
    /// Update of edges and target of the inverse of the backlash.
    UpdateEdges,
    /// Update of inertia, friction and load in the inverse of the backlash.
    EstimateDemand,
}
state_words! { enum SlowTask { Monitor, UpdateEdges, EstimateDemand } }

impl SlowTask {
    /// Control periods between two turns of a task.
    pub fn periods<T: Real>() -> T {
        T::THREE
    }

    /// Task of the next control period.
    pub fn following(self) -> Self {
        match self {
            Self::Monitor => Self::UpdateEdges,
            Self::UpdateEdges => Self::EstimateDemand,
            Self::EstimateDemand => Self::Monitor,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn task_returns_after_its_periods() {
        let tasks = core::iter::successors(Some(SlowTask::Monitor), |task| Some(task.following()));
        let next = tasks.skip(1).take(9).position(|task| task == SlowTask::Monitor);
        assert_eq!(next.map(|between| between as f64 + 1.0), Some(SlowTask::periods::<f64>()));
    }
}

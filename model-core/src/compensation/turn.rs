//! Distribution of the slow tasks over three control periods, so that no tick bears all of them.

use crate::numbers::Real;

/// Task of a control period besides the torque.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turn {
    /// Judgement by the monitor of the loop.
    Judges,
    /// Update of edges and target of the inverse of the backlash.
    Observes,
    /// Update of inertia, friction and load in the inverse of the backlash.
    Learns,
}

impl Turn {
    /// Control periods between two turns of a task.
    pub fn periods<T: Real>() -> T {
        T::THREE
    }

    /// Task of the next control period.
    pub fn next(self) -> Self {
        match self {
            Self::Judges => Self::Observes,
            Self::Observes => Self::Learns,
            Self::Learns => Self::Judges,
        }
    }
}

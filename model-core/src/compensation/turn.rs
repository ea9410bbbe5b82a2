//! Whose turn it is: what is as slow as the loop is done in one of three control periods, so that no tick bears all of it.

use crate::numbers::Real;

/// What one control period has time for beside the torque.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turn {
    /// The monitor judges.
    Judges,
    /// The inverse of the backlash observes where the motor is on the flanks.
    Observes,
    /// It learns what the motor has to move.
    Learns,
}

impl Turn {
    /// Control periods from a turn to its next.
    pub fn periods<T: Real>() -> T {
        T::THREE
    }

    /// That of the next control period.
    pub fn next(self) -> Self {
        match self {
            Self::Judges => Self::Observes,
            Self::Observes => Self::Learns,
            Self::Learns => Self::Judges,
        }
    }
}

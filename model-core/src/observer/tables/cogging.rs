//! Constants of the estimation of the motor's cogging (O17).

use crate::numbers::Real;

/// Motor cogging. A learning interval is a few control periods; the cogging phase is the motor's angle times the
/// cogging periods per turn.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CoggingTable<T: Real> {
    /// Cogging periods per motor turn.
    pub periods: u32,
    /// Intervals on one flank after which the landing has decayed from the load torque.
    pub settled_after: u32,
    /// Gain per interval of the filter for the slow part of the load torque [-].
    pub slow: T,
    /// Time constant of this filter times the cogging periods [s].
    pub slow_time: T,
    /// Lowest and highest motor speed at which the load torque shows the cogging [rad/s].
    pub speeds: [T; 2],
    /// Gain per interval of the filter for the slow part of the speed [-].
    pub steady: T,
    /// Largest deviation from the slow part of the speed, over the speed [-].
    pub unsteady: T,
    /// Response of the load torque to the cogging: 1 over 1 + j w a - w^2 b - j w^3 c, with the motor's speed w: a [s],
    /// b [s^2], c [s^3].
    pub response: [T; 3],
    /// Lag of the motor side as cogging phase, for each rad/s of the motor [2^-32 periods s].
    pub late: T,
    /// Initial variance of sine and of cosine [N^2 m^2].
    pub prior: T,
    /// Limit of sine and of cosine [N m].
    pub limit: T,
    /// Correlation length of the noise [intervals].
    pub repeats: T,
    /// Gain per interval of the filter for the mean square of this noise [-].
    pub memory: T,
}

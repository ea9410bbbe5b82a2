//! What learning the motor's cogging needs as plain numbers.

use crate::numbers::Real;

/// The motor's cogging. A learning interval is a few control periods; the cogging phase is the motor's angle times the
/// periods of the cogging in a turn.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CoggingTable<T: Real> {
    /// Periods in a turn of the motor.
    pub periods: u32,
    /// Intervals on one flank after which the load torque has forgotten the landing.
    pub settled_after: u32,
    /// Part of its change in an interval by which the slow part of the load torque follows [-].
    pub slow: T,
    /// The time constant of that times the periods [s].
    pub slow_time: T,
    /// Speeds of the motor between which the load torque shows the cogging [rad/s].
    pub speeds: [T; 2],
    /// Part of its change in an interval by which the slow part of the speed follows [-].
    pub steady: T,
    /// Largest part of the speed by which it may be beside that [-].
    pub unsteady: T,
    /// What the load torque says of the cogging is 1 over 1 + j w a - w^2 b - j w^3 c, with the motor's speed w: a [s], b [s^2], c
    /// [s^3].
    pub response: [T; 3],
    /// Cogging phase by which the motor side is late, for each rad/s of the motor [2^-32 periods s].
    pub late: T,
    /// Variance of sine and of cosine beforehand [N^2 m^2].
    pub prior: T,
    /// Neither is larger than this [N m].
    pub limit: T,
    /// Intervals over which noise says the same [-].
    pub repeats: T,
    /// Part of its change in an interval by which the mean square of that noise follows [-].
    pub memory: T,
}

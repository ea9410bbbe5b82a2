//! What learning the link's inertia needs as plain numbers.

use crate::numbers::Real;

/// The link's inertia. A learning interval is a few control periods.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct InertiaTable<T: Real> {
    /// 1 over the control periods of an interval.
    pub per_periods: T,
    /// The load side over an interval, while the link stands still: angle, speed and torque then, each from the three
    /// before and from the torque of the meshes.
    pub still: [[T; 4]; 3],
    /// Part of its change in an interval by which the slow part of a torque follows [-].
    pub slow: T,
    /// Speed beyond which the link turns for sure [rad/s].
    pub moving: T,
    /// Intervals after which everything slow has forgotten that the link turned round.
    pub settled_after: u32,
    /// Fast torque below which nothing is learnt [N m].
    pub least: T,
    /// Variance of the answer that one interval shows, all that repeats from interval to interval included [N^2 m^2].
    pub noise: T,
    /// Mean square of the answer without a force, beyond which nothing is learnt [N^2 m^2].
    pub most_restless: T,
    /// Part of its change in an interval by which that mean follows [-].
    pub memory: T,
    /// Variance of the mobility beforehand [-].
    pub prior: T,
    /// The mobility is never further from 1 than this [-].
    pub limit: T,
    /// Part of its square below which the ratio's variance counts as known [-].
    pub known: T,
    /// Growth of the variance in an interval.
    pub drift: T,
}

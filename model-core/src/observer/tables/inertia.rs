//! Constants of the estimation of the link's inertia (O6).

use crate::numbers::Real;

/// Link inertia. A learning interval is a few control periods.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct InertiaTable<T: Real> {
    /// 1 over the control periods of an interval.
    pub per_periods: T,
    /// Load filter over an interval with a stationary link: each row gives angle, speed and torque at the end from
    /// angle, speed and torque at the beginning and from the mesh torque.
    pub still: [[T; 4]; 3],
    /// Gain per interval of the filter for the slow part of a torque [-].
    pub slow: T,
    /// Speed above which the link certainly turns [rad/s].
    pub moving: T,
    /// Intervals after a reversal until all slow parts have settled.
    pub settled_after: u32,
    /// Least fast torque that updates the estimate [N m].
    pub least: T,
    /// Variance of the response in one interval, inflated for correlation between intervals [N^2 m^2].
    pub noise: T,
    /// Mean square of the response without a force above which the estimate is not updated [N^2 m^2].
    pub most_restless: T,
    /// Gain per interval of the filter for this mean square [-].
    pub memory: T,
    /// Initial variance of the mobility [-].
    pub prior: T,
    /// Largest deviation of the mobility from 1 [-].
    pub limit: T,
    /// Variance of the ratio over its square below which the ratio counts as known [-].
    pub known: T,
    /// Growth of the variance in an interval [-].
    pub drift: T,
}

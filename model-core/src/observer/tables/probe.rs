//! What the width probe needs as plain numbers, made by `observer::design`. The observer's own are next door.

use crate::numbers::Real;

/// The width probe.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ProbeTable<T: Real> {
    /// Single torque; the probe goes up to twice that [N m].
    pub torque: T,
    /// Part of the lacking torque that is made good in a period [-].
    pub rise: T,
    /// Torque for each rad/s of the motor that softens landings [N m s/rad].
    pub damping: T,
    /// Motor speed above which it is not at rest [rad/s].
    pub moving: T,
    /// Mesh torque at the carrier above which the load is not off [N m].
    pub loaded: T,
    /// Motor angle that teeth and wind-up cannot allow [rad].
    pub furthest: T,
    /// Periods after which the probe gives up.
    pub longest: u32,
    /// Periods that a torque is given to settle.
    pub settle: u32,
    /// Periods at rest over which an angle is taken.
    pub still: u32,
    /// 1 over them.
    pub per_still: T,
    /// A turn [rad].
    pub turn: T,
    /// Way along the line of action in a radian of the motor [m].
    pub deflection: T,
    /// Way between the flanks below which nothing has moved [m].
    pub least: T,
    /// Variance of the deflection between the flanks [m^2].
    pub variance: T,
}

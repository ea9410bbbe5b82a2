//! Constants of the width probe (O28), made by `observer::design`.

use crate::numbers::Real;

/// Width probe.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ProbeTable<T: Real> {
    /// Single torque; the probe also commands twice this torque [N m].
    pub torque: T,
    /// Part of the missing torque that is added in a period [-].
    pub rise: T,
    /// Damping that softens landings: torque per motor speed [N m s/rad].
    pub damping: T,
    /// Motor speed above which the motor is not at rest [rad/s].
    pub moving: T,
    /// Mesh torque at the carrier above which the link is loaded [N m].
    pub loaded: T,
    /// Motor angle beyond teeth and wind-up, at which the probe ends [rad].
    pub furthest: T,
    /// Periods after which the probe ends without a result.
    pub longest: u32,
    /// Settling time of a torque [periods].
    pub settle: u32,
    /// Periods at rest over which an angle is averaged.
    pub still: u32,
    /// 1 over `still`.
    pub per_still: T,
    /// A turn [rad].
    pub turn: T,
    /// Deflection along the line of action per radian of the motor [m].
    pub deflection: T,
    /// Distance between the flanks below which nothing has moved [m].
    pub least: T,
    /// Variance of the measured distance between the flanks [m^2].
    pub variance: T,
}

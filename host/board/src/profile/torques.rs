//! Motor and load torque at one time, and the largest torque that is accepted.

/// No joint that this is for gives or takes more: it is a slip of the unit [N m].
pub const MAX_TORQUE: f64 = 1e6;

/// Torques at one time: drive on the sun shaft, load that brakes the link [N m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Torques {
    pub drive: f64,
    pub load: f64,
}

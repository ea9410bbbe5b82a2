//! Motor and load torque at one time, and the largest accepted torque.

/// Largest accepted torque; a larger one is a wrong unit [N m].
pub const MAX_TORQUE: f64 = 1e6;

/// Torques at one time: drive on the sun shaft, load that brakes the link [N m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Torques {
    pub drive: f64,
    pub load: f64,
}

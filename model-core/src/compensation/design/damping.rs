//! Damping of a joint (K2), and the part of it that may act on the motor alone, given the delays of the loop.

use super::body::JointBody;
use super::settings::CompensationSettings;
use crate::compensation::thresholds::LAW;

/// Time from a measurement until the torque that responds to it has mostly taken effect, T_r [s].
pub(super) fn reaction(settings: &CompensationSettings, period: f64) -> f64 {
    period * (1.0 + settings.torque_delay) + settings.torque_lag
}

/// Damper that places all three poles of motor and link at the bandwidth, D [N m s/rad].
pub(super) fn loop_damping(body: &JointBody, bandwidth: f64) -> f64 {
    3.0 * (body.motor + body.load) * bandwidth
}

/// Part of the damper that may act on the motor alone, D_m [N m s/rad]: with more, the motor would swing against the
/// delays of the loop.
pub(super) fn motor_damping_bound(body: &JointBody, damping: f64, reaction: f64) -> f64 {
    damping.min(body.motor / (LAW.motor_damping_time * reaction))
}

//! Damping of a joint (K2), and the part of it that the motor bears with the delays of the loop.

use super::body::JointBody;
use super::settings::CompensationSettings;
use crate::compensation::thresholds::LAW;

/// Time from a measurement to most of the effect of the torque that answers it, T_r [s].
pub(super) fn reaction(settings: &CompensationSettings, period: f64) -> f64 {
    period * (1.0 + settings.torque_delay) + settings.torque_lag
}

/// Damper that places all three poles of motor and link at the bandwidth, D [N m s/rad].
pub(super) fn loop_damping(body: &JointBody, bandwidth: f64) -> f64 {
    3.0 * (body.motor + body.load) * bandwidth
}

/// Part of the damper that the motor alone bears with a reaction time, D_m [N m s/rad].
pub(super) fn motor_damping_bound(body: &JointBody, damping: f64, reaction: f64) -> f64 {
    damping.min(body.motor / (LAW.motor_damping_time * reaction))
}

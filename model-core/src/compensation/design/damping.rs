//! Damping of a joint (K2), and the part of it that the motor bears with the delays of the loop.

use super::body::Body;
use super::settings::CompensationSettings;

/// Time in which the damper on the motor slows the motor by 1/e [reaction times]: with fewer the motor would swing
/// against the delays of the loop.
const MOTOR_DAMPING: f64 = 2.5;

/// Time from a measurement to most of the effect of the torque that answers it, T_r [s].
pub(super) fn reaction(settings: &CompensationSettings, period: f64) -> f64 {
    period * (1.0 + settings.torque_delay) + settings.torque_lag
}

/// Damper that places all three poles of motor and link at the bandwidth, D [N m s/rad].
pub(super) fn of_both(body: &Body, bandwidth: f64) -> f64 {
    3.0 * (body.motor + body.load) * bandwidth
}

/// Part of the damper that the motor alone bears with a reaction time, D_m [N m s/rad].
pub(super) fn on_motor_alone(body: &Body, damping: f64, reaction: f64) -> f64 {
    damping.min(body.motor / (MOTOR_DAMPING * reaction))
}

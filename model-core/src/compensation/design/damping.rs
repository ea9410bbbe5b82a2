//! How much a joint is damped, and how much of that its motor bears in the loop's delays.

use super::body::Body;
use super::settings::CompensationSettings;

/// Reaction times in which the damper on the motor slows the motor by 1/e: with fewer it would swing against the loop's
/// delays.
const MOTOR_DAMPING: f64 = 2.5;

/// From a reading to most of what a torque does about it [s].
pub(super) fn reaction(settings: &CompensationSettings, period: f64) -> f64 {
    period * (1.0 + settings.torque_delay) + settings.torque_lag
}

/// Damper that motor and link need together for all three poles at the bandwidth [N m s/rad].
pub(super) fn of_both(body: &Body, bandwidth: f64) -> f64 {
    3.0 * (body.motor + body.load) * bandwidth
}

/// The part of it that the motor alone bears with such a reaction time [N m s/rad].
pub(super) fn on_motor_alone(body: &Body, damping: f64, reaction: f64) -> f64 {
    damping.min(body.motor / (MOTOR_DAMPING * reaction))
}

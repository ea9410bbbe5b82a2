//! Control laws of drives. With the errors of angle e = target - angle and speed e' = target speed - speed:
//!
//! - parallel law: torque = k e + d e' + k_i integral(e) + feed-forward;
//! - cascade: v = target speed + k_p e, limited to the largest speed; torque = k_v (v - speed) + k_vi integral(v - speed)
//!   + feed-forward;
//! - speed: the inner loop of the cascade.
//!
//! An integral stops while its torque limit holds. An error of angle within the dead zone counts as zero.

use super::Feedback;
use super::gains::Law;
use super::settings::Settings;
use super::target::{SetPoint, Target};
use crate::scale;
use crate::turns::Turns;

/// Integrals of both laws [N m].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Integrals {
    position: f32,
    velocity: f32,
}

/// Torque at the output for a set-point [N m].
pub(super) fn torque(settings: &Settings, set_point: &SetPoint, now: &Feedback, integrals: &mut Integrals) -> f32 {
    match set_point {
        SetPoint::Brake => settings.short_circuit_torque(now.velocity),
        SetPoint::Torque { torque, max_velocity } => limited_torque(settings, *torque, *max_velocity, now),
        SetPoint::Velocity { velocity, torque, max_torque, .. } => {
            velocity_loop(settings, *velocity, *max_torque, 1.0, now, integrals) + torque
        }
        SetPoint::Position(target) => position_loop(settings, target, now, integrals),
        SetPoint::Impedance { position, velocity, stiffness, damping, torque } => {
            let error = position.minus(now.position).to_rad();
            stiffness * error + damping * (velocity - now.velocity) + torque
        }
        SetPoint::Within { low, high, target } => {
            let beyond = |bound: Option<Turns>, is_beyond: fn(&Turns, &Turns) -> bool| {
                bound.filter(|bound| is_beyond(&now.position, bound))
            };
            match beyond(*low, Turns::lt).or(beyond(*high, Turns::gt)) {
                Some(bound) => {
                    position_loop(settings, &Target { position: bound, velocity: 0.0, ..*target }, now, integrals)
                }
                None => {
                    *integrals = Integrals::default();
                    target.torque
                }
            }
        }
    }
}

/// Torque command that decays to zero over a tenth of the largest speed beyond it.
fn limited_torque(settings: &Settings, torque: f32, max_velocity: f32, now: &Feedback) -> f32 {
    let most = max_velocity.abs().min(settings.max_velocity);
    if !most.is_finite() || most <= 0.0 {
        return if most > 0.0 { torque } else { 0.0 };
    }
    let excess = (now.velocity * torque.signum() - most) / (0.1 * most);
    torque * (1.0 - excess).clamp(0.0, 1.0)
}

fn position_loop(settings: &Settings, target: &Target, now: &Feedback, integrals: &mut Integrals) -> f32 {
    let gains = &settings.gains;
    let error = outside_dead_zone(settings.dead_zone, target.position.minus(now.position).to_rad());
    match settings.law {
        Law::Parallel => {
            let limit = (settings.integral_limit * target.integral_scale).max(0.0);
            let next = integrals.position + gains.integral * error * settings.period;
            integrals.position = scale::limit(next, limit);
            target.stiffness_scale * gains.stiffness * error
                + target.damping_scale * gains.damping * (target.velocity - now.velocity)
                + integrals.position
                + target.torque
        }
        Law::Cascade => {
            let most = settings.max_velocity;
            let wanted = target.velocity + target.stiffness_scale * gains.position * error;
            let wanted = scale::limit(wanted, most);
            velocity_loop(settings, wanted, target.max_torque, target.damping_scale, now, integrals) + target.torque
        }
    }
}

/// Error of the angle, zero within the dead zone [rad].
fn outside_dead_zone((below, above): (f32, f32), error: f32) -> f32 {
    if -below <= error && error <= above { 0.0 } else { error }
}

fn velocity_loop(
    settings: &Settings,
    velocity: f32,
    max_torque: f32,
    scale: f32,
    now: &Feedback,
    integrals: &mut Integrals,
) -> f32 {
    let gains = &settings.gains;
    let most = settings.max_velocity;
    let error = scale::limit(velocity, most) - now.velocity;
    let torque_limit = max_torque.min(settings.torque_limit * settings.ratio.to_f32());
    let limit = torque_limit.min(settings.velocity_integral_limit).max(0.0);
    // The integral holds while the torque is cut off.
    if !now.is_limited || integrals.velocity * error < 0.0 {
        let next = integrals.velocity + gains.velocity_integral * error * settings.period;
        integrals.velocity = scale::limit(next, limit);
    }
    scale * gains.velocity * error + integrals.velocity
}

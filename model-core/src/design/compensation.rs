//! Tables of the compensation: from joint, bandwidth and limits to gains, times and thresholds. What is done with them
//! is left to `realtime::compensation`.

use core::f64::consts::TAU;

use crate::error::DesignError;
use crate::joint::JointParameters;
use crate::real::Real;
use crate::tables::compensation::CompensationTables;

/// What the compensation is designed from besides the joint. The joint's own half-backlash is a guess to start from.
#[derive(Debug, Clone, PartialEq)]
pub struct CompensationSettings {
    /// Control periods a second [Hz].
    pub control_rate: u32,
    /// Bandwidth of the motor controller: its three poles [rad/s].
    pub bandwidth: f64,
    /// Largest torque of the motor [N m].
    pub torque_limit: f64,
    /// From commanding a torque to its first effect [control periods].
    pub torque_delay: f64,
    /// Time constant of the current loop after that [s].
    pub torque_lag: f64,
}

/// Tables of the compensation.
pub fn design_compensation<T: Real>(
    joint: &JointParameters,
    settings: &CompensationSettings,
) -> Result<CompensationTables<T>, DesignError> {
    let real = T::from_f64;
    let geometry = &joint.geometry;
    let lever = geometry.carrier_base_radius();
    let gear = geometry.ratio_by_teeth();
    let period = 1.0 / f64::from(settings.control_rate);
    let sun = geometry.sun_base_radius * geometry.sun_base_radius;
    let motor_inertia = gear * gear * (joint.rotor_inertia + joint.bodies.sun_equivalent_mass * sun);
    let planets = geometry.planets as f64 * joint.bodies.planet_equivalent_mass;
    let load_inertia = (planets + joint.carrier_equivalent_mass()) * lever * lever + joint.link_inertia;
    let inertia = motor_inertia + load_inertia;
    let pole = settings.bandwidth;
    let half_backlash =
        joint.sun_planet.half_backlash.iter().sum::<f64>() / geometry.planets as f64;
    let env = |name: &str, default: f64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    let crossing = env("CROSS", 8e-3);
    Ok(CompensationTables {
        control_rate: settings.control_rate,
        period: real(period),
        ratio: [(geometry.sun_teeth + geometry.ring_teeth) as i32, geometry.sun_teeth as i32],
        gear: real(gear),
        inverse_gear: real(1.0 / gear),
        inverse_denominator: real(1.0 / f64::from(geometry.sun_teeth)),
        turn: real(TAU),
        inverse_lever: real(1.0 / lever),
        motor_inertia: real(motor_inertia),
        load_inertia: real(load_inertia),
        inverse_load_inertia: real(1.0 / load_inertia),
        position_gain: real(3.0 * inertia * pole * pole),
        damping_gain: real(3.0 * inertia * pole),
        integral_gain: real(inertia * pole * pole * pole * period),
        free_position_gain: real(env("FREEKP", 3.0 * inertia * pole * pole)),
        free_damping_gain: real(env("FREEKD", 3.0 * inertia * pole)),
        back_calculation: real(pole * period),
        torque_limit: real(gear * settings.torque_limit),
        half_backlash: real(half_backlash),
        doubt: real(env("DOUBT", 0.02) * gear * settings.torque_limit),
        lead: real(env("LEAD", crossing) + period * (1.0 + settings.torque_delay) + settings.torque_lag),
        crossing: real(crossing),
        hysteresis: real(env("HYST", 0.005) * gear * settings.torque_limit),
        landing_rise: real(period / env("RISE", 2e-3)),
        seek_speed: real(env("SEEK", 0.05)),
        load_learner: [real(env("QB", 1e-3)), real(env("QF", 1e-6)), real(env("RL", 1.0))],
        friction_slope: real(1.0 / env("VF", 0.01)),
        opening: real(env("OPEN", 0.3)),
        calm: settings.control_rate,
    })
}

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
    let half_backlash = joint.sun_planet.half_backlash.iter().sum::<f64>() / geometry.planets as f64;
    let env = |name: &str, default: f64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    // Planets that hang at the old flank are struck at the path's highest speed, 15/8 of its mean: the force of each is
    // that speed times sqrt(stiffness mass). As a torque at the link, over the lost motion that is crossed.
    let planets = geometry.planets as f64;
    let impedance = libm::sqrt(joint.sun_planet.mean_stiffness * joint.bodies.planet_equivalent_mass);
    let strike_per_half = 15.0 / 8.0 * 4.0 * lever * planets * impedance * 2.0 * lever;
    let strike_torque = env("FORCE", 0.5) * joint.rated_output_torque;
    let reaction = period * (1.0 + settings.torque_delay) + settings.torque_lag;
    let limit = gear * settings.torque_limit;
    let half = half_backlash / lever;
    // Least-jerk paths need 10/sqrt(3) way/time^2 of acceleration.
    let by_torque = |half: f64| libm::sqrt(10.0 / libm::sqrt(3.0) * 2.0 * half * motor_inertia / (env("SHARE", 0.8) * limit));
    let shortest = by_torque(half).max(8.0 * reaction);
    let crossing = (strike_per_half * half / strike_torque).max(shortest);
    let lead = crossing + reaction;
    let demand_pole = env("DPOLE", 2.0 / crossing) * period;
    Ok(CompensationTables {
        rate: real(f64::from(settings.control_rate)),
        period: real(period),
        ratio: [(geometry.sun_teeth + geometry.ring_teeth) as i32, geometry.sun_teeth as i32],
        gear: real(gear),
        inverse_gear: real(1.0 / gear),
        inverse_denominator: real(1.0 / f64::from(geometry.sun_teeth)),
        turn: real(TAU),
        inverse_lever: real(1.0 / lever),
        widest_half: real(5.0 * half),
        motor_inertia: real(motor_inertia),
        load_inertia: real(load_inertia),
        inverse_load_inertia: real(1.0 / load_inertia),
        motor_share: real(motor_inertia / inertia),
        position_gain: real(3.0 * inertia * pole * pole),
        damping_gain: real(3.0 * inertia * pole),
        integral_gain: real(inertia * pole * pole * pole * period),
        back_calculation: real(pole * period),
        free_position_gain: real(env("FREEKP", 3.0 * inertia * pole * pole)),
        free_damping_gain: real(env("FREEKD", 3.0 * inertia * pole)),
        torque_limit: real(limit),
        lead: real(lead),
        reaction: real(reaction),
        strike_per_half: real(strike_per_half),
        strike_torque: real(strike_torque),
        shortest_crossing: real(shortest),
        longest_crossing: real(env("LONG", 3.0) * crossing),
        landing_speed: real(env("SEEK", 0.05)),
        landing_haste: real(env("HASTE", 1.0) * env("SEEK", 0.05) / crossing),
        fastest_landing: real(env("FAST", 6.0) * env("SEEK", 0.05)),
        landing_rise: real(period / env("RISE", 2e-3)),
        repayment: real(1.0 / env("REPAY", 10e-3)),
        opening: real(env("OPEN", 0.3)),
        hysteresis: real(env("HYST", 0.005) * limit),
        doubt: real(env("DOUBT", 0.02) * limit),
        least_doubt: real(env("LEAST", 0.3)),
        settling: real(1.0 - libm::exp(-period / env("FILT", 6e-3))),
        eagerness: real(1.0 / (env("EAGER", 0.05) * limit)),
        foresight: real(env("EXTRA", 1.0)),
        patience_left: real(libm::exp(-period * pole / env("PAT", 3.0))),
        most_patience: real(env("MOSTPAT", 6.0)),
        hunting: real(15.0 / pole),
        first_indulgence: real(env("IND1", 0.05)),
        last_indulgence: real(env("IND2", 0.5)),
        forgiving: real(1.0 - period / env("FORGIVE", 30.0)),
        load_learner: [real(env("QB", 1e-3)), real(env("QF", 1e-6)), real(env("RL", 1.0))],
        friction_slope: real(1.0 / env("VF", 0.01)),
        demand_gains: [real(1.0 - libm::exp(-2.0 * demand_pole)), real((1.0 - libm::exp(-demand_pole)) * (1.0 - libm::exp(-demand_pole)) / period)],
        trust_step: real(period / 20e-3),
    })
}

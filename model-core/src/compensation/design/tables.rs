//! Tables of the compensation: gains, times and thresholds from joint, bandwidth and limits.
//!
//! Gains follow from inertias and bandwidth; times from the motor's torque, the delays of the loop and the permitted
//! landing force. The remaining shares stand in `compensation/thresholds.rs`, each with its origin. Equations:
//! `docs/theory/compensation.md`.

use core::f64::consts::TAU;

use super::body::JointBody;
use super::damping::{loop_damping, motor_damping_bound, reaction};
use super::settings::{CompensationSettings, check};
use super::stability;
use crate::compensation::crossing_timing::CrossingTiming;
use crate::compensation::tables::{
    BodyTable, CompensationTables, ControlClockTable, CrossingTable, GearTable, LandingTable, LawTable, LimitTable,
    LoadModelTable, MonitorTable, RestTable, SwitchingTable,
};
use crate::compensation::thresholds::{CROSSING, LANDING, LAW, LIMITS, LOAD, MONITOR, REST, SWITCHING};
use crate::gears::design::{DesignError, validate};
use crate::gears::gear_losses;
use crate::numbers::Real;
use parameters::JointParameters;

/// Computes the tables of the compensation from joint and settings.
pub fn design_compensation<T: Real>(
    joint: &JointParameters,
    settings: &CompensationSettings,
) -> Result<CompensationTables<T>, DesignError> {
    validate(joint)?;
    check(settings)?;
    let real = T::from_f64;
    let period = 1.0 / f64::from(settings.control_rate);
    let pole = settings.bandwidth;
    let body = JointBody::new(joint);
    stability::check(&body, settings)?;
    let inertia = body.motor + body.load;
    // Growth of a variance per period, over the variance of a measurement.
    let [load_growth, friction_growth] =
        [LOAD.gravity_time_squared, LOAD.friction_time_squared].map(|square| period * period / square);
    let limit = body.gear * settings.torque_limit;
    let half = body.half_backlash / body.lever;
    let reaction = reaction(settings, period);
    let damping = loop_damping(&body, pole);

    // The peak acceleration of a ramp without a jump is one and a half times its mean.
    let ramp_per_speed = 1.5 * body.motor / (CROSSING.torque_share * limit);
    let shortest_ramp = 0.5 * CROSSING.shortest * reaction;
    let rated = joint.rated_output_torque;
    let peak = settings.peak_torque.unwrap_or(limit.min(LIMITS.peak_per_rated * rated));
    let hardest_strike = CROSSING.strike_per_peak * peak;
    let strike_torque = hardest_strike.min(CROSSING.strike_per_rated * rated);
    let most_passed = LIMITS.teeth_per_peak * peak;
    let crossing =
        CrossingTiming::at(strike_torque / body.strike_impedance, 2.0 * half, ramp_per_speed, shortest_ramp).duration;
    let motor_damping = motor_damping_bound(&body, damping, reaction);
    // Impedance of a blow: motor inertia against the stiffness of the joint [N m s/rad].
    let blow = libm::sqrt(body.stiffness * body.motor);
    let landing_speed = LANDING.force_per_rated * rated / blow;
    Ok(CompensationTables {
        clock: ControlClockTable { rate: real(f64::from(settings.control_rate)), period: real(period) },
        gear: GearTable {
            motor_per_link: real(body.gear),
            link_per_motor: real(1.0 / body.gear),
            turn: real(TAU),
            inverse_lever: real(1.0 / body.lever),
            mesh_phase_per_radian: real(f64::from(joint.geometry.ring_teeth) / TAU * f64::powi(2.0, 32)),
            radians_per_mesh: real(1.0 / f64::from(joint.geometry.ring_teeth)),
            cogging_periods: settings.cogging_periods,
            cogging_phase_per_radian: real(f64::from(settings.cogging_periods) * body.gear / TAU * f64::powi(2.0, 32)),
            losses: gear_losses(settings.efficiency).map(real),
        },
        body: BodyTable {
            motor_inertia: real(body.motor),
            load_inertia: real(body.load),
            inverse_load_inertia: real(1.0 / body.load),
            load_share: real(body.load / inertia),
            inverse_load_share: real(inertia / body.load),
            reduced_inertia: real(body.motor * body.load / inertia),
            compliances: [
                real(LIMITS.compliance_ratio / body.stiffness),
                real(1.0 / (LIMITS.compliance_ratio * body.stiffness)),
            ],
            widest_half: real(LIMITS.widest_gap_ratio * half),
        },
        limits: LimitTable {
            motor: real(limit),
            teeth: real(most_passed),
            least_room: real(LIMITS.least_room * most_passed),
            teeth_at_most: real(if peak < limit { most_passed } else { limit }),
            braking: real(LIMITS.braking),
        },
        law: LawTable {
            position: real(3.0 * inertia * pole * pole),
            damping: real(damping),
            rate: real(pole),
            motor_damping: real(motor_damping),
            impedance_damping: real(LAW.impedance_damping),
            integral: real(inertia * pole * pole * pole * period),
            back_calculation: real(pole * period),
            trust_step: real(period * pole / LAW.trust_time),
            longest_hold: real(LAW.longest_hold),
        },
        crossing: CrossingTable {
            lead: real(crossing + reaction),
            reaction: real(reaction),
            // Double pole of the motor alone.
            stiffness: real(motor_damping * motor_damping / (4.0 * body.motor)),
            strike_speed_per_torque: real(1.0 / body.strike_impedance),
            strike_torque: real(strike_torque),
            hardest_strike: real(hardest_strike),
            shortest_ramp: real(shortest_ramp),
            ramp_per_speed: real(ramp_per_speed),
            longest: real(CROSSING.longest * crossing),
            shorten: real(CROSSING.shorten),
        },
        landing: LandingTable {
            speed: real(landing_speed),
            speed_per_torque: real(LANDING.force_per_demand / blow),
            acceleration: real(landing_speed / crossing),
            fastest: real((LANDING.force_per_demand * limit / blow).max(landing_speed)),
            rise: real(period / (LANDING.rise_time * reaction)),
            repayment: real(1.0 / (LANDING.recovery_time * crossing)),
            opening: real(LANDING.opening),
            landed: real(LANDING.landed),
        },
        switching: SwitchingTable {
            planned: real(SWITCHING.planned * limit),
            measured: real(SWITCHING.measured * limit),
            least: real(SWITCHING.least),
            most_growth: real(SWITCHING.most_growth * 3.0 * inertia * pole * pole),
            transient_left: real(libm::exp(-period * pole / SWITCHING.transient)),
            most_factor: real(SWITCHING.most_factor),
            smoothing: real(1.0 - libm::exp(-period / (SWITCHING.smoothing_time * reaction))),
            inverse_step: real(1.0 / (SWITCHING.large_step * limit)),
        },
        rest: RestTable {
            hunting: real(REST.hunting / pole),
            first_deadband: real(REST.first_deadband),
            largest_deadband: real(REST.largest_deadband),
            deadband_left: real(libm::exp(-period / REST.deadband_memory)),
        },
        load: LoadModelTable {
            variances: [real(load_growth), real(friction_growth), T::ONE],
            // Steady gain for a random walk that grows slowly against the measurement noise.
            gain: real(libm::sqrt(load_growth)),
            rate_gain: real(1.0 / LOAD.rate_time),
            rate_left: real(libm::exp(-period / LOAD.rate_memory)),
            fastest: real(limit / LOAD.rate_time),
            friction_slope: real(1.0 / LOAD.friction_speed),
            planned_friction_slope: real(1.0 / LOAD.planned_friction_speed),
            frictions: [body.gear * settings.motor_friction, settings.load_friction].map(real),
        },
        watch: MonitorTable {
            smoothing: real(-libm::expm1(-period * MONITOR.slow_load_corner)),
            least_demand: real(SWITCHING.planned * limit),
            leaks: [MONITOR.leak, MONITOR.calm_leak].map(real),
            most: real(MONITOR.changes),
            calm_per_half: real(MONITOR.calm_error),
            memory: real(-libm::expm1(-period / MONITOR.averaging_time)),
            error_per_half: real(MONITOR.hunting_error),
            error_per_demand: real(MONITOR.error_per_deflection / (3.0 * inertia * pole * pole)),
            first_away: real(MONITOR.first_retry),
            longest_away: real(MONITOR.longest_retry),
            longer: real(MONITOR.retry_growth),
        },
    })
}

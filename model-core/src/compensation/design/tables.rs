//! Tables of the compensation: gains, times and thresholds from joint, bandwidth and limits.
//!
//! Gains follow from inertias and bandwidth; times from the motor's torque, the delays of the loop and the permitted
//! landing force. The remaining shares are the constants of this file, each with its reason. Equations:
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
use crate::gears::design::{DesignError, validate};
use crate::gears::gear_losses;
use crate::numbers::Real;
use parameters::JointParameters;

/// Force on planets struck in the gap, over the rated force: planets struck repeatedly take up to one and a half times
/// the estimated first blow, which leaves three fifths.
const STRIKE: f64 = 0.4;

/// Largest force on planets struck in the gap, over the peak torque, at any demand: a planet caught bisect sun and
/// flank is struck harder each time.
const HARDEST_STRIKE: f64 = 0.56;

/// Torque through the teeth that the law may ask for, over the peak torque: torque constant, efficiency and the swing
/// within the loop's delays each take a few hundredths.
const MOST_PASSED: f64 = 0.88;

/// Share of the available torque that braking is planned with (K12): torque constant, inertia and the crossing to the
/// braking flank take a few hundredths each.
const BRAKING: f64 = 0.9;

/// Lower bound of the room P - F over P in (K11): smaller than the uncertainty of the torques.
const LEAST_ROOM: f64 = 0.1;

/// Peak torque over rated torque if neither settings nor motor give less: the least that gear catalogues allow.
const PEAK: f64 = 2.0;

/// Largest factor bisect estimated compliance and the joint file's; estimates beyond are clamped.
const COMPLIANCE: f64 = 4.0;

/// Share of the largest torque for the path of a crossing; feedback along the path has the rest.
const CROSSING_TORQUE: f64 = 0.8;

/// Share of D_m in impedance mode (K3): the part of a commanded damper that the loop's delays take.
const IMPEDANCE_DAMPING: f64 = 0.1;

/// Shortest crossing [reaction times]: feedback has no effect in a shorter crossing.
const REACTIONS_IN_A_CROSSING: f64 = 8.0;

/// Longest crossing, over the crossing of the guessed gap: allows for a wider gap.
const LONGEST: f64 = 3.0;

/// Share of the remaining time of a path below which a new path replaces it: small increases of the demand do not.
const SHORTEN: f64 = 0.8;

/// Force of a landing at the end of a path, over the rated torque.
const LANDING: f64 = 0.03;

/// Force of a landing over the torque that the flank will carry, where that is more.
const LANDING_UNDER_LOAD: f64 = 0.4;

/// Rise time of the law's torque after a landing [reaction times]; the limit (K11) bounds the torque reached.
const RISE: f64 = 1.0;

/// Smoothing time of measured torque before decisions [reaction times]: the observer's torques are wrong for a few
/// milliseconds after every impact.
const SETTLING: f64 = 15.0;

/// Opening over the half-gap beyond which a flank counts as lost: several times the observer's error.
const OPENING: f64 = 0.3;

/// Opening over the half-gap below which a flank counts as touched: the residual of the observer's errors.
const LANDED: f64 = 0.03;

/// Planned torque beyond which a change of its sign counts, over the largest torque.
const PLANNED: f64 = 0.005;

/// Uncertainty of a measured torque after an impact, over the largest torque.
const MEASURED: f64 = 0.02;

/// Hysteresis long after the last flank change, over `MEASURED`.
const LEAST_MEASURED: f64 = 0.3;

/// Largest factor g of the hysteresis after several changes (K13).
const MOST_FACTOR: f64 = 6.0;

/// Largest growth of the hysteresis, over the torque that an error of half the lost motion asks for: waiting longer for
/// a flank costs more than a change in vain.
const MOST_GROWTH: f64 = 0.3;

/// Time constant of a transient of the loop, times the bandwidth. Grown hysteresis decays over it, because by then the
/// new flank has corrected the error of an early crossing. The memory of a push that suspends the limit (K11) decays
/// over the same time.
const TRANSIENT: f64 = 6.0;

/// Time bisect requests for opposite flanks below which a joint at rest hunts, times the bandwidth.
const HUNTING: f64 = 15.0;

/// Change of a torque beyond which its smoothing is faster, over the largest torque.
const LARGE_STEP: f64 = 0.05;

/// Dead band at rest without a load over half the lost motion: without hunting, largest (K15). With the largest the
/// joint rests within half of its lost motion.
const DEADBAND: [f64; 2] = [0.05, 0.5];

/// Time constant with which a grown dead band decays [s]: long against the hunting that it ends.
const DEADBAND_KEPT: f64 = 30.0;

/// Speed at which dry friction reaches its full size [rad/s]: the resolution of encoders, for want of a better number.
const FRICTION_SPEED: f64 = 0.01;

/// Planned speed at which dry friction reaches its full size [rad/s]: a motion passes it in a few control periods.
const PLANNED_FRICTION_SPEED: f64 = 1e-3;

/// Square of the time constant of the load estimate [s^2]: a few milliseconds.
const LOAD_FOLLOWED: f64 = 1e-5;

/// Time constant of the estimated rate of the load [s]: a weight swings in a second.
const LOAD_RATE: f64 = 0.03;

/// Time constant with which the rate of the load decays while no flank carries [s].
const LOAD_RATE_KEPT: f64 = 0.1;

/// Square of the time constant of the friction estimate [s^2]: friction is found within a few reversals, then kept for
/// seconds.
const FRICTION_FOLLOWED: f64 = 1e-2;

/// Time in which a missed impulse is returned, over the time of a crossing (K16).
const REPAYMENT: f64 = 1.15;

/// Longest time bisect impedance set-points of a moving stream [s]: streams send at least 200 per second.
const LONGEST_HOLD: f64 = 5e-3;

/// Time of blending from plain to compensated control, times the bandwidth; the other way takes one period.
const TRUST: f64 = 1.2;

/// Corner of the slow load that explains a flank [rad/s]: below the modes of flexible payloads (8 Hz and more), above
/// loads by people and steps.
const SLOW_LOAD: f64 = 25.0;

/// Decay of the count of unexplained flank changes: in general, while the error is small [1/s]. A link without friction
/// drifts from flank to flank fifteen times per second, at a tenth of the error of plain control.
const HUNTING_LEAK: [f64; 2] = [1.0, 20.0];

/// Unexplained flank changes beyond which the loop hunts [-]. Tuned on `hil/never-worse.toml`: a joint that follows an
/// alternating load leaves a flank as often as some joints that hunt.
const HUNTING_CHANGES: f64 = 4.0;

/// RMS error that is small, over half the lost motion [-]: a third of the error without compensation.
const HUNTING_CALM: f64 = 0.35;

/// Averaging time of the squared error [s]. `HUNTING_ERROR`: RMS error beyond which the loop hunts, over half the lost
/// motion [-]; control that ignores the gap leaves the link on either flank, at half the lost motion.
const HUNTING_ERROR_TIME: f64 = 0.15;
const HUNTING_ERROR: f64 = 1.5;

/// Additional permitted error, over the deflection of the loop's spring by the demand [-]: inertia and load that are 30
/// % wrong.
const HUNTING_ERROR_BY_DEMAND: f64 = 0.3;

/// Time of plain control after a trip: first, longest [s]. `AWAY_GROWTH`: growth with each trip [-].
const AWAY: [f64; 2] = [10.0, 120.0];
const AWAY_GROWTH: f64 = 4.0;

/// Largest estimate of half the lost motion, over the guess.
const WIDEST: f64 = 5.0;

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
    let [load_growth, friction_growth] = [LOAD_FOLLOWED, FRICTION_FOLLOWED].map(|square| period * period / square);
    let limit = body.gear * settings.torque_limit;
    let half = body.half_backlash / body.lever;
    let reaction = reaction(settings, period);
    let damping = loop_damping(&body, pole);

    // The peak acceleration of a ramp without a jump is one and a half times its mean.
    let ramp_per_speed = 1.5 * body.motor / (CROSSING_TORQUE * limit);
    let shortest_ramp = 0.5 * REACTIONS_IN_A_CROSSING * reaction;
    let rated = joint.rated_output_torque;
    let peak = settings.peak_torque.unwrap_or(limit.min(PEAK * rated));
    let hardest_strike = HARDEST_STRIKE * peak;
    let strike_torque = hardest_strike.min(STRIKE * rated);
    let most_passed = MOST_PASSED * peak;
    let crossing =
        CrossingTiming::at(strike_torque / body.strike_impedance, 2.0 * half, ramp_per_speed, shortest_ramp).duration;
    let motor_damping = motor_damping_bound(&body, damping, reaction);
    // Impedance of a blow: motor inertia against the stiffness of the joint [N m s/rad].
    let blow = libm::sqrt(body.stiffness * body.motor);
    let landing_speed = LANDING * rated / blow;
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
            compliances: [real(COMPLIANCE / body.stiffness), real(1.0 / (COMPLIANCE * body.stiffness))],
            widest_half: real(WIDEST * half),
        },
        limits: LimitTable {
            motor: real(limit),
            teeth: real(most_passed),
            least_room: real(LEAST_ROOM * most_passed),
            teeth_at_most: real(if peak < limit { most_passed } else { limit }),
            braking: real(BRAKING),
        },
        law: LawTable {
            position: real(3.0 * inertia * pole * pole),
            damping: real(damping),
            rate: real(pole),
            motor_damping: real(motor_damping),
            impedance_damping: real(IMPEDANCE_DAMPING),
            integral: real(inertia * pole * pole * pole * period),
            back_calculation: real(pole * period),
            trust_step: real(period * pole / TRUST),
            longest_hold: real(LONGEST_HOLD),
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
            longest: real(LONGEST * crossing),
            shorten: real(SHORTEN),
        },
        landing: LandingTable {
            speed: real(landing_speed),
            speed_per_torque: real(LANDING_UNDER_LOAD / blow),
            acceleration: real(landing_speed / crossing),
            fastest: real((LANDING_UNDER_LOAD * limit / blow).max(landing_speed)),
            rise: real(period / (RISE * reaction)),
            repayment: real(1.0 / (REPAYMENT * crossing)),
            opening: real(OPENING),
            landed: real(LANDED),
        },
        switching: SwitchingTable {
            planned: real(PLANNED * limit),
            measured: real(MEASURED * limit),
            least: real(LEAST_MEASURED),
            most_growth: real(MOST_GROWTH * 3.0 * inertia * pole * pole),
            transient_left: real(libm::exp(-period * pole / TRANSIENT)),
            most_factor: real(MOST_FACTOR),
            smoothing: real(1.0 - libm::exp(-period / (SETTLING * reaction))),
            inverse_step: real(1.0 / (LARGE_STEP * limit)),
        },
        rest: RestTable {
            hunting: real(HUNTING / pole),
            first_deadband: real(DEADBAND[0]),
            largest_deadband: real(DEADBAND[1]),
            deadband_left: real(libm::exp(-period / DEADBAND_KEPT)),
        },
        load: LoadModelTable {
            variances: [real(load_growth), real(friction_growth), T::ONE],
            // Steady gain for a random walk that grows slowly against the measurement noise.
            gain: real(libm::sqrt(load_growth)),
            rate_gain: real(1.0 / LOAD_RATE),
            rate_left: real(libm::exp(-period / LOAD_RATE_KEPT)),
            fastest: real(limit / LOAD_RATE),
            friction_slope: real(1.0 / FRICTION_SPEED),
            planned_friction_slope: real(1.0 / PLANNED_FRICTION_SPEED),
            frictions: [body.gear * settings.motor_friction, settings.load_friction].map(real),
        },
        watch: MonitorTable {
            smoothing: real(-libm::expm1(-period * SLOW_LOAD)),
            least_demand: real(PLANNED * limit),
            leaks: HUNTING_LEAK.map(real),
            most: real(HUNTING_CHANGES),
            calm_per_half: real(HUNTING_CALM),
            memory: real(-libm::expm1(-period / HUNTING_ERROR_TIME)),
            error_per_half: real(HUNTING_ERROR),
            error_per_demand: real(HUNTING_ERROR_BY_DEMAND / (3.0 * inertia * pole * pole)),
            first_away: real(AWAY[0]),
            longest_away: real(AWAY[1]),
            longer: real(AWAY_GROWTH),
        },
    })
}

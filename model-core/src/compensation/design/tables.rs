//! Tables of the compensation: from joint, bandwidth and limits to gains, times and thresholds.
//!
//! Gains follow from inertias and bandwidth, times from the motor's torque, the loop's delays and the force that a
//! landing may cause. What is left are shares, each a constant here with its reason.

use core::f64::consts::TAU;

use super::body::Body;
use super::damping::{of_both, on_motor_alone, reaction};
use super::settings::{CompensationSettings, check};
use super::stability;
use crate::compensation::crossing::Crossing;
use crate::compensation::tables::{
    BodyTable, ClockTable, CompensationTables, CrossingTable, GearTable, LandingTable, LawTable, LimitTable, LoadTable,
    RestTable, SwitchingTable, WatchTable,
};
use crate::gears::design::{DesignError, validate};
use crate::gears::gear_losses;
use crate::numbers::Real;
use parameters::JointParameters;

/// Planets struck on the way through the gap may be struck with this share of the rated force: struck again as they fly
/// to and fro they take up to one and a half times what the first blow is estimated at, which leaves three fifths.
const STRIKE: f64 = 0.4;

/// The same over the peak torque, however hard the flank will be needed: a planet caught between sun and flank is struck
/// harder each time.
const HARDEST_STRIKE: f64 = 0.56;

/// Share of the peak torque that the law may ask the teeth to pass on: torque constant, efficiency and what a swing does
/// in the loop's delays each take a few hundredths.
const MOST_PASSED: f64 = 0.88;

/// Part of the torque at hand that braking is planned with: torque constant, inertia and the crossing to the flank that
/// brakes take a few hundredths each.
const BRAKING: f64 = 0.9;

/// What is left to that, over itself, as far as a swing is divided by it: less than what the torques are known to.
const LEAST_ROOM: f64 = 0.1;

/// Peak torque over the rated torque if neither settings nor motor say less: what catalogues of gears allow at least.
const PEAK: f64 = 2.0;

/// A compliance that comes out so many times smaller or larger than the joint file's is not believed.
const COMPLIANCE: f64 = 4.0;

/// Share of the largest torque that a crossing may take; the rest is for the feedback along it.
const CROSSING_TORQUE: f64 = 0.8;

/// Share of that damper in impedance mode: what a commanded damper loses by the loop's delays.
const IMPEDANCE_DAMPING: f64 = 0.1;

/// A crossing shorter than so many reaction times would be over before feedback has had a say.
const REACTIONS_IN_A_CROSSING: f64 = 8.0;

/// A gap that turns out wider than guessed may be crossed in so many times the guess's time.
const LONGEST: f64 = 3.0;

/// Share of what is left of a crossing that has to do before its path is laid anew: demand that grows a little does not
/// matter.
const SHORTEN: f64 = 0.8;

/// Landing at the end of a path may cause this share of the rated torque.
const LANDING: f64 = 0.03;

/// The same over the torque that the flank will carry, where that allows for more.
const LANDING_UNDER_LOAD: f64 = 0.4;

/// Reaction times in which the law's torque rises after a landing; how far it rises is the limit's to say.
const RISE: f64 = 1.0;

/// Reaction times over which measured torque is smoothed before it decides: the observer's torques are wrong for a few
/// milliseconds after every impact.
const SETTLING: f64 = 15.0;

/// Share of the half-gap that opens before the loss of a flank is believed: several times the observer's error.
const OPENING: f64 = 0.3;

/// Share of the half-gap within which a flank is as good as touched: what the observer's errors leave.
const LANDED: f64 = 0.03;

/// Planned torque over the largest, beyond which its change of sign counts.
const PLANNED: f64 = 0.005;

/// Measured torque over the largest, as uncertain as it is after an impact.
const MEASURED: f64 = 0.02;

/// Share of that which is left when no flank has changed for long.
const LEAST_MEASURED: f64 = 0.3;

/// Largest hysteresis after several changes, over the first.
const MOST_FACTOR: f64 = 6.0;

/// The most that the hysteresis grows by, over what half the lost motion asks for as an error: a flank that is waited for any
/// longer costs more than one changed in vain.
const MOST_GROWTH: f64 = 0.3;

/// Time in which a transient of the loop is over, times the bandwidth. Grown hysteresis is lost again over it, for by then an
/// error that a crossing too early has left was put right by the flank that it led to; and so long a push is remembered for
/// which the teeth are not spared.
const TRANSIENT: f64 = 6.0;

/// Changes of the wanted flank within this time, times the bandwidth, are hunting.
const HUNTING: f64 = 15.0;

/// Change of a torque over the largest that is taken up faster.
const LARGE_STEP: f64 = 0.05;

/// Error let be at rest without a load, while nothing hunts and at most, over half the lost motion: with the most, the joint
/// rests within half of its lost motion.
const DEADBAND: [f64; 2] = [0.05, 0.5];

/// Time in which a grown deadband is lost again [s]: long against the hunt that it ends.
const DEADBAND_KEPT: f64 = 30.0;

/// Speed at which dry friction has its full size [rad/s], for want of a better number: what encoders resolve.
const FRICTION_SPEED: f64 = 0.01;

/// The same for a planned speed [rad/s]: what a motion passes in a few control periods.
const PLANNED_FRICTION_SPEED: f64 = 1e-3;

/// Square of the time in which the load is followed [s^2]: a few milliseconds.
const LOAD_FOLLOWED: f64 = 1e-5;

/// Time in which the load's rate is learnt [s]: a weight swings in a second.
const LOAD_RATE: f64 = 0.03;

/// Time in which a rate that is not seen again is forgotten [s].
const LOAD_RATE_KEPT: f64 = 0.1;

/// The same as for the load for its dry friction [s^2]: known within a few reversals, then kept for seconds.
const FRICTION_FOLLOWED: f64 = 1e-2;

/// Time in which a missed impulse is made good, over a crossing's time.
const REPAYMENT: f64 = 1.15;

/// Impedance set-points come 200 times a second at least, or are at rest [s].
const LONGEST_HOLD: f64 = 5e-3;

/// Time in which control is blended from plain to compensated, times the bandwidth; the other way it goes in one
/// period.
const TRUST: f64 = 1.2;

/// Corner of the slow load that explains a flank [rad/s]: below the modes of flexible payloads from 8 Hz on, above loads that people
/// and steps put on a link.
const SLOW_LOAD: f64 = 25.0;

/// Unexplained flank changes that are forgotten in a second, and while the error is small [1/s]: a link without friction drifts from flank to
/// flank fifteen times a second, at a tenth of the error that plain control leaves.
const HUNTING_LEAK: [f64; 2] = [1.0, 20.0];

/// Unexplained flank changes beyond which the loop hunts [-]. Tuned on `hil/never-worse.toml`: a joint that follows a load to and fro leaves a
/// flank as often as some that hunt.
const HUNTING_CHANGES: f64 = 4.0;

/// Root of the mean squared error that is small, over half the lost motion [-]: a third of what control without compensation leaves.
const HUNTING_CALM: f64 = 0.35;

/// Time over which the squared error is averaged [s]; the root of that mean over half the lost motion beyond which the loop hunts [-]:
/// control that ignores the gap leaves the link on either flank, at half the lost motion.
const HUNTING_ERROR_TIME: f64 = 0.15;
const HUNTING_ERROR: f64 = 1.5;

/// Error that is granted on top, over what the demand would move the loop's spring by [-]: inertia and load that are 30 % off.
const HUNTING_ERROR_BY_DEMAND: f64 = 0.3;

/// Times for which a loop that hunts is controlled without compensation: at first, and at most [s]; growth with each trip [-].
const AWAY: [f64; 2] = [10.0, 120.0];
const AWAY_GROWTH: f64 = 4.0;

/// Half the lost motion is never taken for more than so many times the guess.
const WIDEST: f64 = 5.0;

/// Tables of the compensation.
pub fn design_compensation<T: Real>(
    joint: &JointParameters,
    settings: &CompensationSettings,
) -> Result<CompensationTables<T>, DesignError> {
    validate(joint)?;
    check(settings)?;
    let real = T::from_f64;
    let period = 1.0 / f64::from(settings.control_rate);
    let pole = settings.bandwidth;
    let body = Body::new(joint);
    stability::check(&body, settings)?;
    let inertia = body.motor + body.load;
    // Growth of a variance in one period over that of a reading.
    let [load_growth, friction_growth] = [LOAD_FOLLOWED, FRICTION_FOLLOWED].map(|square| period * period / square);
    let limit = body.gear * settings.torque_limit;
    let half = body.half_backlash / body.lever;
    let reaction = reaction(settings, period);
    let damping = of_both(&body, pole);

    // A ramp without a jump in its acceleration has one and a half times its mean.
    let ramp_per_speed = 1.5 * body.motor / (CROSSING_TORQUE * limit);
    let shortest_ramp = 0.5 * REACTIONS_IN_A_CROSSING * reaction;
    let rated = joint.rated_output_torque;
    let peak = settings.peak_torque.unwrap_or(limit.min(PEAK * rated));
    let hardest_strike = HARDEST_STRIKE * peak;
    let strike_torque = hardest_strike.min(STRIKE * rated);
    let most_passed = MOST_PASSED * peak;
    let crossing =
        Crossing::at(strike_torque / body.strike_impedance, 2.0 * half, ramp_per_speed, shortest_ramp).duration;
    let motor_damping = on_motor_alone(&body, damping, reaction);
    // The motor's mass against the joint's spring: torque of a blow for each rad/s.
    let blow = libm::sqrt(body.stiffness * body.motor);
    let landing_speed = LANDING * rated / blow;
    Ok(CompensationTables {
        clock: ClockTable { rate: real(f64::from(settings.control_rate)), period: real(period) },
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
            // Both poles of the motor alone in one place.
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
        load: LoadTable {
            variances: [real(load_growth), real(friction_growth), T::ONE],
            // Of a random walk in noise, as far as it grows much more slowly than it is read.
            gain: real(libm::sqrt(load_growth)),
            rate_gain: real(1.0 / LOAD_RATE),
            rate_left: real(libm::exp(-period / LOAD_RATE_KEPT)),
            fastest: real(limit / LOAD_RATE),
            friction_slope: real(1.0 / FRICTION_SPEED),
            planned_friction_slope: real(1.0 / PLANNED_FRICTION_SPEED),
            frictions: [body.gear * settings.motor_friction, settings.load_friction].map(real),
        },
        watch: WatchTable {
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

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

/// Quantities from which the tables follow, referred to the link.
struct Design<'given> {
    joint: &'given JointParameters,
    settings: &'given CompensationSettings,
    body: JointBody,
    /// Control period T [s].
    period: f64,
    /// Bandwidth w [rad/s].
    pole: f64,
    /// Inertia of motor and link, J [kg m^2].
    inertia: f64,
    /// Largest torque of the motor, M_max [N m].
    limit: f64,
    /// Half of the lost motion, h [rad].
    half: f64,
    /// Reaction time, T_r [s].
    reaction: f64,
    /// Damper of the loop and its part on the motor, D and D_m [N m s/rad].
    damping: f64,
    motor_damping: f64,
    /// Peak torque of the output [N m].
    peak: f64,
    /// Torque through the teeth that the law may ask for, P [N m].
    most_passed: f64,
    /// Torque of a blow on planets in the gap: at small demand, at most [N m].
    strike_torque: f64,
    hardest_strike: f64,
    /// Ramp of a path: duration per speed [s^2/rad], shortest duration [s].
    ramp_per_speed: f64,
    shortest_ramp: f64,
    /// Duration of a crossing of the guessed gap at small demand [s].
    crossing: f64,
    /// Impedance of a blow: motor inertia against the stiffness of the joint [N m s/rad].
    blow: f64,
    /// Smallest landing speed [rad/s].
    landing_speed: f64,
}

/// Computes the tables of the compensation from joint and settings.
pub fn design_compensation<T: Real>(
    joint: &JointParameters,
    settings: &CompensationSettings,
) -> Result<CompensationTables<T>, DesignError> {
    validate(joint)?;
    check(settings)?;
    let body = JointBody::new(joint);
    stability::check(&body, settings)?;
    let design = Design::new(joint, settings, body);
    Ok(CompensationTables {
        clock: design.clock(),
        gear: design.gear(),
        body: design.body_table(),
        limits: design.limits(),
        law: design.law(),
        crossing: design.crossing_table(),
        landing: design.landing(),
        switching: design.switching(),
        rest: design.rest(),
        load: design.load(),
        watch: design.monitor(),
    })
}

impl<'given> Design<'given> {
    fn new(joint: &'given JointParameters, settings: &'given CompensationSettings, body: JointBody) -> Self {
        let period = 1.0 / f64::from(settings.control_rate);
        let pole = settings.bandwidth;
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
        let strike_speed = strike_torque / body.strike_impedance;
        let blow = libm::sqrt(body.stiffness * body.motor);
        Self {
            joint,
            settings,
            period,
            pole,
            inertia: body.motor + body.load,
            limit,
            half,
            reaction,
            damping,
            motor_damping: motor_damping_bound(&body, damping, reaction),
            peak,
            most_passed: LIMITS.teeth_per_peak * peak,
            strike_torque,
            hardest_strike,
            ramp_per_speed,
            shortest_ramp,
            crossing: CrossingTiming::at(strike_speed, 2.0 * half, ramp_per_speed, shortest_ramp).duration,
            blow,
            landing_speed: LANDING.force_per_rated * rated / blow,
            body,
        }
    }

    /// Control clock.
    fn clock<T: Real>(&self) -> ControlClockTable<T> {
        let real = T::from_f64;
        ControlClockTable { rate: real(f64::from(self.settings.control_rate)), period: real(self.period) }
    }

    /// Conversions from motor to link, and from lengths along the line of action to angles.
    fn gear<T: Real>(&self) -> GearTable<T> {
        let real = T::from_f64;
        GearTable {
            motor_per_link: real(self.body.gear),
            link_per_motor: real(1.0 / self.body.gear),
            turn: real(TAU),
            inverse_lever: real(1.0 / self.body.lever),
            mesh_phase_per_radian: real(f64::from(self.joint.geometry.ring_teeth) / TAU * f64::powi(2.0, 32)),
            radians_per_mesh: real(1.0 / f64::from(self.joint.geometry.ring_teeth)),
            cogging_periods: self.settings.cogging_periods,
            cogging_phase_per_radian: real(
                f64::from(self.settings.cogging_periods) * self.body.gear / TAU * f64::powi(2.0, 32),
            ),
            losses: gear_losses(self.settings.efficiency).map(real),
        }
    }

    /// Inertias and compliance.
    fn body_table<T: Real>(&self) -> BodyTable<T> {
        let real = T::from_f64;
        BodyTable {
            motor_inertia: real(self.body.motor),
            load_inertia: real(self.body.load),
            inverse_load_inertia: real(1.0 / self.body.load),
            load_share: real(self.body.load / self.inertia),
            inverse_load_share: real(self.inertia / self.body.load),
            reduced_inertia: real(self.body.motor * self.body.load / self.inertia),
            compliances: [
                real(LIMITS.compliance_ratio / self.body.stiffness),
                real(1.0 / (LIMITS.compliance_ratio * self.body.stiffness)),
            ],
            widest_half: real(LIMITS.widest_gap_ratio * self.half),
        }
    }

    /// Limits of motor and teeth (K11), (K12).
    fn limits<T: Real>(&self) -> LimitTable<T> {
        let real = T::from_f64;
        LimitTable {
            motor: real(self.limit),
            teeth: real(self.most_passed),
            least_room: real(LIMITS.least_room * self.most_passed),
            teeth_at_most: real(if self.peak < self.limit { self.most_passed } else { self.limit }),
            braking: real(LIMITS.braking),
        }
    }

    /// Gains of the control laws (K1) to (K3), (K17), (K18).
    fn law<T: Real>(&self) -> LawTable<T> {
        let real = T::from_f64;
        LawTable {
            position: real(3.0 * self.inertia * self.pole * self.pole),
            damping: real(self.damping),
            rate: real(self.pole),
            motor_damping: real(self.motor_damping),
            impedance_damping: real(LAW.impedance_damping),
            integral: real(self.inertia * self.pole * self.pole * self.pole * self.period),
            back_calculation: real(self.pole * self.period),
            trust_step: real(self.period * self.pole / LAW.trust_time),
            longest_hold: real(LAW.longest_hold),
        }
    }

    /// Path through the gap (K8), (K9).
    fn crossing_table<T: Real>(&self) -> CrossingTable<T> {
        let real = T::from_f64;
        CrossingTable {
            lead: real(self.crossing + self.reaction),
            reaction: real(self.reaction),
            // Double pole of the motor alone.
            stiffness: real(self.motor_damping * self.motor_damping / (4.0 * self.body.motor)),
            strike_speed_per_torque: real(1.0 / self.body.strike_impedance),
            strike_torque: real(self.strike_torque),
            hardest_strike: real(self.hardest_strike),
            shortest_ramp: real(self.shortest_ramp),
            ramp_per_speed: real(self.ramp_per_speed),
            longest: real(CROSSING.longest * self.crossing),
            shorten: real(CROSSING.shorten),
        }
    }

    /// Landing on a flank (K10), (K16).
    fn landing<T: Real>(&self) -> LandingTable<T> {
        let real = T::from_f64;
        LandingTable {
            speed: real(self.landing_speed),
            speed_per_torque: real(LANDING.force_per_demand / self.blow),
            acceleration: real(self.landing_speed / self.crossing),
            fastest: real((LANDING.force_per_demand * self.limit / self.blow).max(self.landing_speed)),
            rise: real(self.period / (LANDING.rise_time * self.reaction)),
            repayment: real(1.0 / (LANDING.recovery_time * self.crossing)),
            opening: real(LANDING.opening),
            landed: real(LANDING.landed),
        }
    }

    /// Conditions of a flank change (K13).
    fn switching<T: Real>(&self) -> SwitchingTable<T> {
        let real = T::from_f64;
        SwitchingTable {
            planned: real(SWITCHING.planned * self.limit),
            measured: real(SWITCHING.measured * self.limit),
            least: real(SWITCHING.least),
            most_growth: real(SWITCHING.most_growth * 3.0 * self.inertia * self.pole * self.pole),
            transient_left: real(libm::exp(-self.period * self.pole / SWITCHING.transient)),
            most_factor: real(SWITCHING.most_factor),
            smoothing: real(1.0 - libm::exp(-self.period / (SWITCHING.smoothing_time * self.reaction))),
            inverse_step: real(1.0 / (SWITCHING.large_step * self.limit)),
        }
    }

    /// Hunting and dead band at rest (K15).
    fn rest<T: Real>(&self) -> RestTable<T> {
        let real = T::from_f64;
        RestTable {
            hunting: real(REST.hunting / self.pole),
            first_deadband: real(REST.first_deadband),
            largest_deadband: real(REST.largest_deadband),
            deadband_left: real(libm::exp(-self.period / REST.deadband_memory)),
        }
    }

    /// Load model (K6).
    fn load<T: Real>(&self) -> LoadModelTable<T> {
        let real = T::from_f64;
        // Growth of a variance per period, over the variance of a measurement.
        let [load_growth, friction_growth] =
            [LOAD.gravity_time_squared, LOAD.friction_time_squared].map(|square| self.period * self.period / square);
        LoadModelTable {
            variances: [real(load_growth), real(friction_growth), T::ONE],
            // Steady gain for a random walk that grows slowly against the measurement noise.
            gain: real(libm::sqrt(load_growth)),
            rate_gain: real(1.0 / LOAD.rate_time),
            rate_left: real(libm::exp(-self.period / LOAD.rate_memory)),
            fastest: real(self.limit / LOAD.rate_time),
            friction_slope: real(1.0 / LOAD.friction_speed),
            planned_friction_slope: real(1.0 / LOAD.planned_friction_speed),
            frictions: [self.body.gear * self.settings.motor_friction, self.settings.load_friction].map(real),
        }
    }

    /// Monitor of the loop (K22) to (K24).
    fn monitor<T: Real>(&self) -> MonitorTable<T> {
        let real = T::from_f64;
        MonitorTable {
            smoothing: real(-libm::expm1(-self.period * MONITOR.slow_load_corner)),
            least_demand: real(SWITCHING.planned * self.limit),
            leaks: [MONITOR.leak, MONITOR.calm_leak].map(real),
            most: real(MONITOR.changes),
            calm_per_half: real(MONITOR.calm_error),
            memory: real(-libm::expm1(-self.period / MONITOR.averaging_time)),
            error_per_half: real(MONITOR.hunting_error),
            error_per_demand: real(MONITOR.error_per_deflection / (3.0 * self.inertia * self.pole * self.pole)),
            first_away: real(MONITOR.first_retry),
            longest_away: real(MONITOR.longest_retry),
            longer: real(MONITOR.retry_growth),
        }
    }
}

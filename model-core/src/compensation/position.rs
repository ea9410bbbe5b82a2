//! Control law of position mode: spring and damper on the link, damper on the motor, feed-forward of acceleration and load. The load
//! estimate replaces an integral.
//!
//! ```text
//! (K1)  torque = J a + L + f dir + losses + K e + D (v - w_l) + D_m (w_l + v_e - w_m)
//! (K4)  demand(time) = J_l a + L + f dir + K e + D (v - w_l), extrapolated by time
//! ```
//!
//! Symbols: v, a = `now.speed`, `now.acceleration`; L = `load.gravity_torque()`; f dir = `load.planned_friction()`; losses = `state.loss_torque()`;
//! K e = `spring`; D = `law.damping`; v - w_l = `state.error_rate`; D_m term = `state.damping_torque()`; measured part of the
//! demand = `measured_demand`. (K15) is `update_deadband`.

use super::braking::{BrakingLimit, SetPointMotion, TrackingError};
use super::control_demand::ControlDemand;
use super::easing::Easing;
use super::limit::{limit_mesh_torque, mesh_torque, mesh_torque_limit};
use super::load::LoadModel;
use super::loop_state::LoopState;
use super::set_point::Motion;
use super::start_prediction::StartPrediction;
use crate::compensation::tables::CompensationTables;
use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::numbers::arithmetic::{beyond, clamp};

/// Smoothing rate of the set-point's jerk over the smoothing rate of measured torque: planners send coarse steps, but
/// no noise.
const JERK_SMOOTHING_RATIO: i32 = 8;

/// State of position mode.
#[derive(Debug, Clone)]
pub(super) struct PositionLaw<T: Real> {
    /// Acceleration of the set-point in the previous period [rad/s^2].
    last_acceleration: Option<T>,
    /// Dead band of the error while the joint rests without a load; grows with flank changes that feedback alone has
    /// caused [rad].
    deadband: T,
    /// Flank that the demand asked for last during this rest.
    requested_flank: Option<Flank>,
    /// Time since `requested_flank` last changed, saturating [s].
    time_since_request: T,
    /// Smoothed measured part of the demand [N m].
    measured_demand: T,
    /// Prediction of the next start.
    start: StartPrediction<T>,
    /// Transfer of a load at rest to friction.
    easing: Easing<T>,
    /// Growth of the set-point's acceleration per period, smoothed because planners send coarse steps [rad/s^2].
    acceleration_step: T,
    /// Largest acceleration of the set-point since the last rest: few planners brake harder than they accelerate
    /// [rad/s^2].
    peak_acceleration: T,
}

impl<T: Real> PositionLaw<T> {
    /// Rate at which the first dead band opens, over its size [1/s]: slow against a load that passes through zero, fast
    /// against an integral that winds up until the motor breaks loose from its friction.
    const DEADBAND_OPENING_RATE: T = T::ONE;

    /// Torque of the law beyond the motor's limit while the link is pushed hard, over that limit [-]: the excess
    /// outweighs part of the damper between motor and link, so that the link is pushed back sooner at the cost of the
    /// teeth.
    const IMPACT_EXTRA_TORQUE: T = T::QUARTER;

    pub fn new() -> Self {
        Self {
            last_acceleration: None,
            deadband: T::ZERO,
            requested_flank: None,
            time_since_request: T::ZERO,
            measured_demand: T::ZERO,
            start: StartPrediction::new(),
            easing: Easing::new(),
            acceleration_step: T::ZERO,
            peak_acceleration: T::ZERO,
        }
    }

    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// Error beyond the dead band [rad].
    pub fn error_beyond_deadband(&self, state: &LoopState<T>) -> T {
        beyond(state.error, self.deadband)
    }

    pub fn demand(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        state: &LoopState<T>,
        now: &Motion<T>,
        ahead: Option<&Motion<T>>,
    ) -> ControlDemand<T> {
        let (asked, known) = self.trajectory(tables, now, ahead);
        let rests = now.speed == T::ZERO && now.acceleration == T::ZERO && (ahead.is_none() || asked == [T::ZERO; 2]);
        let let_be = if rests { self.deadband } else { T::ZERO };
        let hardest = if rests { T::ZERO } else { self.peak_acceleration };
        let asks = now.acceleration.abs();
        self.peak_acceleration = if asks > hardest { asks } else { hardest };

        let error = beyond(state.error, let_be);
        let soon = now.acceleration + tables.crossing.lead.over(known) * asked[1];
        let soon = if ahead.is_some() { soon } else { clamp(soon, -self.peak_acceleration, self.peak_acceleration) };
        let set_point = SetPointMotion { speed: now.speed, acceleration: now.acceleration, ahead: soon };
        let braking = BrakingLimit::new(tables, load, state);
        let approach = braking.approach(error, &set_point);
        let spring = approach.map_or(tables.law.position * error, |approach| tables.law.damping * approach.closing);
        let acceleration = approach.map_or(now.acceleration, |approach| approach.acceleration);
        let stands = self.start.friction_holds(tables);
        let useful = (tables.body.load_inertia + tables.body.motor_inertia) * acceleration
            + self.easing.step(tables, load, state, rests, stands) * load.gravity_torque()
            + load.planned_friction(tables, now.speed)
            + spring
            + tables.law.damping * state.error_rate;
        // Torque beyond the limits must not outweigh the damper.
        let all = mesh_torque(tables, load.free_load_torque(), useful);
        let allowed = mesh_torque_limit(tables, useful);
        let external_impact = load.external_impact(tables);
        let most = if external_impact { all.abs() } else { allowed };
        let passed = clamp(all, -most, most);
        let useful = useful - tables.body.inverse_load_share * (all - passed);
        let asked_for = useful + state.loss_torque(tables, now.speed, passed);
        let most = if external_impact {
            (T::ONE + Self::IMPACT_EXTRA_TORQUE) * tables.limits.motor
        } else {
            tables.limits.motor
        };
        let law = clamp(asked_for, -most, most) + state.damping_torque(tables);
        let lost = state.loss_torque(tables, state.link_speed, passed);
        let law = limit_mesh_torque(tables, load, state, law - lost, allowed) + lost;
        let level = load.gravity_torque()
            + (load.friction_torque() - load.planned_friction(tables, now.speed))
            + spring
            + tables.law.damping * state.error_rate;
        // Changes that are large against the noise are followed faster.
        self.measured_demand += tables.clock.period * load.gravity_rate();
        let change = level - self.measured_demand;
        let weight = tables.switching.inverse_step * change;
        // With a preview the planned demand is known early, so the measured demand is smoothed longer: teeth that
        // oscillate about a small torque at the mesh frequency must not make the motor leave at a peak and return at
        // once.
        let smoothing =
            if ahead.is_some() { (T::ONE - T::THIRD) * tables.switching.smoothing } else { tables.switching.smoothing };
        self.measured_demand +=
            clamp(smoothing * clamp(weight * weight, T::ONE, tables.clock.rate), T::ZERO, T::HALF) * change;
        let planned = |time: T| {
            let part = time.over(known);
            let speed = now.speed + time * (now.acceleration + T::HALF * part * asked[1]);
            let speed = if ahead.is_some() { now.speed + part * asked[0] } else { speed };
            tables.body.load_inertia * (now.acceleration + part * asked[1]) + load.planned_friction(tables, speed)
        };
        let level = self.measured_demand;
        let rate = load.gravity_rate();
        let tracking = approach.map(|_| {
            let torque = clamp(law - lost, -tables.limits.motor, tables.limits.motor);
            let acceleration = now.acceleration - braking.acceleration(tables, load, state, torque);
            TrackingError { error, rate: state.error_rate, acceleration }
        });
        let demand = |time: T| match &tracking {
            None => planned(time) + level + time * rate,
            Some(tracking) => braking.demand(tables, load, tracking, &set_point, time),
        };
        // A joint that carries a load is not idle: the loaded flank is kept.
        let idles = rests && beyond(load.gravity_torque(), tables.switching.measured) == T::ZERO;
        let direction = if now.speed == T::ZERO { now.acceleration } else { now.speed };
        let likely = self.start.step(tables, state, direction, rests);
        let expects = if ahead.is_none() { sign::<T>(likely) * load.start_torque(tables) } else { T::ZERO };
        let brakes_early = approach.is_some();
        let needs_no_flank = idles && self.start.friction_holds(tables) && expects == T::ZERO && error == T::ZERO;
        let intent = ControlDemand {
            rests_unloaded: idles,
            rests,
            needs_no_flank,
            external_impact,
            brakes_early,
            expected_start_torque: expects,
            ..ControlDemand::new(tables, load, state, law, demand, false)
        };
        let surely = beyond(intent.after_crossing, tables.switching.measured * tables.switching.least);
        self.update_deadband(tables, rests, idles, surely, state.half_gap);
        intent
    }

    /// Changes of the set-point's speed and acceleration within a time, and that time, which is never zero. The preview
    /// gives the changes; without a preview, the jerk.
    fn trajectory(
        &mut self,
        tables: &CompensationTables<T>,
        now: &Motion<T>,
        ahead: Option<&Motion<T>>,
    ) -> ([T; 2], T) {
        let before = self.last_acceleration.replace(now.acceleration);
        match ahead {
            Some(ahead) => ([ahead.speed - now.speed, ahead.acceleration - now.acceleration], tables.crossing.lead),
            None => {
                let by = before.map_or(T::ZERO, |before| now.acceleration - before);
                self.acceleration_step +=
                    T::from_i32(JERK_SMOOTHING_RATIO) * tables.switching.smoothing * (by - self.acceleration_step);
                ([T::ZERO, self.acceleration_step], tables.clock.period)
            }
        }
    }

    /// Opens the first dead band while a joint rests without a load (K15): an error treated as friction lasts for
    /// seconds, and correcting it later costs a crossing. A request for the opposite flank soon after the last request
    /// widens the dead band, because only a hunting loop causes such requests, no load. The dead band decays slowly,
    /// and closes at once when the joint is to move.
    fn update_deadband(&mut self, tables: &CompensationTables<T>, rests: bool, idles: bool, demand: T, half: T) {
        self.time_since_request = clamp(self.time_since_request + tables.clock.period, T::ZERO, tables.rest.hunting);
        if !rests {
            self.deadband = T::ZERO;
            self.requested_flank = None;
            return;
        }
        let first = tables.rest.first_deadband * half;
        let opened = self.deadband + Self::DEADBAND_OPENING_RATE * tables.clock.period * first;
        let forgiven = tables.rest.deadband_left * self.deadband;
        self.deadband = if idles { clamp(first, forgiven, opened) } else { T::ZERO };
        let asks = Flank::towards(demand);
        if asks.is_some_and(|flank| self.requested_flank == Some(flank.opposite())) {
            if self.time_since_request < tables.rest.hunting {
                let grown = self.deadband + self.deadband + first;
                self.deadband = clamp(grown, T::ZERO, tables.rest.largest_deadband * half);
            }
            self.time_since_request = T::ZERO;
        }
        self.requested_flank = asks.or(self.requested_flank);
    }
}

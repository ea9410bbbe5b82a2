//! Control law of position mode: spring and damper on the link, damper on the motor, feed-forward of acceleration and load. The load
//! estimate replaces an integral.
//!
//! ```text
//! (K1)  torque = J a + L + f dir + losses + K e + D (v - w_l) + D_m (w_l + v_e - w_m)
//! (K4)  demand(time) = J_l a + L + f dir + K e + D (v - w_l), extrapolated by time
//! ```
//!
//! Symbols: v, a = `now.speed`, `now.acceleration`; L = `load.even()`; f dir = `load.planned_drag()`; losses = `situation.lost()`;
//! K e = `spring`; D = `law.damping`; v - w_l = `situation.error_rate`; D_m term = `situation.damping_torque()`; measured part of the
//! demand = `level`. (K15) is `find_deadband`.

use super::braking::{Braking, Course, Lag};
use super::easing::Easing;
use super::intent::Intent;
use super::limit::{limited, passed, spared};
use super::load::LoadModel;
use super::set_point::Motion;
use super::situation::Situation;
use super::start_prediction::StartPrediction;
use crate::compensation::tables::CompensationTables;
use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::numbers::arithmetic::{clamp, deadband};

/// Smoothing rate of the set-point's jerk over the smoothing rate of measured torque: planners send coarse steps, but
/// no noise.
const SOONER: i32 = 8;

/// State of position mode.
#[derive(Debug, Clone)]
pub(super) struct PositionLaw<T: Real> {
    /// Acceleration of the set-point in the previous period [rad/s^2].
    before: Option<T>,
    /// Dead band of the error while the joint rests without a load; grows with flank changes that feedback alone has
    /// caused [rad].
    deadband: T,
    /// Flank that the demand asked for last during this rest.
    asked: Option<Flank>,
    /// Time since `asked` last changed, saturating [s].
    since: T,
    /// Smoothed measured part of the demand [N m].
    level: T,
    /// Prediction of the next start.
    start: StartPrediction<T>,
    /// Transfer of a load at rest to friction.
    easing: Easing<T>,
    /// Growth of the set-point's acceleration per period, smoothed because planners send coarse steps [rad/s^2].
    growth: T,
    /// Largest acceleration of the set-point since the last rest: few planners brake harder than they accelerate
    /// [rad/s^2].
    hardest: T,
}

impl<T: Real> PositionLaw<T> {
    /// Rate at which the first dead band opens, over its size [1/s]: slow against a load that passes through zero, fast
    /// against an integral that winds up until the motor breaks loose from its friction.
    const OPENS: T = T::ONE;

    /// Torque of the law beyond the motor's limit while the link is pushed hard, over that limit [-]: the excess
    /// outweighs part of the damper between motor and link, so that the link is pushed back sooner at the cost of the
    /// teeth.
    const HURRIES: T = T::QUARTER;

    pub fn new() -> Self {
        Self {
            before: None,
            deadband: T::ZERO,
            asked: None,
            since: T::ZERO,
            level: T::ZERO,
            start: StartPrediction::new(),
            easing: Easing::new(),
            growth: T::ZERO,
            hardest: T::ZERO,
        }
    }

    pub fn forget(&mut self) {
        *self = Self::new();
    }

    /// Error beyond the dead band [rad].
    pub fn heeded(&self, situation: &Situation<T>) -> T {
        deadband(situation.error, self.deadband)
    }

    pub fn intend(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        now: &Motion<T>,
        ahead: Option<&Motion<T>>,
    ) -> Intent<T> {
        let (asked, known) = self.trajectory(tables, now, ahead);
        let rests = now.speed == T::ZERO && now.acceleration == T::ZERO && (ahead.is_none() || asked == [T::ZERO; 2]);
        let let_be = if rests { self.deadband } else { T::ZERO };
        let hardest = if rests { T::ZERO } else { self.hardest };
        let asks = now.acceleration.abs();
        self.hardest = if asks > hardest { asks } else { hardest };

        let error = deadband(situation.error, let_be);
        let soon = now.acceleration + (tables.crossing.lead / known) * asked[1];
        let soon = if ahead.is_some() { soon } else { clamp(soon, -self.hardest, self.hardest) };
        let course = Course { speed: now.speed, acceleration: now.acceleration, ahead: soon };
        let braking = Braking::new(tables, load, situation);
        let approach = braking.approach(error, &course);
        let spring = approach.map_or(tables.law.position * error, |approach| tables.law.damping * approach.closing);
        let acceleration = approach.map_or(now.acceleration, |approach| approach.acceleration);
        let stands = self.start.stands(tables);
        let useful = (tables.body.load_inertia + tables.body.motor_inertia) * acceleration
            + self.easing.step(tables, load, situation, rests, stands) * load.even()
            + load.planned_drag(tables, now.speed)
            + spring
            + tables.law.damping * situation.error_rate;
        // Torque beyond the limits must not outweigh the damper.
        let all = passed(tables, load.free(), useful);
        let allowed = spared(tables, useful);
        let thrown = load.throws(tables);
        let most = if thrown { all.abs() } else { allowed };
        let passed = clamp(all, -most, most);
        let useful = useful - tables.body.inverse_load_share * (all - passed);
        let asked_for = useful + situation.lost(tables, now.speed, passed);
        let most = if thrown { (T::ONE + Self::HURRIES) * tables.limits.motor } else { tables.limits.motor };
        let law = clamp(asked_for, -most, most) + situation.damping_torque(tables);
        let lost = situation.lost(tables, situation.link_speed, passed);
        let law = limited(tables, load, situation, law - lost, allowed) + lost;
        let level = load.even()
            + (load.drag() - load.planned_drag(tables, now.speed))
            + spring
            + tables.law.damping * situation.error_rate;
        // Changes that are large against the noise are followed faster.
        self.level += tables.clock.period * load.rate();
        let change = level - self.level;
        let weight = tables.switching.inverse_step * change;
        // With a preview the planned demand is known early, so the measured demand is smoothed longer: teeth that
        // oscillate about a small torque at the mesh frequency must not make the motor leave at a peak and return at
        // once.
        let smoothing =
            if ahead.is_some() { (T::ONE - T::THIRD) * tables.switching.smoothing } else { tables.switching.smoothing };
        self.level += clamp(smoothing * clamp(weight * weight, T::ONE, tables.clock.rate), T::ZERO, T::HALF) * change;
        let planned = |time: T| {
            let part = time / known;
            let speed = now.speed + time * (now.acceleration + T::HALF * part * asked[1]);
            let speed = if ahead.is_some() { now.speed + part * asked[0] } else { speed };
            tables.body.load_inertia * (now.acceleration + part * asked[1]) + load.planned_drag(tables, speed)
        };
        let level = self.level;
        let rate = load.rate();
        let lag = approach.map(|_| {
            let torque = clamp(law - lost, -tables.limits.motor, tables.limits.motor);
            let acceleration = now.acceleration - braking.acceleration(tables, load, situation, torque);
            Lag { error, rate: situation.error_rate, acceleration }
        });
        let demand = |time: T| match &lag {
            None => planned(time) + level + time * rate,
            Some(lag) => braking.demand(tables, load, lag, &course, time),
        };
        // A joint that carries a load is not idle: the loaded flank is kept.
        let idles = rests && deadband(load.even(), tables.switching.measured) == T::ZERO;
        let direction = if now.speed == T::ZERO { now.acceleration } else { now.speed };
        let likely = self.start.step(tables, situation, direction, rests);
        let expects = if ahead.is_none() { sign::<T>(likely) * load.start(tables) } else { T::ZERO };
        let brakes_early = approach.is_some();
        let needs_no_flank = idles && self.start.stands(tables) && expects == T::ZERO && error == T::ZERO;
        let intent = Intent {
            idles,
            rests,
            needs_no_flank,
            thrown,
            brakes_early,
            expects,
            ..Intent::new(tables, load, situation, law, demand, false)
        };
        let surely = deadband(intent.demand_ahead, tables.switching.measured * tables.switching.least);
        self.find_deadband(tables, rests, idles, surely, situation.half);
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
        let before = self.before.replace(now.acceleration);
        match ahead {
            Some(ahead) => ([ahead.speed - now.speed, ahead.acceleration - now.acceleration], tables.crossing.lead),
            None => {
                let by = before.map_or(T::ZERO, |before| now.acceleration - before);
                self.growth += T::from_i32(SOONER) * tables.switching.smoothing * (by - self.growth);
                ([T::ZERO, self.growth], tables.clock.period)
            }
        }
    }

    /// Opens the first dead band while a joint rests without a load (K15): an error treated as friction lasts for
    /// seconds, and correcting it later costs a crossing. A request for the opposite flank soon after the last request
    /// widens the dead band, because only a hunting loop causes such requests, no load. The dead band decays slowly,
    /// and closes at once when the joint is to move.
    fn find_deadband(&mut self, tables: &CompensationTables<T>, rests: bool, idles: bool, demand: T, half: T) {
        self.since = clamp(self.since + tables.clock.period, T::ZERO, tables.rest.hunting);
        if !rests {
            self.deadband = T::ZERO;
            self.asked = None;
            return;
        }
        let first = tables.rest.first_deadband * half;
        let opened = self.deadband + Self::OPENS * tables.clock.period * first;
        let forgiven = tables.rest.deadband_left * self.deadband;
        self.deadband = if idles { clamp(first, forgiven, opened) } else { T::ZERO };
        let asks = Flank::towards(demand);
        if asks.is_some_and(|flank| self.asked == Some(flank.opposite())) {
            if self.since < tables.rest.hunting {
                let grown = self.deadband + self.deadband + first;
                self.deadband = clamp(grown, T::ZERO, tables.rest.largest_deadband * half);
            }
            self.since = T::ZERO;
        }
        self.asked = asks.or(self.asked);
    }
}

//! The control law of position mode: spring on the link, damper on the motor, acceleration and load fed forward. The
//! load estimate takes the place of an integral.

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
use crate::numbers::arithmetic::{beyond, clamp};

/// How much faster the growth of what is asked for is smoothed than torque that is measured: planners' steps are coarse, but
/// without noise.
const SOONER: i32 = 8;

/// What position mode remembers.
#[derive(Debug, Clone)]
pub(super) struct PositionLaw<T: Real> {
    /// Acceleration asked for one period ago.
    before: Option<T>,
    /// Error that is let be while the joint rests without a load, grown by crossings that feedback alone has caused [rad].
    deadband: T,
    /// The flank that the demand ahead asked for last, at this rest.
    asked: Option<Flank>,
    /// How long ago it last changed, as far as that matters [s].
    since: T,
    /// Demand as far as it is measured and not planned, smoothed [N m].
    level: T,
    /// How the motion usually starts.
    start: StartPrediction<T>,
    /// Whether the load is left to friction.
    easing: Easing<T>,
    /// By how much the acceleration asked for grows in a period, smoothed: planners send it in coarser steps [rad/s^2].
    growth: T,
    /// The hardest acceleration asked for since the motion rested: few planners brake harder than they accelerate [rad/s^2].
    hardest: T,
}

impl<T: Real> PositionLaw<T> {
    /// How fast the first deadband opens, over itself [1/s]: slowly against a load that passes through zero, and fast against
    /// an integral that winds up until the motor breaks loose from its friction.
    const OPENS: T = T::ONE;

    /// By how much what is asked for may be beyond the motor's limit while the link is thrown, over that limit [-]: it drowns
    /// some of the damper between motor and link, so that a thrown link is pushed back sooner and the teeth are not spared.
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

    /// The error, less what is let be.
    pub fn heeded(&self, situation: &Situation<T>) -> T {
        beyond(situation.error, self.deadband)
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

        let error = beyond(situation.error, let_be);
        let soon = now.acceleration + tables.crossing.lead.over(known) * asked[1];
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
        // What is beyond the limits must not drown the damper.
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
        // Changes that are large against the noise are taken up faster.
        self.level += tables.clock.period * load.rate();
        let change = level - self.level;
        let weight = tables.switching.inverse_step * change;
        // What is planned comes ahead with a preview, so that what is measured has time: teeth that swing about little torque
        // at the mesh frequency must not make the motor leave at a crest, for it would be called back.
        let smoothing =
            if ahead.is_some() { (T::ONE - T::THIRD) * tables.switching.smoothing } else { tables.switching.smoothing };
        self.level += clamp(smoothing * clamp(weight * weight, T::ONE, tables.clock.rate), T::ZERO, T::HALF) * change;
        let planned = |time: T| {
            let part = time.over(known);
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
        // A load that is felt has its reasons, and a flank that carries it rests.
        let idles = rests && beyond(load.even(), tables.switching.measured) == T::ZERO;
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
        let surely = beyond(intent.demand_ahead, tables.switching.measured * tables.switching.least);
        self.find_deadband(tables, rests, idles, surely, situation.half);
        intent
    }

    /// By how much speed and acceleration asked for will have changed after a time that is never zero: as the preview
    /// says or, without one, as the jerk does.
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

    /// Opens the first deadband while a joint rests without a load: what it lets be friction holds for seconds, and then it
    /// costs a crossing to put it right. Doubles it whenever such a joint asks for the other flank soon after it asked for this
    /// one, which no load does but a loop that hunts; forgives that slowly, and all at once when the joint is to move.
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

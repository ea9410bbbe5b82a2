//! The control law of position mode: spring on the link, damper on the motor, acceleration and load fed forward. The
//! load estimate takes the place of an integral.

use super::habit::Habit;
use super::intent::Intent;
use super::limit::{limited, passed};
use super::load::LoadModel;
use super::set_point::Motion;
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{beyond, clamp, sign};

/// How much faster the growth of what is asked for is smoothed than torque that is measured.
const SOONER: i32 = 8;

/// What position mode remembers.
#[derive(Debug, Clone)]
pub(super) struct PositionLaw<T: Real> {
    /// Acceleration asked for one period ago.
    before: Option<T>,
    /// Error that is let be while the motion rests, grown by crossings that feedback alone has caused [rad].
    indulgence: T,
    /// Sign of the demand ahead, one period ago.
    asked: T,
    /// How long ago it last changed, as far as that matters [s].
    since: T,
    /// Demand as far as it is measured and not planned, smoothed [N m].
    level: T,
    /// How the motion usually starts.
    habit: Habit<T>,
    /// By how much the acceleration asked for grows in a period, smoothed: planners send it in coarser steps [rad/s^2].
    growth: T,
}

impl<T: Real> PositionLaw<T> {
    pub fn new() -> Self {
        Self {
            before: None,
            indulgence: T::ZERO,
            asked: T::ZERO,
            since: T::ZERO,
            level: T::ZERO,
            habit: Habit::new(),
            growth: T::ZERO,
        }
    }

    pub fn forget(&mut self) {
        *self = Self::new();
    }

    /// The error, less what is let be.
    pub fn heeded(&self, situation: &Situation<T>) -> T {
        beyond(situation.error, self.indulgence)
    }

    pub fn intend(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        now: &Motion<T>,
        ahead: Option<&Motion<T>>,
    ) -> Intent<T> {
        let (asked, known) = self.course(tables, now, ahead);
        let rests = now.speed == T::ZERO && now.acceleration == T::ZERO && (ahead.is_none() || asked == [T::ZERO; 2]);
        let let_be = if rests { self.indulgence } else { T::ZERO };

        let useful = (tables.load_inertia + tables.motor_inertia) * now.acceleration
            + load.even()
            + load.planned_drag(tables, now.speed)
            + tables.position_gain * beyond(situation.error, let_be)
            + tables.damping_gain * situation.error_rate;
        // What is beyond the limits must not drown the damper.
        let all = passed(tables, load.free(), useful);
        let most = if load.throws(tables) { all.abs() } else { tables.most_passed };
        let passed = clamp(all, -most, most);
        let useful = useful - tables.inverse_load_share * (all - passed);
        let asked_for = useful + situation.lost(tables, now.speed, passed);
        let law = clamp(asked_for, -tables.torque_limit, tables.torque_limit) + situation.calm(tables);
        let lost = situation.lost(tables, situation.link_speed, passed);
        let law = limited(tables, load, situation, law - lost) + lost;
        let level = load.even()
            + (load.drag() - load.planned_drag(tables, now.speed))
            + tables.position_gain * beyond(situation.error, let_be)
            + tables.damping_gain * situation.error_rate;
        // News that are large against the doubt are no noise, and are taken up faster.
        self.level += tables.period * load.rate();
        let news = level - self.level;
        let weight = tables.eagerness * news;
        self.level += clamp(tables.settling * clamp(weight * weight, T::ONE, tables.rate), T::ZERO, T::HALF) * news;
        let planned = |time: T| {
            let part = time.over(known);
            let speed = now.speed + time * (now.acceleration + T::HALF * part * asked[1]);
            let speed = if ahead.is_some() { now.speed + part * asked[0] } else { speed };
            tables.load_inertia * (now.acceleration + part * asked[1]) + load.planned_drag(tables, speed)
        };
        let level = self.level;
        let rate = load.rate();
        let demand = |time: T| planned(time) + level + time * rate;
        // A load that is felt has its reasons, and a flank that carries it rests.
        let idles = rests && beyond(load.even(), tables.doubt) == T::ZERO;
        let course = if now.speed == T::ZERO { now.acceleration } else { now.speed };
        let likely = self.habit.follow(tables, situation, course, rests);
        let expects = if ahead.is_none() { likely * load.start(tables) } else { T::ZERO };
        let intent = Intent { idles, rests, expects, ..Intent::new(tables, load, situation, law, demand, false) };
        let surely = beyond(intent.demand_ahead, tables.doubt * tables.least_doubt);
        self.indulge(tables, rests, idles, surely, situation.half);
        intent
    }

    /// By how much speed and acceleration asked for will have changed after a time that is never zero: as the preview
    /// says or, without one, as the jerk does.
    fn course(&mut self, tables: &CompensationTables<T>, now: &Motion<T>, ahead: Option<&Motion<T>>) -> ([T; 2], T) {
        let before = self.before.replace(now.acceleration);
        match ahead {
            Some(ahead) => ([ahead.speed - now.speed, ahead.acceleration - now.acceleration], tables.lead),
            None => {
                let by = before.map_or(T::ZERO, |before| now.acceleration - before);
                self.growth += T::from_i32(SOONER) * tables.settling * (by - self.growth);
                ([T::ZERO, self.growth], tables.period)
            }
        }
    }

    /// Doubles the error that is let be whenever a joint at rest asks for the other flank soon after it asked for this
    /// one, which no load does but a loop that hunts; forgives it slowly, and at once when the joint is to move.
    fn indulge(&mut self, tables: &CompensationTables<T>, rests: bool, idles: bool, demand: T, half: T) {
        self.since = clamp(self.since + tables.period, T::ZERO, tables.hunting);
        if !rests {
            self.indulgence = T::ZERO;
            self.asked = T::ZERO;
            return;
        }
        self.indulgence = if idles { self.indulgence * tables.forgiving } else { T::ZERO };
        if self.asked * demand < T::ZERO {
            if self.since < tables.hunting {
                let grown = self.indulgence + self.indulgence + tables.first_indulgence * half;
                self.indulgence = clamp(grown, T::ZERO, tables.last_indulgence * half);
            }
            self.since = T::ZERO;
        }
        if demand != T::ZERO {
            self.asked = sign(demand);
        }
    }
}

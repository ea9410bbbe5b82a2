//! Which flank carries, when to leave it, and the way across. What torque the law wants is given; how the load will
//! behave in between is taken as ballistic.

use super::crossing::Crossing;
use super::intent::Intent;
use super::path::Path;
use super::set_point::{Position, Stage};
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// The flank in use and the way to the next.
#[derive(Debug, Clone)]
pub(super) struct Flank<T: Real> {
    /// 1 or -1: the flank that carries or is being gone to.
    side: T,
    stage: Stage,
    path: Path<T>,
    /// Position of the set-point when the path was laid.
    origin: Position<T>,
    elapsed: T,
    /// How far the flank was when the landing began [rad].
    opened: T,
    /// How much of the law's torque is let through after a landing.
    rise: T,
    /// Impulse that the load has missed while no flank carried [N m s].
    owed: T,
    /// How much more than usual feedback has to ask for before the flank is changed for it: grows with every change.
    patience: T,
    /// Whether the flank in use has been asked for since the motor set out for it, or the joint to rest.
    asked: bool,
}

impl<T: Real> Flank<T> {
    pub fn new() -> Self {
        Self {
            side: T::ONE,
            stage: Stage::Touching,
            path: Path::default(),
            origin: Position::default(),
            elapsed: T::ZERO,
            opened: T::ZERO,
            rise: T::ONE,
            owed: T::ZERO,
            patience: T::ONE,
            asked: true,
        }
    }

    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Whether a flank has been met that is not asked for yet: the motor is early there.
    pub fn waits(&self) -> bool {
        self.stage == Stage::Touching && !self.asked
    }

    pub fn side(&self) -> T {
        self.side
    }

    /// Nothing is known: whatever flank touches is the one.
    pub fn forget(&mut self, situation: &Situation<T>) {
        self.stage = Stage::Touching;
        self.asked = true;
        self.rise = T::ONE;
        self.owed = T::ZERO;
        if situation.contact != T::ZERO {
            self.side = situation.contact;
        }
    }

    /// Torque of this period, limits aside [N m].
    pub fn step(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>) -> T {
        let opened = self.opened_to(situation);
        // A force that seems to come from the far flank while the teeth are just leaving the near one does not.
        let felt = situation.contact * self.side > T::ZERO && opened < situation.half;
        // A flank that is met softly is seen before it is felt.
        let seen = opened < tables.landed * situation.half;
        // One that stops the motor's approach is there, wherever it was thought to be.
        let stopped = self.stage == Stage::Landing
            && self.elapsed > tables.shortest_ramp + tables.shortest_ramp
            && opened < tables.opening * situation.half
            && self.opened - opened < T::HALF * tables.landing_speed * self.elapsed;
        let closing = self.side * (situation.motor_speed - situation.link_speed);
        let touching = felt || seen || stopped;
        let [now, ahead] = [intent.demand_now, intent.demand_ahead].map(|demand| self.side * (demand + intent.expects));
        let turned = now + ahead < -tables.hysteresis && ahead < -tables.hysteresis;
        // What is only as large as its noise has to grow, and more so soon after a change of flank.
        let later = ahead + ahead - now;
        let grown = clamp(tables.doubt * (self.patience - T::ONE), T::ZERO, tables.most_doubt * situation.half);
        let doubt = tables.doubt * tables.least_doubt + grown;
        let turned = turned && later < -doubt;
        // Of a joint that idles nothing but a flank puts the error right.
        let left = if intent.idles { tables.patience_left * tables.patience_left } else { tables.patience_left };
        self.patience = T::ONE + left * (self.patience - T::ONE);
        // A spring needs no flank but the one that it asks for: while that is in doubt, its own torque finds it.
        let against = intent.spring && now < T::ZERO && ahead < T::ZERO;
        match self.stage {
            // What has just been met is let carry first.
            stage if turned && (stage != Stage::Touching || self.rise >= T::ONE || !felt) => {
                self.side = -self.side;
                self.set_out(tables, situation, intent);
            }
            Stage::Touching | Stage::Landing if against => {
                self.stage = Stage::Touching;
                if situation.contact * self.side < T::ZERO && opened > situation.half {
                    self.side = -self.side;
                }
            }
            Stage::Touching if !touching && opened > tables.opening * situation.half && self.rise >= T::ONE => {
                if opened > T::HALF * situation.half {
                    self.set_out(tables, situation, intent);
                } else {
                    self.land(opened);
                }
            }
            // Teeth that meet before the motor has been braked are about to be struck: braking comes first, unless the blow
            // is no harder than what is to be carried.
            Stage::Crossing if touching && closing < T::from_i32(4) * landing_speed(tables, intent.demand_now) => {
                self.touch();
            }
            Stage::Landing if touching => self.touch(),
            Stage::Crossing if self.elapsed >= self.path.duration() => self.land(opened),
            Stage::Crossing => {
                let crossing = self.rest_of_way(tables, situation, intent);
                if crossing.duration < tables.hurry * (self.path.duration() - self.elapsed) {
                    let [place, speed, _] = self.path.at(self.elapsed + tables.reaction);
                    self.lay(tables, situation, intent, crossing, [place - self.drift(tables, situation), speed]);
                }
            }
            _ => {}
        }
        if self.stage == Stage::Touching {
            self.rise = clamp(self.rise + tables.landing_rise, T::ZERO, T::ONE);
            let repaid = self.rise * self.owed * tables.repayment;
            self.owe(tables, (T::ONE - self.rise) * intent.demand_now - repaid, intent);
            let torque = self.rise * intent.law + repaid;
            self.asked |= intent.rests || self.side * intent.demand_now > T::ZERO;
            // What only the flank that was left could give takes an early motor nowhere but off the one that will be needed.
            let along = along(tables, situation, intent, situation.error_speed);
            let stays = self.waits() && !against || self.side * intent.expects > T::ZERO;
            return if stays && self.side * (torque - along) < T::ZERO { along } else { torque };
        }
        self.elapsed += tables.period;
        self.owe(tables, intent.demand_now, intent);
        if self.stage == Stage::Landing {
            // Where the flank is does not enter, so that a wrong width costs time only; nor can it be chased for ever.
            let speed = landing_speed(tables, intent.demand_now) + tables.landing_haste * self.elapsed;
            let closing = self.side * clamp(speed, T::ZERO, tables.fastest_landing);
            return along(tables, situation, intent, closing);
        }
        // Torque acts one reaction time after it is asked for.
        let [target, rate, _] = self.path.at(self.elapsed);
        let [_, _, acceleration] = self.path.at(self.elapsed + tables.reaction);
        tables.motor_inertia * acceleration
            + tables.gap_stiffness * (target - self.drift(tables, situation) - situation.motor)
            + tables.motor_damping * (rate - situation.motor_speed)
            + situation.lost(tables, rate, T::ZERO)
    }

    /// How far the flank in use is from the teeth, felt at the link [rad].
    fn opened_to(&self, situation: &Situation<T>) -> T {
        situation.half - self.side * (situation.gap - situation.shift)
    }

    /// How far the set-point has moved since the path was laid [rad].
    fn drift(&self, tables: &CompensationTables<T>, situation: &Situation<T>) -> T {
        tables.turn * situation.origin.less(self.origin.turns, self.origin.fraction)
    }

    /// Torque that the load does not get now is owed to it.
    fn owe(&mut self, tables: &CompensationTables<T>, torque: T, intent: &Intent<T>) {
        let most = tables.torque_limit * tables.longest_crossing;
        self.owed = if intent.spring { clamp(self.owed + tables.period * torque, -most, most) } else { T::ZERO };
    }

    fn touch(&mut self) {
        self.stage = Stage::Touching;
        self.rise = T::ZERO;
    }

    fn land(&mut self, opened: T) {
        self.stage = Stage::Landing;
        self.elapsed = T::ZERO;
        self.opened = opened;
    }

    /// Leaves for the flank of `side`.
    fn set_out(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>) {
        let crossing = if self.stage == Stage::Touching {
            Crossing::new(tables, situation.half, intent.haste)
        } else {
            self.rest_of_way(tables, situation, intent)
        };
        self.stage = Stage::Crossing;
        self.asked = false;
        self.patience = clamp(self.patience + self.patience + T::TWO, T::ONE, tables.most_patience);
        let start = [situation.motor + tables.reaction * situation.motor_speed, situation.motor_speed];
        self.lay(tables, situation, intent, crossing, start);
    }

    /// The crossing of what is left of the gap on the way to the flank of `side`: one that turns round on its way has less
    /// of it before it, and what it still goes the other way.
    fn rest_of_way(&self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>) -> Crossing<T> {
        let opened = self.opened_to(situation);
        let opening = self.side * (situation.link_speed - situation.motor_speed);
        let still = tables.shortest_ramp * clamp(opening, T::ZERO, opening.abs());
        let half = clamp(T::HALF * (opened + still), T::ZERO, situation.half);
        Crossing::new(tables, half, intent.haste)
    }

    /// Lays a path to the flank where the load will be, left to itself, meeting it at a small speed. It begins when
    /// torque asked for now acts, at a place less the set-point and a speed.
    fn lay(
        &mut self,
        tables: &CompensationTables<T>,
        situation: &Situation<T>,
        intent: &Intent<T>,
        crossing: Crossing<T>,
        start: [T; 2],
    ) {
        let time = crossing.duration + tables.reaction;
        let [acceleration, jerk] = [intent.free_acceleration, intent.free_jerk];
        let speed = situation.link_speed + time * (acceleration + T::HALF * time * jerk);
        let way = time * (situation.link_speed + T::HALF * time * (acceleration + T::THIRD * time * jerk));
        let place = way - situation.error + situation.shift_after(tables, way);
        let end = [place + self.side * situation.half, speed + self.side * landing_speed(tables, intent.demand_ahead)];
        self.path = Path::new(start, end, crossing);
        self.origin = situation.origin;
        // What is measured in this period is the path's start.
        self.elapsed = -tables.reaction - tables.period;
    }
}

/// Torque of a motor that goes along with the free link, and by so much faster [N m].
fn along<T: Real>(tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>, faster: T) -> T {
    tables.motor_inertia * intent.free_acceleration
        + tables.motor_damping * (situation.link_speed + faster - situation.motor_speed)
        + situation.lost(tables, situation.link_speed, T::ZERO)
}

/// Speed against the load at which a flank is met: hard enough for what it shall carry, and no harder.
fn landing_speed<T: Real>(tables: &CompensationTables<T>, demand: T) -> T {
    clamp(tables.landing_speed_per_torque * demand.abs(), tables.landing_speed, tables.fastest_landing)
}

//! Which flank carries, when to leave it, and the way across. The load is taken to move freely in between.
//!
//! [`transitions`](super::transitions) says what follows from the signs of a period; here are the signs, what is done, and
//! the torque of each stage.

use super::crossing::Crossing;
use super::intent::Intent;
use super::path::Path;
use super::set_point::{Position, Stage};
use super::situation::Situation;
use super::transitions::{Action, Event, Events};
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Landing speeds up to which a motor that meets a flank on a path counts as braked: blows go with the speed, and four times
/// what a landing makes is what planets that are struck on the way make.
const BRAKED: i32 = 4;

/// What a period shows.
struct Signs {
    events: Events,
    /// A spring asks for the other flank, if not by enough to change for it.
    against: bool,
}

/// The flank in use and the way to the next.
#[derive(Debug, Clone)]
pub(super) struct FlankControl<T: Real> {
    /// The flank that carries or is being gone to.
    flank: Flank,
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
    hysteresis: T,
    /// Whether the flank in use has been asked for since the motor set out for it, or the joint to rest.
    asked: bool,
    /// For how long no flank has been needed, as far as that matters [s].
    unneeded: T,
    /// Whether the motor rested in the middle of the gap one period ago.
    centred: bool,
}

impl<T: Real> FlankControl<T> {
    /// How long no flank must have been needed before the motor leaves for the middle of the gap, as a part of the time of
    /// hunting [-]: a load that passes through zero is gone for less.
    const UNNEEDED: T = T::HALF;

    pub fn new() -> Self {
        Self {
            flank: Flank::Drive,
            stage: Stage::Touching,
            path: Path::default(),
            origin: Position::default(),
            elapsed: T::ZERO,
            opened: T::ZERO,
            rise: T::ONE,
            owed: T::ZERO,
            hysteresis: T::ONE,
            asked: true,
            unneeded: T::ZERO,
            centred: false,
        }
    }

    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Whether a flank has been met that is not asked for yet: the motor is early there.
    pub fn waits(&self) -> bool {
        self.stage == Stage::Touching && !self.asked
    }

    /// The flank that carries or is being gone to.
    pub fn flank(&self) -> Flank {
        self.flank
    }

    /// Nothing is known: whatever flank touches is the one.
    pub fn forget(&mut self, situation: &Situation<T>) {
        self.stage = Stage::Touching;
        self.asked = true;
        self.unneeded = T::ZERO;
        self.rise = T::ONE;
        self.owed = T::ZERO;
        self.flank = situation.contact.unwrap_or(self.flank);
    }

    /// Torque of this period, limits aside [N m].
    pub fn step(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>) -> T {
        // Of a joint that idles nothing but a flank puts the error right.
        let left = tables.switching.transient_left;
        let left = if intent.idles { left * left } else { left };
        self.hysteresis = T::ONE + left * (self.hysteresis - T::ONE);
        let enough = Self::UNNEEDED * tables.rest.hunting;
        self.centred = self.unneeded >= enough;
        if intent.needs_no_flank && self.stage == Stage::Touching {
            self.unneeded = clamp(self.unneeded + tables.clock.period, T::ZERO, enough);
            if self.unneeded >= enough {
                return centring(tables, situation);
            }
        } else {
            self.unneeded = T::ZERO;
        }
        if self.centred {
            self.flank = Flank::towards(intent.demand_ahead).unwrap_or(self.flank);
        }
        let opened = self.opened_to(situation);
        let signs = self.signs(tables, situation, intent, opened);
        if let Some(action) = signs.events.action(self.stage) {
            self.act(tables, situation, intent, opened, action);
        }
        let side: T = self.flank.sign();
        if self.stage == Stage::Touching {
            self.rise = clamp(self.rise + tables.landing.rise, T::ZERO, T::ONE);
            let repaid = self.rise * self.owed * tables.landing.repayment;
            self.owe(tables, (T::ONE - self.rise) * intent.demand_now - repaid, intent);
            let torque = self.rise * intent.law + repaid;
            self.asked |= intent.rests || side * intent.demand_now > T::ZERO;
            // What only the flank that was left could give takes an early motor nowhere but off the one that will be needed.
            let along = along(tables, situation, intent, situation.transmission_error_speed);
            let stays = self.waits() && !signs.against || side * intent.expects > T::ZERO;
            return if stays && side * (torque - along) < T::ZERO { along } else { torque };
        }
        self.elapsed += tables.clock.period;
        self.owe(tables, intent.demand_now, intent);
        if self.stage == Stage::Landing {
            // Where the flank is does not enter, so that a wrong width costs time only; nor can it be chased for ever.
            let speed = landing_speed(tables, intent.demand_now) + tables.landing.acceleration * self.elapsed;
            let closing = side * clamp(speed, T::ZERO, tables.landing.fastest);
            return along(tables, situation, intent, closing);
        }
        // Torque acts one reaction time after it is asked for.
        let [target, rate, _] = self.path.at(self.elapsed);
        let [_, _, acceleration] = self.path.at(self.elapsed + tables.crossing.reaction);
        tables.body.motor_inertia * acceleration
            + tables.crossing.stiffness * (target - self.drift(tables, situation) - situation.motor)
            + tables.law.motor_damping * (rate - situation.motor_speed)
            + situation.lost(tables, rate, T::ZERO)
    }

    /// What a period shows.
    fn signs(&self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>, opened: T) -> Signs {
        let (landing, switching) = (&tables.landing, &tables.switching);
        let side: T = self.flank.sign();
        // A force that seems to come from the far flank while the teeth are just leaving the near one does not.
        let felt = situation.contact == Some(self.flank) && opened < situation.half;
        // A flank that is met softly is seen before it is felt.
        let seen = opened < landing.landed * situation.half;
        // One that stops the motor's approach is there, wherever it was thought to be.
        let stopped = self.stage == Stage::Landing
            && self.elapsed > tables.crossing.shortest_ramp + tables.crossing.shortest_ramp
            && opened < landing.opening * situation.half
            && self.opened - opened < T::HALF * landing.speed * self.elapsed;
        let touching = felt || seen || stopped;
        let carries = self.rise >= T::ONE;
        let [now, ahead] = [intent.demand_now, intent.demand_ahead].map(|demand| side * (demand + intent.expects));
        let turned = now + ahead < -switching.planned && ahead < -switching.planned;
        // What is only as large as its noise has to grow, and more so soon after a change of flank.
        let later = ahead + ahead - now;
        let most = switching.most_growth * situation.half;
        let grown = clamp(switching.measured * (self.hysteresis - T::ONE), T::ZERO, most);
        let turned = turned && later < -(switching.measured * switching.least + grown);
        // What has just been met is let carry first.
        let turned = turned && (self.stage != Stage::Touching || carries || !felt);
        // A spring needs no flank but the one that it asks for: while that is in doubt, its own torque finds it.
        let against = intent.spring && now < T::ZERO && ahead < T::ZERO;
        let opens = !touching && carries && opened > landing.opening * situation.half;
        let lost = opens && opened > T::HALF * situation.half;
        // Teeth that meet before the motor has been braked are about to be struck: braking comes first, unless the blow is
        // no harder than what is to be carried, or the link is thrown: then every moment counts.
        let met =
            touching && (self.stage != Stage::Crossing || intent.thrown || self.is_braked(tables, situation, intent));
        let ended = self.elapsed >= self.path.duration();
        let events = Events::UNDERWAY
            .with(Event::DemandTurned, turned)
            .with(Event::SpringUndecided, against)
            .with(Event::FlankLost, lost)
            .with(Event::FlankOpening, opens)
            .with(Event::FlankMet, met)
            .with(Event::PathEnded, ended);
        Signs { events, against }
    }

    /// Whether the motor closes on the flank no faster than a landing that strikes as hard as what is to be carried.
    fn is_braked(&self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>) -> bool {
        let closing = self.flank.sign::<T>() * (situation.motor_speed - situation.link_speed);
        closing < T::from_i32(BRAKED) * landing_speed(tables, intent.demand_now)
    }

    /// Does what follows from the signs.
    fn act(
        &mut self,
        tables: &CompensationTables<T>,
        situation: &Situation<T>,
        intent: &Intent<T>,
        opened: T,
        action: Action,
    ) {
        let before = core::mem::replace(&mut self.stage, action.stage());
        match action {
            Action::CrossOver => {
                self.flank = self.flank.opposite();
                self.set_out(tables, situation, intent, before);
            }
            Action::CrossBack => self.set_out(tables, situation, intent, before),
            Action::Land => {
                self.elapsed = T::ZERO;
                self.opened = opened;
            }
            Action::Carry => self.rise = if intent.thrown { T::ONE } else { T::ZERO },
            Action::LetSpringFind => {
                let other = self.flank.opposite();
                if situation.contact == Some(other) && opened > situation.half {
                    self.flank = other;
                }
            }
            Action::Shorten => {
                let crossing = self.rest_of_way(tables, situation, intent);
                if crossing.duration < tables.crossing.shorten * (self.path.duration() - self.elapsed) {
                    let [place, speed, _] = self.path.at(self.elapsed + tables.crossing.reaction);
                    self.lay(tables, situation, intent, crossing, [place - self.drift(tables, situation), speed]);
                }
            }
        }
    }

    /// How far the flank in use is from the teeth, referred to the link [rad].
    fn opened_to(&self, situation: &Situation<T>) -> T {
        situation.half - self.flank.sign::<T>() * (situation.gap - situation.shift)
    }

    /// How far the set-point has moved since the path was laid [rad].
    fn drift(&self, tables: &CompensationTables<T>, situation: &Situation<T>) -> T {
        tables.gear.turn * situation.origin.less(self.origin.turns, self.origin.fraction)
    }

    /// Torque that the load does not get now is owed to it.
    fn owe(&mut self, tables: &CompensationTables<T>, torque: T, intent: &Intent<T>) {
        let most = tables.limits.motor * tables.crossing.longest;
        self.owed = if intent.spring { clamp(self.owed + tables.clock.period * torque, -most, most) } else { T::ZERO };
    }

    /// Leaves for the flank, from a stage.
    fn set_out(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>, from: Stage) {
        let crossing = if from == Stage::Touching && !self.centred {
            Crossing::new(tables, situation.half, intent.far_demand)
        } else {
            self.rest_of_way(tables, situation, intent)
        };
        self.asked = false;
        self.hysteresis = clamp(self.hysteresis + self.hysteresis + T::TWO, T::ONE, tables.switching.most_factor);
        let start = [situation.motor + tables.crossing.reaction * situation.motor_speed, situation.motor_speed];
        self.lay(tables, situation, intent, crossing, start);
    }

    /// The crossing of what is left of the gap on the way to the flank: one that turns round on its way has less
    /// of it before it, and what it still goes the other way.
    fn rest_of_way(&self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>) -> Crossing<T> {
        let opened = self.opened_to(situation);
        let opening = self.flank.sign::<T>() * (situation.link_speed - situation.motor_speed);
        let still = tables.crossing.shortest_ramp * clamp(opening, T::ZERO, opening.abs());
        let half = clamp(T::HALF * (opened + still), T::ZERO, situation.half);
        Crossing::new(tables, half, intent.far_demand)
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
        let time = crossing.duration + tables.crossing.reaction;
        let [acceleration, jerk] = [intent.free_acceleration, intent.free_jerk];
        let speed = situation.link_speed + time * (acceleration + T::HALF * time * jerk);
        let way = time * (situation.link_speed + T::HALF * time * (acceleration + T::THIRD * time * jerk));
        let place = way - situation.error + situation.shift_after(tables, way);
        let end = [
            place + self.flank.sign::<T>() * situation.half,
            speed + self.flank.sign::<T>() * landing_speed(tables, intent.demand_ahead),
        ];
        self.path = Path::new(start, end, crossing);
        self.origin = situation.origin;
        // What is measured in this period is the path's start.
        self.elapsed = -tables.crossing.reaction - tables.clock.period;
    }
}

/// Torque that takes the motor to the middle of the gap and keeps it there, beside a link that stands still [N m].
fn centring<T: Real>(tables: &CompensationTables<T>, situation: &Situation<T>) -> T {
    let rate = situation.link_speed - situation.motor_speed;
    tables.crossing.stiffness * (situation.shift - situation.gap)
        + tables.law.motor_damping * rate
        + situation.lost(tables, rate, T::ZERO)
}

/// Torque of a motor that goes along with the free link, and by so much faster [N m].
fn along<T: Real>(tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>, faster: T) -> T {
    tables.body.motor_inertia * intent.free_acceleration
        + tables.law.motor_damping * (situation.link_speed + faster - situation.motor_speed)
        + situation.lost(tables, situation.link_speed, T::ZERO)
}

/// Speed against the load at which a flank is met: hard enough for what it shall carry, and no harder.
fn landing_speed<T: Real>(tables: &CompensationTables<T>, demand: T) -> T {
    clamp(tables.landing.speed_per_torque * demand.abs(), tables.landing.speed, tables.landing.fastest)
}

//! Selects the flank in use and the time of its change, and moves the motor through the gap. Assumption: without a flank the link
//! moves freely. [`transitions`](super::transitions) maps the events of a period to an action; this file detects the events (`signs`),
//! executes the actions (`act`) and computes the torque of each stage (`step`).
//!
//! ```text
//! (K5)   side (now + ahead) < 0,   side ahead < 0                               `signs`
//! (K9)   torque = J_m a_path(time + T_r) + stiffness (path - motor)
//!                 + D_m (path speed - w_m) + losses                             `step`
//! (K10)  landing speed = max(0.03 rated, 0.4 |demand|)/sqrt(S J_m)              `landing_speed`
//! (K13)  0.3 M + min((g - 1) M, 0.3 K h) < -side (2 ahead - now)                `signs`, g = `hysteresis`
//! (K14)  torque = stiffness (shift - gap) + D_m (w_l - w_m) + losses            `centring`
//! (K16)  torque += owed/(1.15 T_c)                                              `step`, `owe`
//! ```

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

/// Closing speed, in landing speeds, below which a motor on a path counts as braked: the force of a blow is
/// proportional to the speed, and planets struck on the way cause four times the force of a landing.
const BRAKED: i32 = 4;

/// Events of a period.
struct Signs {
    events: Events,
    /// Impedance mode: now and after a crossing, the demand is on the other flank, without regard to the hysteresis.
    against: bool,
}

/// Flank in use and path to it.
#[derive(Debug, Clone)]
pub(super) struct FlankControl<T: Real> {
    /// Flank that carries or is approached.
    flank: Flank,
    stage: Stage,
    path: Path<T>,
    /// Position of the set-point at the time the path was laid.
    origin: Position<T>,
    elapsed: T,
    /// Opening at the beginning of the landing [rad].
    opened: T,
    /// Share of the law's torque applied after a landing, 0 to 1 [-].
    rise: T,
    /// Impulse that the link has missed while no flank carried, `owed` in (K16) [N m s].
    owed: T,
    /// Factor g of the switching hysteresis (K13); grows with every change of the flank [-].
    hysteresis: T,
    /// True once the demand has asked for the flank in use since the motor set out for it, or the joint rests.
    asked: bool,
    /// Time for which no flank has been needed, saturating [s].
    unneeded: T,
    /// True if the motor rested in the middle of the gap in the previous period.
    centred: bool,
}

impl<T: Real> FlankControl<T> {
    /// Time without need of a flank after which the motor moves to the middle of the gap, over `rest.hunting` [-]: a
    /// load that passes through zero is absent for a shorter time.
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

    /// True while the motor has arrived early: it touches a flank that the demand does not ask for yet.
    pub fn waits(&self) -> bool {
        self.stage == Stage::Touching && !self.asked
    }

    /// Flank that carries or is approached.
    pub fn flank(&self) -> Flank {
        self.flank
    }

    /// Resets the state while the estimates are invalid; a flank in contact becomes the flank in use.
    pub fn forget(&mut self, situation: &Situation<T>) {
        self.stage = Stage::Touching;
        self.asked = true;
        self.unneeded = T::ZERO;
        self.rise = T::ONE;
        self.owed = T::ZERO;
        self.flank = situation.contact.unwrap_or(self.flank);
    }

    /// Computes the torque of this period before the motor's limit [N m].
    pub fn step(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>) -> T {
        // Without a load only a flank corrects an error, so the hysteresis decays twice as fast.
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
            // If the motor arrives early, torque of the old sign is not applied: it would push the motor off the new
            // flank.
            let along = along(tables, situation, intent, situation.transmission_error_speed);
            let stays = self.waits() && !signs.against || side * intent.expects > T::ZERO;
            return if stays && side * (torque - along) < T::ZERO { along } else { torque };
        }
        self.elapsed += tables.clock.period;
        self.owe(tables, intent.demand_now, intent);
        if self.stage == Stage::Landing {
            // The landing uses speed only, not the position of the flank: a wrong width costs time, not force. The
            // speed grows, so that a receding flank is reached.
            let speed = landing_speed(tables, intent.demand_now) + tables.landing.acceleration * self.elapsed;
            let closing = side * clamp(speed, T::ZERO, tables.landing.fastest);
            return along(tables, situation, intent, closing);
        }
        // Torque acts one reaction time after its command.
        let [target, rate, _] = self.path.at(self.elapsed);
        let [_, _, acceleration] = self.path.at(self.elapsed + tables.crossing.reaction);
        tables.body.motor_inertia * acceleration
            + tables.crossing.stiffness * (target - self.drift(tables, situation) - situation.motor)
            + tables.law.motor_damping * (rate - situation.motor_speed)
            + situation.lost(tables, rate, T::ZERO)
    }

    /// Detects the events of a period.
    fn signs(&self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>, opened: T) -> Signs {
        let (landing, switching) = (&tables.landing, &tables.switching);
        let side: T = self.flank.sign();
        // Contact reported beyond the middle of the gap is ignored: teeth that just leave the near flank seem to touch
        // the far one.
        let felt = situation.contact == Some(self.flank) && opened < situation.half;
        // A soft landing shows in the position before it shows in the force.
        let seen = opened < landing.landed * situation.half;
        // A flank that stops the approach is met, wherever the estimates place it.
        let stopped = self.stage == Stage::Landing
            && self.elapsed > tables.crossing.shortest_ramp + tables.crossing.shortest_ramp
            && opened < landing.opening * situation.half
            && self.opened - opened < T::HALF * landing.speed * self.elapsed;
        let touching = felt || seen || stopped;
        let carries = self.rise >= T::ONE;
        let [now, ahead] = [intent.demand_now, intent.demand_ahead].map(|demand| side * (demand + intent.expects));
        let turned = now + ahead < -switching.planned && ahead < -switching.planned;
        // Measured demand must exceed its noise, by more soon after a flank change (K13).
        let later = ahead + ahead - now;
        let most = switching.most_growth * situation.half;
        let grown = clamp(switching.measured * (self.hysteresis - T::ONE), T::ZERO, most);
        let turned = turned && later < -(switching.measured * switching.least + grown);
        // A flank just met carries first: no change while it is felt and the torque still rises.
        let turned = turned && (self.stage != Stage::Touching || carries || !felt);
        // In impedance mode only the flank that the spring presses is needed: below the hysteresis the spring's own
        // torque finds it.
        let against = intent.spring && now < T::ZERO && ahead < T::ZERO;
        let opens = !touching && carries && opened > landing.opening * situation.half;
        let lost = opens && opened > T::HALF * situation.half;
        // A motor that is not braked would strike the flank: braking comes first, unless the blow is no harder than the
        // torque to be carried, or the link is pushed harder than the teeth's limit and every moment counts.
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

    /// True if the motor closes on the flank so slowly that the blow is no harder than the torque to be carried.
    fn is_braked(&self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>) -> bool {
        let closing = self.flank.sign::<T>() * (situation.motor_speed - situation.link_speed);
        closing < T::from_i32(BRAKED) * landing_speed(tables, intent.demand_now)
    }

    /// Executes an action.
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

    /// Opening x of the flank in use, referred to the link [rad].
    fn opened_to(&self, situation: &Situation<T>) -> T {
        situation.half - self.flank.sign::<T>() * (situation.gap - situation.shift)
    }

    /// Travel of the set-point since the path was laid [rad].
    fn drift(&self, tables: &CompensationTables<T>, situation: &Situation<T>) -> T {
        tables.gear.turn * situation.origin.less(self.origin.turns, self.origin.fraction)
    }

    /// Adds the torque that the link misses in this period to the owed impulse; zero in position mode (K16).
    fn owe(&mut self, tables: &CompensationTables<T>, torque: T, intent: &Intent<T>) {
        let most = tables.limits.motor * tables.crossing.longest;
        self.owed = if intent.spring { clamp(self.owed + tables.clock.period * torque, -most, most) } else { T::ZERO };
    }

    /// Lays a path to the flank in use; `from` is the stage that ends.
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

    /// Crossing of the rest of the gap on the way to the flank. A motor that turns round within the gap has less of the
    /// gap before it, but still travels the other way while it brakes.
    fn rest_of_way(&self, tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>) -> Crossing<T> {
        let opened = self.opened_to(situation);
        let opening = self.flank.sign::<T>() * (situation.link_speed - situation.motor_speed);
        let still = tables.crossing.shortest_ramp * clamp(opening, T::ZERO, opening.abs());
        let half = clamp(T::HALF * (opened + still), T::ZERO, situation.half);
        Crossing::new(tables, half, intent.far_demand)
    }

    /// Lays a path to the place where the flank will be if the link moves freely; the path ends at the landing speed.
    /// `start` is motor position less set-point and motor speed at the time when torque commanded now acts.
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
        // The time of the path is zero one reaction time after this period; `step` adds the period.
        self.elapsed = -tables.crossing.reaction - tables.clock.period;
    }
}

/// Torque that moves the motor to the middle of the gap and holds it there, beside a link at rest (K14) [N m].
fn centring<T: Real>(tables: &CompensationTables<T>, situation: &Situation<T>) -> T {
    let rate = situation.link_speed - situation.motor_speed;
    tables.crossing.stiffness * (situation.shift - situation.gap)
        + tables.law.motor_damping * rate
        + situation.lost(tables, rate, T::ZERO)
}

/// Torque of a motor that follows the free link, faster than the link by `faster` [N m].
fn along<T: Real>(tables: &CompensationTables<T>, situation: &Situation<T>, intent: &Intent<T>, faster: T) -> T {
    tables.body.motor_inertia * intent.free_acceleration
        + tables.law.motor_damping * (situation.link_speed + faster - situation.motor_speed)
        + situation.lost(tables, situation.link_speed, T::ZERO)
}

/// Landing speed against the link (K10) [rad/s]: as hard as the torque to be carried allows, not harder.
fn landing_speed<T: Real>(tables: &CompensationTables<T>, demand: T) -> T {
    clamp(tables.landing.speed_per_torque * demand.abs(), tables.landing.speed, tables.landing.fastest)
}

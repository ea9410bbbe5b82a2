//! Selects the flank in use and the time of its change, and moves the motor through the gap. Assumption: without a flank the link
//! moves freely. [`transitions`](super::transitions) maps the events of a period to an action; this file detects the events (`detect_events`),
//! executes the actions (`execute`) and computes the torque of each stage (`step`).
//!
//! ```text
//! (K5)   side (now + ahead) < 0,   side ahead < 0                               `detect_events`
//! (K9)   torque = J_m a_path(time + T_r) + stiffness (path - motor)
//!                 + D_m (path speed - w_m) + losses                             `step`
//! (K10)  landing speed = max(0.03 rated, 0.4 |demand|)/sqrt(S J_m)              `landing_speed`
//! (K13)  0.3 M + min((g - 1) M, 0.3 K h) < -side (2 ahead - now)                `detect_events`, g = `hysteresis`
//! (K14)  torque = stiffness (shift - gap) + D_m (w_l - w_m) + losses            `centring`
//! (K16)  torque += impulse_deficit/(1.15 T_c)                                   `step`, `add_impulse_deficit`
//! ```

use super::control_demand::ControlDemand;
use super::crossing_path::CrossingPath;
use super::crossing_timing::CrossingTiming;
use super::loop_state::LoopState;
use super::set_point::{Position, Stage};
use super::transitions::{Action, Event, Events};
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Closing speed, in landing speeds, below which a motor on a path counts as braked: the force of a blow is
/// proportional to the speed, and planets struck on the way cause four times the force of a landing.
const BRAKED_LANDING_SPEEDS: i32 = 4;

/// Events of a period.
struct DetectedEvents {
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
    path: CrossingPath<T>,
    /// Position of the set-point at the time the path was laid.
    origin: Position<T>,
    elapsed: T,
    /// Opening at the beginning of the landing [rad].
    opened: T,
    /// Share of the law's torque applied after a landing, 0 to 1 [-].
    rise: T,
    /// Impulse that the link has missed while no flank carried, `impulse_deficit` in (K16) [N m s].
    impulse_deficit: T,
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
            path: CrossingPath::default(),
            origin: Position::default(),
            elapsed: T::ZERO,
            opened: T::ZERO,
            rise: T::ONE,
            impulse_deficit: T::ZERO,
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
    pub fn arrived_early(&self) -> bool {
        self.stage == Stage::Touching && !self.asked
    }

    /// Flank that carries or is approached.
    pub fn flank(&self) -> Flank {
        self.flank
    }

    /// Resets the state while the estimates are invalid; a flank in contact becomes the flank in use.
    pub fn reset(&mut self, state: &LoopState<T>) {
        self.stage = Stage::Touching;
        self.asked = true;
        self.unneeded = T::ZERO;
        self.rise = T::ONE;
        self.impulse_deficit = T::ZERO;
        self.flank = state.contact.unwrap_or(self.flank);
    }

    /// Computes the torque of this period before the motor's limit [N m].
    pub fn step(&mut self, tables: &CompensationTables<T>, state: &LoopState<T>, demand: &ControlDemand<T>) -> T {
        // Without a load only a flank corrects an error, so the hysteresis decays twice as fast.
        let left = tables.switching.transient_left;
        let left = if demand.rests_unloaded { left * left } else { left };
        self.hysteresis = T::ONE + left * (self.hysteresis - T::ONE);
        let enough = Self::UNNEEDED * tables.rest.hunting;
        self.centred = self.unneeded >= enough;
        if demand.needs_no_flank && self.stage == Stage::Touching {
            self.unneeded = clamp(self.unneeded + tables.clock.period, T::ZERO, enough);
            if self.unneeded >= enough {
                return centring(tables, state);
            }
        } else {
            self.unneeded = T::ZERO;
        }
        if self.centred {
            self.flank = Flank::towards(demand.after_crossing).unwrap_or(self.flank);
        }
        let opened = self.opening(state);
        let detected = self.detect_events(tables, state, demand, opened);
        if let Some(action) = detected.events.action(self.stage) {
            self.execute(tables, state, demand, opened, action);
        }
        let side: T = self.flank.sign();
        if self.stage == Stage::Touching {
            self.rise = clamp(self.rise + tables.landing.rise, T::ZERO, T::ONE);
            let repaid = self.rise * self.impulse_deficit * tables.landing.repayment;
            self.add_impulse_deficit(tables, (T::ONE - self.rise) * demand.now - repaid, demand);
            let torque = self.rise * demand.law_torque + repaid;
            self.asked |= demand.rests || side * demand.now > T::ZERO;
            // If the motor arrives early, torque of the old sign is not applied: it would push the motor off the new
            // flank.
            let minimum = follow_link(tables, state, demand, state.transmission_error_speed);
            let stays = self.arrived_early() && !detected.against || side * demand.expected_start_torque > T::ZERO;
            return if stays && side * (torque - minimum) < T::ZERO { minimum } else { torque };
        }
        self.elapsed += tables.clock.period;
        self.add_impulse_deficit(tables, demand.now, demand);
        if self.stage == Stage::Landing {
            // The landing uses speed only, not the position of the flank: a wrong width costs time, not force. The
            // speed grows, so that a receding flank is reached.
            let speed = landing_speed(tables, demand.now) + tables.landing.acceleration * self.elapsed;
            let closing = side * clamp(speed, T::ZERO, tables.landing.fastest);
            return follow_link(tables, state, demand, closing);
        }
        // Torque acts one reaction time after its command.
        let [target, rate, _] = self.path.at(self.elapsed);
        let [_, _, acceleration] = self.path.at(self.elapsed + tables.crossing.reaction);
        tables.body.motor_inertia * acceleration
            + tables.crossing.stiffness * (target - self.set_point_travel(tables, state) - state.motor_position)
            + tables.law.motor_damping * (rate - state.motor_speed)
            + state.loss_torque(tables, rate, T::ZERO)
    }

    /// Detects the events of a period.
    fn detect_events(
        &self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        demand: &ControlDemand<T>,
        opened: T,
    ) -> DetectedEvents {
        let (landing, switching) = (&tables.landing, &tables.switching);
        let side: T = self.flank.sign();
        // Contact reported beyond the middle of the gap is ignored: teeth that just leave the near flank seem to touch
        // the far one.
        let contact_felt = state.contact == Some(self.flank) && opened < state.half_gap;
        // A soft landing shows in the position before it shows in the force.
        let contact_seen = opened < landing.landed * state.half_gap;
        // A flank that stops the approach is met, wherever the estimates place it.
        let stopped = self.stage == Stage::Landing
            && self.elapsed > tables.crossing.shortest_ramp + tables.crossing.shortest_ramp
            && opened < landing.opening * state.half_gap
            && self.opened - opened < T::HALF * landing.speed * self.elapsed;
        let touching = contact_felt || contact_seen || stopped;
        let carries = self.rise >= T::ONE;
        let [now, ahead] =
            [demand.now, demand.after_crossing].map(|torque| side * (torque + demand.expected_start_torque));
        let turned = now + ahead < -switching.planned && ahead < -switching.planned;
        // Measured demand must exceed its noise, by more soon after a flank change (K13).
        let later = ahead + ahead - now;
        let most = switching.most_growth * state.half_gap;
        let grown = clamp(switching.measured * (self.hysteresis - T::ONE), T::ZERO, most);
        let turned = turned && later < -(switching.measured * switching.least + grown);
        // A flank just met carries first: no change while it is felt and the torque still rises.
        let turned = turned && (self.stage != Stage::Touching || carries || !contact_felt);
        // In impedance mode only the flank that the spring presses is needed: below the hysteresis the spring's own
        // torque finds it.
        let against = demand.is_impedance && now < T::ZERO && ahead < T::ZERO;
        let opens = !touching && carries && opened > landing.opening * state.half_gap;
        let lost = opens && opened > T::HALF * state.half_gap;
        // A motor that is not braked would strike the flank: braking comes first, unless the blow is no harder than the
        // torque to be carried, or the link is pushed harder than the teeth's limit and every moment counts.
        let met = touching
            && (self.stage != Stage::Crossing || demand.external_impact || self.is_braked(tables, state, demand));
        let ended = self.elapsed >= self.path.duration();
        let events = Events::UNDERWAY
            .with(Event::DemandTurned, turned)
            .with(Event::SpringUndecided, against)
            .with(Event::FlankLost, lost)
            .with(Event::FlankOpening, opens)
            .with(Event::FlankMet, met)
            .with(Event::PathEnded, ended);
        DetectedEvents { events, against }
    }

    /// True if the motor closes on the flank so slowly that the blow is no harder than the torque to be carried.
    fn is_braked(&self, tables: &CompensationTables<T>, state: &LoopState<T>, demand: &ControlDemand<T>) -> bool {
        let closing = self.flank.sign::<T>() * (state.motor_speed - state.link_speed);
        closing < T::from_i32(BRAKED_LANDING_SPEEDS) * landing_speed(tables, demand.now)
    }

    /// Executes an action.
    fn execute(
        &mut self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        demand: &ControlDemand<T>,
        opened: T,
        action: Action,
    ) {
        let before = core::mem::replace(&mut self.stage, action.stage());
        match action {
            Action::CrossOver => {
                self.flank = self.flank.opposite();
                self.start_crossing(tables, state, demand, before);
            }
            Action::CrossBack => self.start_crossing(tables, state, demand, before),
            Action::Land => {
                self.elapsed = T::ZERO;
                self.opened = opened;
            }
            Action::Carry => self.rise = if demand.external_impact { T::ONE } else { T::ZERO },
            Action::LetSpringFind => {
                let other = self.flank.opposite();
                if state.contact == Some(other) && opened > state.half_gap {
                    self.flank = other;
                }
            }
            Action::Shorten => {
                let crossing = self.remaining_crossing(tables, state, demand);
                if crossing.duration < tables.crossing.shorten * (self.path.duration() - self.elapsed) {
                    let [place, speed, _] = self.path.at(self.elapsed + tables.crossing.reaction);
                    self.plan_path(
                        tables,
                        state,
                        demand,
                        crossing,
                        [place - self.set_point_travel(tables, state), speed],
                    );
                }
            }
        }
    }

    /// Opening x of the flank in use, referred to the link [rad].
    fn opening(&self, state: &LoopState<T>) -> T {
        state.half_gap - self.flank.sign::<T>() * (state.gap - state.flank_shift)
    }

    /// Travel of the set-point since the path was laid [rad].
    fn set_point_travel(&self, tables: &CompensationTables<T>, state: &LoopState<T>) -> T {
        tables.gear.turn * state.origin.difference(self.origin.turns, self.origin.fraction)
    }

    /// Adds the torque that the link misses in this period to the impulse deficit; zero in position mode (K16).
    fn add_impulse_deficit(&mut self, tables: &CompensationTables<T>, torque: T, demand: &ControlDemand<T>) {
        let most = tables.limits.motor * tables.crossing.longest;
        self.impulse_deficit = if demand.is_impedance {
            clamp(self.impulse_deficit + tables.clock.period * torque, -most, most)
        } else {
            T::ZERO
        };
    }

    /// Lays a path to the flank in use; `from` is the stage that ends.
    fn start_crossing(
        &mut self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        demand: &ControlDemand<T>,
        from: Stage,
    ) {
        let crossing = if from == Stage::Touching && !self.centred {
            CrossingTiming::new(tables, state.half_gap, demand.at_far_flank)
        } else {
            self.remaining_crossing(tables, state, demand)
        };
        self.asked = false;
        self.hysteresis = clamp(self.hysteresis + self.hysteresis + T::TWO, T::ONE, tables.switching.most_factor);
        let start = [state.motor_position + tables.crossing.reaction * state.motor_speed, state.motor_speed];
        self.plan_path(tables, state, demand, crossing, start);
    }

    /// Crossing of the rest of the gap on the way to the flank. A motor that turns round within the gap has less of the
    /// gap before it, but still travels the other way while it brakes.
    fn remaining_crossing(
        &self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        demand: &ControlDemand<T>,
    ) -> CrossingTiming<T> {
        let opened = self.opening(state);
        let opening = self.flank.sign::<T>() * (state.link_speed - state.motor_speed);
        let still = tables.crossing.shortest_ramp * clamp(opening, T::ZERO, opening.abs());
        let half = clamp(T::HALF * (opened + still), T::ZERO, state.half_gap);
        CrossingTiming::new(tables, half, demand.at_far_flank)
    }

    /// Lays a path to the place where the flank will be if the link moves freely; the path ends at the landing speed.
    /// `start` is motor position less set-point and motor speed at the time when torque commanded now acts.
    fn plan_path(
        &mut self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        demand: &ControlDemand<T>,
        crossing: CrossingTiming<T>,
        start: [T; 2],
    ) {
        let time = crossing.duration + tables.crossing.reaction;
        let [acceleration, jerk] = [demand.free_acceleration, demand.free_jerk];
        let speed = state.link_speed + time * (acceleration + T::HALF * time * jerk);
        let way = time * (state.link_speed + T::HALF * time * (acceleration + T::THIRD * time * jerk));
        let place = way - state.error + state.flank_shift_after(tables, way);
        let end = [
            place + self.flank.sign::<T>() * state.half_gap,
            speed + self.flank.sign::<T>() * landing_speed(tables, demand.after_crossing),
        ];
        self.path = CrossingPath::new(start, end, crossing);
        self.origin = state.origin;
        // The time of the path is zero one reaction time after this period; `step` adds the period.
        self.elapsed = -tables.crossing.reaction - tables.clock.period;
    }
}

/// Torque that moves the motor to the middle of the gap and holds it there, beside a link at rest (K14) [N m].
fn centring<T: Real>(tables: &CompensationTables<T>, state: &LoopState<T>) -> T {
    let rate = state.link_speed - state.motor_speed;
    tables.crossing.stiffness * (state.flank_shift - state.gap)
        + tables.law.motor_damping * rate
        + state.loss_torque(tables, rate, T::ZERO)
}

/// Torque of a motor that follows the free link, faster than the link by `faster` [N m].
fn follow_link<T: Real>(
    tables: &CompensationTables<T>,
    state: &LoopState<T>,
    demand: &ControlDemand<T>,
    faster: T,
) -> T {
    tables.body.motor_inertia * demand.free_acceleration
        + tables.law.motor_damping * (state.link_speed + faster - state.motor_speed)
        + state.loss_torque(tables, state.link_speed, T::ZERO)
}

/// Landing speed against the link (K10) [rad/s]: as hard as the torque to be carried allows, not harder.
fn landing_speed<T: Real>(tables: &CompensationTables<T>, demand: T) -> T {
    clamp(tables.landing.speed_per_torque * demand.abs(), tables.landing.speed, tables.landing.fastest)
}

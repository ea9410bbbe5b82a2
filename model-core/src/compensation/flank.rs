//! Selects the flank in use and the time of its change, and moves the motor through the gap. Assumption: without a flank
//! the link moves freely. [`transitions`](super::transitions) maps the events of a period to an action; this file detects
//! the events, executes the actions and computes the torque of each stage.
//!
//! ```text
//! (K5)   side (now + ahead) < 0,   side ahead < 0                        `demand_turned`
//! (K9)   torque = J_m a_path(time + T_r) + stiffness (path - motor)
//!                 + D_m (path speed - w_m) + losses                      `path_torque`
//! (K10)  landing speed = max(0.03 rated, 0.4 |demand|)/sqrt(S J_m)       `landing_speed`
//! (K13)  0.3 M + min((g - 1) M, 0.3 K h) < -side (2 ahead - now)         `demand_turned`, g = `hysteresis`
//! (K14)  torque = stiffness (shift - gap) + D_m (w_l - w_m) + losses     `centring_torque`
//! (K16)  torque += deficit/(1.15 T_c)                                    `contact_torque`, `add_impulse_deficit`
//! ```
//!
//! Symbols: side = `flank.sign()`, now = `demand.now`, ahead = `demand.after_crossing`, deficit = `impulse_deficit`,
//! h = `half_gap`, shift = `flank_shift`.

use super::control_demand::ControlDemand;
use super::crossing_path::CrossingPath;
use super::crossing_timing::CrossingTiming;
use super::loop_state::LoopState;
use super::set_point::{Position, Stage};
use super::thresholds::FlankThresholds;
use super::transitions::{Action, Event, Events};
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Events of a period.
struct DetectedEvents {
    events: Events,
    /// Impedance mode: now and after a crossing, the demand is on the other flank, without regard to the hysteresis.
    spring_undecided: bool,
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
    landing_opening: T,
    /// Share of the law's torque applied after a landing, 0 to 1 [-].
    rise: T,
    /// Impulse that the link has missed while no flank carried, `impulse_deficit` in (K16) [N m s].
    impulse_deficit: T,
    /// Factor g of the switching hysteresis (K13); grows with every change of the flank [-].
    hysteresis: T,
    /// True once the demand has asked for the flank in use since the motor set out for it, or the joint rests.
    requested: bool,
    /// Time for which no flank has been needed, saturating [s].
    unneeded: T,
    /// True if the motor rested in the middle of the gap in the previous period.
    centred: bool,
}

impl<T: Real> FlankControl<T> {
    const THRESHOLDS: FlankThresholds<T> = FlankThresholds::VALUES;

    pub fn new() -> Self {
        Self {
            flank: Flank::Drive,
            stage: Stage::Touching,
            path: CrossingPath::default(),
            origin: Position::default(),
            elapsed: T::ZERO,
            landing_opening: T::ZERO,
            rise: T::ONE,
            impulse_deficit: T::ZERO,
            hysteresis: T::ONE,
            requested: true,
            unneeded: T::ZERO,
            centred: false,
        }
    }

    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// True while the motor has arrived early: it touches a flank that the demand does not ask for yet.
    pub fn arrived_early(&self) -> bool {
        self.stage == Stage::Touching && !self.requested
    }

    /// Flank that carries or is approached.
    pub fn flank(&self) -> Flank {
        self.flank
    }

    /// Resets the state while the estimates are invalid; a flank in contact becomes the flank in use.
    pub fn reset(&mut self, state: &LoopState<T>) {
        self.stage = Stage::Touching;
        self.requested = true;
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
        if self.rests_in_the_middle(tables, demand) {
            return centring_torque(tables, state);
        }
        if self.centred {
            self.flank = Flank::towards(demand.after_crossing).unwrap_or(self.flank);
        }
        let opening = self.opening(state);
        let detected = self.detect_events(tables, state, demand, opening);
        if let Some(action) = detected.events.action(self.stage) {
            self.execute(tables, state, demand, opening, action);
        }
        if self.stage == Stage::Touching {
            return self.contact_torque(tables, state, demand, detected.spring_undecided);
        }
        self.elapsed += tables.clock.period;
        self.add_impulse_deficit(tables, demand.now, demand);
        if self.stage == Stage::Landing {
            self.landing_torque(tables, state, demand)
        } else {
            self.path_torque(tables, state)
        }
    }

    /// Counts the time for which no flank has been needed. Returns true once the motor is to rest in the middle of the
    /// gap (K14).
    fn rests_in_the_middle(&mut self, tables: &CompensationTables<T>, demand: &ControlDemand<T>) -> bool {
        let required = Self::THRESHOLDS.unneeded_time * tables.rest.hunting;
        self.centred = self.unneeded >= required;
        if !(demand.needs_no_flank && self.stage == Stage::Touching) {
            self.unneeded = T::ZERO;
            return false;
        }
        self.unneeded = clamp(self.unneeded + tables.clock.period, T::ZERO, required);
        self.unneeded >= required
    }

    /// Torque while a flank carries: the torque of the law, rising after a landing, and the impulse that the link has
    /// missed (K16) [N m].
    fn contact_torque(
        &mut self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        demand: &ControlDemand<T>,
        spring_undecided: bool,
    ) -> T {
        let side: T = self.flank.sign();
        self.rise = clamp(self.rise + tables.landing.rise, T::ZERO, T::ONE);
        let recovery = self.rise * self.impulse_deficit * tables.landing.repayment;
        self.add_impulse_deficit(tables, (T::ONE - self.rise) * demand.now - recovery, demand);
        let torque = self.rise * demand.law_torque + recovery;
        self.requested |= demand.rests || side * demand.now > T::ZERO;
        // If the motor arrives early, torque of the old sign is not applied: it would push the motor off the new flank.
        let minimum = follow_link(tables, state, demand, state.transmission_error_speed);
        let stays = self.arrived_early() && !spring_undecided || side * demand.expected_start_torque > T::ZERO;
        if stays && side * (torque - minimum) < T::ZERO { minimum } else { torque }
    }

    /// Torque that closes on the flank by speed only, not by its position [N m]: a wrong width costs time, not force.
    /// The speed grows, so that a receding flank is reached.
    fn landing_torque(&self, tables: &CompensationTables<T>, state: &LoopState<T>, demand: &ControlDemand<T>) -> T {
        let speed = landing_speed(tables, demand.now) + tables.landing.acceleration * self.elapsed;
        let closing = self.flank.sign::<T>() * clamp(speed, T::ZERO, tables.landing.fastest);
        follow_link(tables, state, demand, closing)
    }

    /// Torque that moves the motor along the path (K9) [N m]. Torque acts one reaction time after its command.
    fn path_torque(&self, tables: &CompensationTables<T>, state: &LoopState<T>) -> T {
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
        opening: T,
    ) -> DetectedEvents {
        let side: T = self.flank.sign();
        let [now, ahead] =
            [demand.now, demand.after_crossing].map(|torque| side * (torque + demand.expected_start_torque));
        // Contact reported beyond the middle of the gap is ignored: teeth that just leave the near flank seem to touch
        // the far one.
        let felt = state.contact == Some(self.flank) && opening < state.half_gap;
        // A soft landing shows in the position before it shows in the force.
        let seen = opening < tables.landing.landed * state.half_gap;
        let touching = felt || seen || self.stops_the_motor(tables, state, opening);
        let carries = self.rise >= T::ONE;
        // A flank just met carries first: no change while it is felt and the torque still rises.
        let may_change = self.stage != Stage::Touching || carries || !felt;
        // In impedance mode only the flank that the spring presses is needed: below the hysteresis the spring's own
        // torque finds it.
        let spring_undecided = demand.is_impedance && now < T::ZERO && ahead < T::ZERO;
        let opens = !touching && carries && opening > tables.landing.opening * state.half_gap;
        // A motor that is not braked would strike the flank: braking comes first, unless the blow is no harder than the
        // torque to be carried, or the link is pushed harder than the teeth's limit and every moment counts.
        let may_land = self.stage != Stage::Crossing || demand.external_impact || self.is_braked(tables, state, demand);
        let events = Events::UNDERWAY
            .with(Event::DemandTurned, may_change && self.demand_turned(tables, state, now, ahead))
            .with(Event::SpringUndecided, spring_undecided)
            .with(Event::FlankLost, opens && opening > Self::THRESHOLDS.lost_opening * state.half_gap)
            .with(Event::FlankOpening, opens)
            .with(Event::FlankMet, touching && may_land)
            .with(Event::PathEnded, self.elapsed >= self.path.duration());
        DetectedEvents { events, spring_undecided }
    }

    /// True if the demand, positive towards the flank in use, changes its sign (K5), by more than the hysteresis (K13):
    /// measured demand must exceed its noise, by more soon after a flank change.
    fn demand_turned(&self, tables: &CompensationTables<T>, state: &LoopState<T>, now: T, ahead: T) -> bool {
        let switching = &tables.switching;
        let planned = now + ahead < -switching.planned && ahead < -switching.planned;
        let later = ahead + ahead - now;
        let most = switching.most_growth * state.half_gap;
        let grown = clamp(switching.measured * (self.hysteresis - T::ONE), T::ZERO, most);
        planned && later < -(switching.measured * switching.least + grown)
    }

    /// True if the flank has stopped a landing motor, wherever the estimates place the flank.
    fn stops_the_motor(&self, tables: &CompensationTables<T>, state: &LoopState<T>, opening: T) -> bool {
        let travel = self.landing_opening - opening;
        self.stage == Stage::Landing
            && self.elapsed > tables.crossing.shortest_ramp + tables.crossing.shortest_ramp
            && opening < tables.landing.opening * state.half_gap
            && travel < Self::THRESHOLDS.stopped_travel * tables.landing.speed * self.elapsed
    }

    /// True if the motor closes on the flank so slowly that the blow is no harder than the torque to be carried.
    fn is_braked(&self, tables: &CompensationTables<T>, state: &LoopState<T>, demand: &ControlDemand<T>) -> bool {
        let closing = self.flank.sign::<T>() * (state.motor_speed - state.link_speed);
        closing < T::from_i32(Self::THRESHOLDS.braked_speed) * landing_speed(tables, demand.now)
    }

    /// Executes an action.
    fn execute(
        &mut self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        demand: &ControlDemand<T>,
        opening: T,
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
                self.landing_opening = opening;
            }
            Action::Carry => self.rise = if demand.external_impact { T::ONE } else { T::ZERO },
            Action::LetSpringFind => {
                let other = self.flank.opposite();
                if state.contact == Some(other) && opening > state.half_gap {
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
        self.requested = false;
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
        let opening = self.opening(state);
        let opening_speed = self.flank.sign::<T>() * (state.link_speed - state.motor_speed);
        let braking_travel = tables.crossing.shortest_ramp * clamp(opening_speed, T::ZERO, opening_speed.abs());
        let half = clamp(T::HALF * (opening + braking_travel), T::ZERO, state.half_gap);
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
fn centring_torque<T: Real>(tables: &CompensationTables<T>, state: &LoopState<T>) -> T {
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

//! Selects the flank in use and the time of its change, and moves the motor through the gap. Assumption: without a
//! flank the link moves freely. [`transitions`](super::transitions) maps the events of a period to an action; this file
//! detects the events, executes the actions and computes the torque of each stage.
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
use crate::numbers::state_words::state_words;

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
state_words! {
    struct FlankControl<T> {
        flank, stage, path, origin, elapsed, landing_opening, rise, impulse_deficit, hysteresis, requested, unneeded,
        centred,
    }
}

impl<T: Real> FlankControl<T> {
    const THRESHOLDS: FlankThresholds<T> = FlankThresholds::TUNED;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{HALF_GAP, demand, state, tables};

    /// State with an opening of the drive flank, over the half-gap, without contact.
    fn open(opening: f64) -> LoopState<f64> {
        LoopState { gap: HALF_GAP * (1.0 - opening), contact: None, teeth_open: true, ..state() }
    }

    /// Control in a stage, on the drive flank.
    fn control(stage: Stage) -> FlankControl<f64> {
        FlankControl { stage, ..FlankControl::new() }
    }

    #[test]
    fn demand_of_the_other_sign_crosses() {
        let mut flank = control(Stage::Touching);
        flank.step(&tables(), &state(), &demand(1.0, -3.0));
        assert_eq!((flank.flank(), flank.stage()), (Flank::Back, Stage::Crossing));
    }

    #[test]
    fn zero_of_the_demand_in_the_middle_of_the_crossing_decides() {
        let tables = tables();
        let turned = |now, ahead| control(Stage::Touching).demand_turned(&tables, &state(), now, ahead);
        assert!(turned(1.0, -1.1) && !turned(1.0, -0.9));
    }

    #[test]
    fn demand_within_the_hysteresis_stays() {
        let tables = tables();
        // 0.3 M = 0.06 N m bounds twice the demand ahead less the demand now.
        let turned = |ahead| control(Stage::Touching).demand_turned(&tables, &state(), 0.0, ahead);
        assert!(!turned(-0.049) && turned(-0.051), "planned");
        let turned = |now, ahead| control(Stage::Touching).demand_turned(&tables, &state(), now, ahead);
        assert!(!turned(-0.05, -0.0549) && turned(-0.05, -0.0551), "measured");
    }

    #[test]
    fn demand_on_the_back_flank_mirrors() {
        let mut flank = FlankControl { flank: Flank::Back, ..control(Stage::Touching) };
        let touching = LoopState { gap: -HALF_GAP, contact: Some(Flank::Back), ..state() };
        flank.step(&tables(), &touching, &demand(-1.0, 3.0));
        assert_eq!(flank.flank(), Flank::Drive);
    }

    #[test]
    fn demand_that_is_no_number_stays() {
        assert!(!control(Stage::Touching).demand_turned(&tables(), &state(), f64::NAN, -3.0));
        assert!(!control(Stage::Touching).demand_turned(&tables(), &state(), 1.0, f64::NAN));
    }

    #[test]
    fn each_change_grows_the_hysteresis_to_its_limit() {
        let (tables, mut flank) = (tables(), control(Stage::Touching));
        let factors = [(); 3].map(|()| {
            flank.start_crossing(&tables, &state(), &demand(1.0, -3.0), Stage::Touching);
            flank.hysteresis
        });
        assert_eq!(factors, [4.0, 6.0, 6.0]);
    }

    #[test]
    fn grown_hysteresis_asks_for_more_demand() {
        let tables = tables();
        let grown = FlankControl { hysteresis: 4.0, ..control(Stage::Touching) };
        // 0.3 M and three times M: 0.66 N m.
        let turned = |ahead: f64| grown.demand_turned(&tables, &state(), 0.0, ahead);
        assert!(!turned(-0.32) && turned(-0.34));
    }

    #[test]
    fn growth_is_bounded_in_a_narrow_gap() {
        let tables = tables();
        let grown = FlankControl { hysteresis: 4.0, ..control(Stage::Touching) };
        // 0.3 K h = 0.036 N m at a twentieth of the gap.
        let narrow = LoopState { half_gap: 1e-4, ..state() };
        assert!(grown.demand_turned(&tables, &narrow, 0.0, -0.051));
    }

    #[test]
    fn hysteresis_decays_twice_as_fast_without_a_load() {
        let left = |rests_unloaded| {
            let mut flank = FlankControl { hysteresis: 2.0, ..control(Stage::Touching) };
            flank.step(&tables(), &state(), &ControlDemand { rests_unloaded, ..demand(1.0, 1.0) });
            flank.hysteresis - 1.0
        };
        assert!((left(false) - 0.99).abs() < 1e-12 && (left(true) - 0.99 * 0.99).abs() < 1e-12);
    }

    #[test]
    fn flank_that_opens_is_landed_on() {
        let stage = |opening| {
            let mut flank = control(Stage::Touching);
            flank.step(&tables(), &open(opening), &demand(1.0, 1.0));
            flank.stage()
        };
        assert_eq!([0.29, 0.31, 0.49].map(stage), [Stage::Touching, Stage::Landing, Stage::Landing]);
    }

    #[test]
    fn flank_lost_beyond_half_the_half_gap_is_crossed_back_to() {
        let mut flank = control(Stage::Touching);
        flank.step(&tables(), &open(0.51), &demand(1.0, 1.0));
        assert_eq!((flank.flank(), flank.stage()), (Flank::Drive, Stage::Crossing));
    }

    #[test]
    fn path_that_ends_early_is_followed_by_a_landing() {
        let mut flank = control(Stage::Crossing);
        flank.elapsed = 1.0;
        flank.step(&tables(), &open(1.0), &demand(1.0, 1.0));
        assert_eq!(flank.stage(), Stage::Landing);
    }

    #[test]
    fn flank_met_carries_with_rising_torque() {
        let mut flank = control(Stage::Landing);
        let torques = [(); 3].map(|()| flank.step(&tables(), &state(), &demand(4.0, 4.0)));
        assert_eq!((flank.stage(), torques), (Stage::Touching, [2.0, 4.0, 4.0]));
    }

    #[test]
    fn pushed_link_gets_the_whole_torque_at_once() {
        let mut flank = control(Stage::Landing);
        let torque = flank.step(&tables(), &state(), &ControlDemand { external_impact: true, ..demand(4.0, 4.0) });
        assert_eq!(torque, 4.0);
    }

    #[test]
    fn opening_below_the_observer_error_is_a_contact() {
        let stage = |opening| {
            let mut flank = control(Stage::Landing);
            flank.step(&tables(), &open(opening), &demand(1.0, 1.0));
            flank.stage()
        };
        assert_eq!([0.029, 0.031].map(stage), [Stage::Touching, Stage::Landing]);
    }

    #[test]
    fn contact_beyond_the_middle_of_the_gap_is_ignored() {
        let mut flank = control(Stage::Landing);
        let far = LoopState { contact: Some(Flank::Drive), ..open(1.1) };
        flank.step(&tables(), &far, &demand(1.0, 1.0));
        assert_eq!(flank.stage(), Stage::Landing);
    }

    #[test]
    fn motor_that_is_not_braked_does_not_meet_its_flank() {
        let stage = |speed| {
            let mut flank = control(Stage::Crossing);
            // A path that has not ended and that no shorter one replaces.
            flank.path = CrossingPath::new([0.0; 2], [0.0; 2], CrossingTiming { duration: 1e-3, ramp: 1e-4 });
            flank.elapsed = 0.0;
            flank.step(&tables(), &LoopState { motor_speed: speed, ..state() }, &demand(1.0, 1.0));
            flank.stage()
        };
        // Four landing speeds of 0.02 rad/s.
        assert_eq!([0.079, 0.081].map(stage), [Stage::Touching, Stage::Crossing]);
    }

    #[test]
    fn landing_motor_that_stands_has_met_its_flank() {
        let (tables, mut flank) = (tables(), control(Stage::Landing));
        (flank.elapsed, flank.landing_opening) = (17e-3, 0.2 * HALF_GAP);
        assert!(flank.stops_the_motor(&tables, &open(0.2), 0.2 * HALF_GAP));
        assert!(!flank.stops_the_motor(&tables, &open(0.2), 0.31 * HALF_GAP), "too far from the flank");
        flank.elapsed = 15e-3;
        assert!(!flank.stops_the_motor(&tables, &open(0.2), 0.2 * HALF_GAP), "too early");
    }

    #[test]
    fn landing_speed_follows_the_demand_within_its_bounds() {
        assert_eq!([0.0, 1.0, -5.0, 50.0].map(|demand| landing_speed(&tables(), demand)), [0.02, 0.02, 0.05, 0.1]);
    }

    #[test]
    fn missed_impulse_counts_in_impedance_mode_only() {
        for (is_impedance, deficit) in [(true, 3e-3), (false, 0.0)] {
            let mut flank = control(Stage::Landing);
            flank.step(&tables(), &open(0.5), &ControlDemand { is_impedance, ..demand(3.0, 3.0) });
            assert_eq!(flank.impulse_deficit, deficit);
        }
    }

    #[test]
    fn missed_impulse_is_bounded() {
        let mut flank = control(Stage::Landing);
        flank.impulse_deficit = 100.0;
        flank.add_impulse_deficit(&tables(), 1.0, &ControlDemand { is_impedance: true, ..demand(1.0, 1.0) });
        assert_eq!(flank.impulse_deficit, 10.0 * 60e-3);
    }

    #[test]
    fn motor_that_arrived_early_gets_no_torque_of_the_old_sign() {
        let mut flank = FlankControl { requested: false, ..control(Stage::Touching) };
        assert_eq!(flank.step(&tables(), &state(), &demand(-0.01, 0.0)), 0.0);
        assert!(flank.arrived_early());
        assert_eq!(flank.step(&tables(), &state(), &demand(0.5, 0.5)), 0.5);
        assert!(!flank.arrived_early());
    }

    #[test]
    fn joint_that_needs_no_flank_rests_in_the_middle() {
        let (tables, mut flank) = (tables(), control(Stage::Touching));
        let idle = ControlDemand { needs_no_flank: true, rests: true, ..demand(0.0, 0.0) };
        // Half of the 1.5 s.
        (0..749).for_each(|_| assert_eq!(flank.step(&tables, &state(), &idle), 0.0));
        (0..2).for_each(|_| _ = flank.step(&tables, &state(), &idle));
        assert_eq!(flank.step(&tables, &state(), &idle), -100.0 * HALF_GAP);
        flank.step(&tables, &state(), &demand(1.0, 1.0));
        assert_eq!(flank.unneeded, 0.0);
    }

    #[test]
    fn reset_takes_the_flank_in_contact() {
        let mut flank = FlankControl { impulse_deficit: 1.0, ..control(Stage::Crossing) };
        flank.reset(&LoopState { contact: Some(Flank::Back), ..state() });
        assert_eq!((flank.flank(), flank.stage(), flank.impulse_deficit), (Flank::Back, Stage::Touching, 0.0));
        flank.reset(&open(1.0));
        assert_eq!(flank.flank(), Flank::Back, "without contact the flank stays");
    }

    #[test]
    fn undecided_spring_takes_the_far_flank_that_is_felt() {
        let touched = |opening| {
            let mut flank = control(Stage::Landing);
            let far = LoopState { contact: Some(Flank::Back), ..open(opening) };
            flank.step(&tables(), &far, &ControlDemand { is_impedance: true, ..demand(-0.01, -0.01) });
            flank.flank()
        };
        assert_eq!([0.9, 1.1].map(touched), [Flank::Drive, Flank::Back]);
    }

    #[test]
    fn landing_motor_slower_than_half_the_landing_speed_is_stopped() {
        let flank = FlankControl { elapsed: 20e-3, landing_opening: 0.25 * HALF_GAP, ..control(Stage::Landing) };
        // Half of 0.02 rad/s for 20 ms: a tenth of the half-gap.
        let stopped = |opening| flank.stops_the_motor(&tables(), &open(0.2), opening * HALF_GAP);
        assert!(stopped(0.16) && !stopped(0.14));
    }

    /// Path over 0.01 rad in 40 ms with ramps of 10 ms: its steady speed is 1/3 rad/s.
    fn on_the_way(elapsed: f64) -> FlankControl<f64> {
        let path = CrossingPath::new([0.0, 0.0], [0.01, 0.0], CrossingTiming { duration: 40e-3, ramp: 10e-3 });
        FlankControl { path, elapsed, ..control(Stage::Crossing) }
    }

    #[test]
    fn path_torque_leads_by_the_reaction_time() {
        // 3 ms on: 0.0765 mrad and 0.072 rad/s; half a ramp on, where the torque acts: 50 rad/s^2.
        let behind = LoopState { motor_position: 76.5e-6 - 0.01, motor_speed: 0.072 - 0.1, ..state() };
        let torque = on_the_way(3e-3).path_torque(&tables(), &behind);
        assert!((torque - (50.0 + 100.0 * 0.01 + 20.0 * 0.1)).abs() < 1e-9, "{torque}");
    }

    #[test]
    fn path_is_shortened_by_a_fifth_of_what_is_left() {
        let (tables, state, demand) = (tables(), open(0.5), demand(1.0, 3.0));
        let mut shorter = on_the_way(0.0);
        let rest = shorter.remaining_crossing(&tables, &state, &demand).duration;
        for (left, is_shortened) in [(1.24 * rest, false), (1.26 * rest, true)] {
            shorter = on_the_way(40e-3 - left);
            let opening = shorter.opening(&state);
            shorter.execute(&tables, &state, &demand, opening, Action::Shorten);
            assert_eq!(shorter.path.duration() == rest, is_shortened, "{left} {rest}");
        }
    }

    #[test]
    fn path_ends_at_the_flank_of_the_free_link() {
        let crossing = CrossingTiming { duration: 38e-3, ramp: 10e-3 };
        let moving = LoopState { link_speed: 0.5, error: 1e-3, ..state() };
        let free = ControlDemand { free_acceleration: 10.0, free_jerk: 300.0, ..demand(1.0, 3.0) };
        let mut flank = control(Stage::Crossing);
        flank.plan_path(&tables(), &moving, &free, crossing, [0.0, 0.0]);
        // In 40 ms the link travels 20 + 8 + 3.2 mrad and reaches 0.5 + 0.4 + 0.24 rad/s; it lands at 30 mrad/s.
        let [place, speed, _] = flank.path.at(crossing.duration);
        assert!((place - (31.2e-3 - 1e-3 + HALF_GAP)).abs() < 1e-12, "{place}");
        assert!((speed - (1.14 + 0.03)).abs() < 1e-12, "{speed}");
    }
}

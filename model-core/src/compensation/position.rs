//! Control law of position mode: spring and damper on the link, damper on the motor, feed-forward of acceleration and
//! load. The load estimate replaces an integral.
//!
//! ```text
//! (K1)   torque = J a + L + f dir + losses + K e + D (v - w_l) + D_m (w_l + v_e - w_m)
//! (K4)   demand(time) = J_l a + L + f dir + K e + D (v - w_l), extrapolated by time
//! (K15)  deadband: 0.05 h, reached in 1 s;   2 deadband + 0.05 h, at most h/2, at each flank change within 15/w
//! ```
//!
//! | symbol | identifier |
//! |---|---|
//! | J a + L + f dir | `feedforward` |
//! | v, a | `now.speed`, `now.acceleration`; a of an early braked link: `approach.acceleration` |
//! | L, f dir | `load.gravity_torque()`, `load.planned_friction()` |
//! | e, K e, D (v - w_l) | `feedback.error`, `feedback.spring`, `feedback.damper` |
//! | D_m term, losses | `state.damping_torque()`, `state.loss_torque()` |
//! | measured part of the demand | `measured_demand` |

use super::braking::{Approach, BrakingLimit, SetPointMotion, TrackingError};
use super::control_demand::ControlDemand;
use super::easing::Easing;
use super::limit::{limit_mesh_torque, mesh_torque, mesh_torque_limit};
use super::load::LoadModel;
use super::loop_state::LoopState;
use super::set_point::Motion;
use super::start_prediction::StartPrediction;
use super::thresholds::PositionThresholds;
use crate::compensation::tables::CompensationTables;
use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::numbers::arithmetic::{clamp, deadband};
use crate::numbers::state_words::state_words;

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
state_words! {
    struct PositionLaw<T> {
        last_acceleration, deadband, requested_flank, time_since_request, measured_demand, start, easing,
        acceleration_step, peak_acceleration,
    }
}

/// Changes of the set-point within a time: by the preview or, without a preview, by the jerk.
#[derive(Debug, Clone, Copy)]
struct SetPointTrend<T: Real> {
    /// Change of the speed [rad/s]; zero without a preview.
    speed: T,
    /// Change of the acceleration [rad/s^2].
    acceleration: T,
    /// Time within which the set-point changes, never zero [s].
    time: T,
    /// True if the changes are known by a preview.
    previewed: bool,
}

/// Torques of spring and damper on the link.
#[derive(Debug, Clone, Copy)]
struct Feedback<T: Real> {
    /// Position error (set-point minus link) that exceeds the dead band [rad].
    error: T,
    /// Approach that replaces the linear law, if the motor could not brake the link otherwise.
    approach: Option<Approach<T>>,
    /// Torque of the spring [N m].
    spring: T,
    /// Torque of the damper [N m].
    damper: T,
}

/// Torque of the law, and the part of it that is lost between motor and load.
#[derive(Debug, Clone, Copy)]
struct LawTorque<T: Real> {
    /// Torque of the motor [N m].
    motor: T,
    /// Friction, bias and gear losses in `motor` [N m].
    losses: T,
}

impl<T: Real> PositionLaw<T> {
    const THRESHOLDS: PositionThresholds<T> = PositionThresholds::TUNED;

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

    /// Part of the position error that exceeds the dead band [rad].
    pub fn error_beyond_deadband(&self, state: &LoopState<T>) -> T {
        deadband(state.error, self.deadband)
    }

    /// Computes the demand of a set-point. `ahead` is the set-point after [`CrossingTable::lead`], if known.
    ///
    /// [`CrossingTable::lead`]: crate::compensation::tables::CrossingTable::lead
    pub fn demand(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        state: &LoopState<T>,
        now: &Motion<T>,
        ahead: Option<&Motion<T>>,
    ) -> ControlDemand<T> {
        let trend = self.trend(tables, now, ahead);
        let rests = now.speed == T::ZERO
            && now.acceleration == T::ZERO
            && (!trend.previewed || [trend.speed, trend.acceleration] == [T::ZERO; 2]);
        let set_point = self.motion_ahead(tables, now, &trend, rests);
        let braking = BrakingLimit::new(tables, load, state);
        let feedback = self.feedback(tables, state, &braking, &set_point, rests);

        let acceleration = feedback.approach.map_or(now.acceleration, |approach| approach.acceleration);
        let feedforward = self.feedforward(tables, load, state, acceleration, now.speed, rests);
        let useful = feedforward + feedback.spring + feedback.damper;
        let torque = law_torque(tables, load, state, now.speed, useful);

        self.follow_measured_demand(tables, load, now.speed, &feedback, trend.previewed);
        let tracking = feedback.approach.map(|_| {
            let useful = clamp(torque.motor - torque.losses, -tables.limits.motor, tables.limits.motor);
            let acceleration = now.acceleration - braking.acceleration(tables, load, state, useful);
            TrackingError { error: feedback.error, rate: state.error_rate, acceleration }
        });
        let demand = |time: T| match &tracking {
            None => planned_demand(tables, load, now, &trend, time) + self.measured_demand + time * load.gravity_rate(),
            Some(tracking) => braking.demand(tables, load, tracking, &set_point, time),
        };
        let demand = ControlDemand::new(tables, load, state, torque.motor, demand, false);

        // A joint that carries a load is not idle: the loaded flank is kept.
        let rests_unloaded = rests && deadband(load.gravity_torque(), tables.switching.measured) == T::ZERO;
        let expected_start_torque = self.expected_start_torque(tables, load, state, now, &trend, rests);
        let requested = deadband(demand.after_crossing, tables.switching.measured * tables.switching.least);
        self.update_deadband(tables, rests, rests_unloaded, requested, state.half_gap);
        ControlDemand {
            rests_unloaded,
            rests,
            needs_no_flank: rests_unloaded
                && self.start.friction_holds(tables)
                && expected_start_torque == T::ZERO
                && feedback.error == T::ZERO,
            external_impact: load.external_impact(tables),
            brakes_early: feedback.approach.is_some(),
            expected_start_torque,
            ..demand
        }
    }

    /// Changes of the set-point: by the preview or, without a preview, by the smoothed jerk.
    fn trend(
        &mut self,
        tables: &CompensationTables<T>,
        now: &Motion<T>,
        ahead: Option<&Motion<T>>,
    ) -> SetPointTrend<T> {
        let last = self.last_acceleration.replace(now.acceleration);
        if let Some(ahead) = ahead {
            return SetPointTrend {
                speed: ahead.speed - now.speed,
                acceleration: ahead.acceleration - now.acceleration,
                time: tables.crossing.lead,
                previewed: true,
            };
        }
        let step = last.map_or(T::ZERO, |last| now.acceleration - last);
        self.acceleration_step += T::from_i32(Self::THRESHOLDS.jerk_smoothing_ratio)
            * tables.switching.smoothing
            * (step - self.acceleration_step);
        SetPointTrend {
            speed: T::ZERO,
            acceleration: self.acceleration_step,
            time: tables.clock.period,
            previewed: false,
        }
    }

    /// Motion of the set-point, now and at the end of a crossing. Without a preview the acceleration stays within the
    /// largest acceleration since the last rest.
    fn motion_ahead(
        &mut self,
        tables: &CompensationTables<T>,
        now: &Motion<T>,
        trend: &SetPointTrend<T>,
        rests: bool,
    ) -> SetPointMotion<T> {
        let peak = if rests { T::ZERO } else { self.peak_acceleration };
        let present = now.acceleration.abs();
        self.peak_acceleration = if present > peak { present } else { peak };
        let ahead = now.acceleration + (tables.crossing.lead / trend.time) * trend.acceleration;
        let ahead = if trend.previewed { ahead } else { clamp(ahead, -self.peak_acceleration, self.peak_acceleration) };
        SetPointMotion { speed: now.speed, acceleration: now.acceleration, ahead }
    }

    /// Spring and damper on the link; the spring closes no faster than the motor can brake (K12).
    fn feedback(
        &self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        braking: &BrakingLimit<T>,
        set_point: &SetPointMotion<T>,
        rests: bool,
    ) -> Feedback<T> {
        let error = deadband(state.error, if rests { self.deadband } else { T::ZERO });
        let approach = braking.approach(error, set_point);
        let spring = approach.map_or(tables.law.position * error, |approach| tables.law.damping * approach.closing);
        Feedback { error, approach, spring, damper: tables.law.damping * state.error_rate }
    }

    /// Torque of acceleration and load before losses [N m].
    fn feedforward(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        state: &LoopState<T>,
        acceleration: T,
        speed: T,
        rests: bool,
    ) -> T {
        let friction_holds = self.start.friction_holds(tables);
        (tables.body.load_inertia + tables.body.motor_inertia) * acceleration
            + self.easing.step(tables, load, state, rests, friction_holds) * load.gravity_torque()
            + load.planned_friction(tables, speed)
    }

    /// Smooths the measured part of the demand. Changes that are large against the noise are followed faster. With a
    /// preview the planned demand is known early, so the measured demand is smoothed longer: teeth that oscillate about
    /// a small torque at the mesh frequency must not make the motor leave at a peak and return at once.
    fn follow_measured_demand(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        speed: T,
        feedback: &Feedback<T>,
        previewed: bool,
    ) {
        let measured = load.gravity_torque()
            + (load.friction_torque() - load.planned_friction(tables, speed))
            + feedback.spring
            + feedback.damper;
        self.measured_demand += tables.clock.period * load.gravity_rate();
        let change = measured - self.measured_demand;
        let relative = tables.switching.inverse_step * change;
        let smoothing = if previewed {
            (T::ONE - Self::THRESHOLDS.preview_smoothing_cut) * tables.switching.smoothing
        } else {
            tables.switching.smoothing
        };
        let faster = clamp(relative * relative, T::ONE, tables.clock.rate);
        self.measured_demand += clamp(smoothing * faster, T::ZERO, Self::THRESHOLDS.max_smoothing) * change;
    }

    /// Predicted torque of the next start of a joint at rest, without a preview [N m].
    fn expected_start_torque(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        state: &LoopState<T>,
        now: &Motion<T>,
        trend: &SetPointTrend<T>,
        rests: bool,
    ) -> T {
        let direction = if now.speed == T::ZERO { now.acceleration } else { now.speed };
        let flank = self.start.step(tables, state, direction, rests);
        if trend.previewed { T::ZERO } else { sign::<T>(flank) * load.start_torque(tables) }
    }

    /// Opens the first dead band while a joint rests without a load (K15): an error treated as friction lasts for
    /// seconds, and correcting it later costs a crossing. A request for the opposite flank soon after the last request
    /// widens the dead band, because only a hunting loop causes such requests, no load. The dead band decays slowly,
    /// and closes at once when the joint is to move.
    fn update_deadband(
        &mut self,
        tables: &CompensationTables<T>,
        rests: bool,
        rests_unloaded: bool,
        requested: T,
        half_gap: T,
    ) {
        self.time_since_request = clamp(self.time_since_request + tables.clock.period, T::ZERO, tables.rest.hunting);
        if !rests {
            self.deadband = T::ZERO;
            self.requested_flank = None;
            return;
        }
        let first = tables.rest.first_deadband * half_gap;
        let opened = self.deadband + Self::THRESHOLDS.deadband_opening_rate * tables.clock.period * first;
        let decayed = tables.rest.deadband_left * self.deadband;
        self.deadband = if rests_unloaded { clamp(first, decayed, opened) } else { T::ZERO };
        let flank = Flank::towards(requested);
        if flank.is_some_and(|flank| self.requested_flank == Some(flank.opposite())) {
            if self.time_since_request < tables.rest.hunting {
                let grown = self.deadband + self.deadband + first;
                self.deadband = clamp(grown, T::ZERO, tables.rest.largest_deadband * half_gap);
            }
            self.time_since_request = T::ZERO;
        }
        self.requested_flank = flank.or(self.requested_flank);
    }
}

/// Torque of the law for a torque after losses, limited by motor and teeth (K11). Torque beyond the limits must not
/// outweigh the damper on the motor, which is added after the limits.
fn law_torque<T: Real>(
    tables: &CompensationTables<T>,
    load: &LoadModel<T>,
    state: &LoopState<T>,
    speed: T,
    useful: T,
) -> LawTorque<T> {
    let unlimited = mesh_torque(tables, load.free_load_torque(), useful);
    let teeth_limit = mesh_torque_limit(tables, useful);
    let external_impact = load.external_impact(tables);
    let bound = if external_impact { unlimited.abs() } else { teeth_limit };
    let transmitted = clamp(unlimited, -bound, bound);
    let useful = useful - tables.body.inverse_load_share * (unlimited - transmitted);
    let motor_limit = if external_impact {
        (T::ONE + PositionLaw::<T>::THRESHOLDS.impact_excess_torque) * tables.limits.motor
    } else {
        tables.limits.motor
    };
    let planned = useful + state.loss_torque(tables, speed, transmitted);
    let damped = clamp(planned, -motor_limit, motor_limit) + state.damping_torque(tables);
    let losses = state.loss_torque(tables, state.link_speed, transmitted);
    LawTorque { motor: limit_mesh_torque(tables, load, state, damped - losses, teeth_limit) + losses, losses }
}

/// Planned part of the demand after a time (K4) [N m].
fn planned_demand<T: Real>(
    tables: &CompensationTables<T>,
    load: &LoadModel<T>,
    now: &Motion<T>,
    trend: &SetPointTrend<T>,
    time: T,
) -> T {
    let part = time / trend.time;
    let speed = if trend.previewed {
        now.speed + part * trend.speed
    } else {
        now.speed + time * (now.acceleration + T::HALF * part * trend.acceleration)
    };
    tables.body.load_inertia * (now.acceleration + part * trend.acceleration) + load.planned_friction(tables, speed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{HALF_GAP, q1, state, tables};

    fn motion(speed: f64, acceleration: f64) -> Motion<f64> {
        Motion { speed, acceleration, ..Motion::default() }
    }

    fn unloaded() -> LoadModel<f64> {
        LoadModel::of_known(0.0, 0.0)
    }

    /// First dead band in the state [rad].
    const FIRST: f64 = 0.05 * HALF_GAP;

    #[test]
    fn dead_band_opens_within_a_second_of_rest() {
        let (tables, mut law) = (tables(), PositionLaw::new());
        let deadbands = [500, 499, 10].map(|periods| {
            (0..periods).for_each(|_| law.update_deadband(&tables, true, true, 0.0, HALF_GAP));
            law.deadband / FIRST
        });
        assert!((deadbands[0] - 0.5).abs() < 1e-9 && deadbands[1] < 1.0 && deadbands[2] == 1.0, "{deadbands:?}");
    }

    #[test]
    fn dead_band_closes_with_a_load_or_a_motion() {
        let (tables, mut law) = (tables(), PositionLaw::new());
        for (rests, unloaded) in [(true, false), (false, false)] {
            law.deadband = FIRST;
            law.update_deadband(&tables, rests, unloaded, 0.0, HALF_GAP);
            assert_eq!(law.deadband, 0.0);
        }
    }

    #[test]
    fn requests_for_both_flanks_widen_the_dead_band() {
        let (tables, mut law) = (tables(), PositionLaw::new());
        let deadbands = [1.0, -1.0, 1.0, -1.0, 1.0].map(|requested| {
            law.update_deadband(&tables, true, true, requested, HALF_GAP);
            (law.deadband / FIRST).round()
        });
        assert_eq!(deadbands, [0.0, 1.0, 3.0, 7.0, 10.0], "at most half of the half-gap");
    }

    #[test]
    fn requests_for_one_flank_do_not_widen_the_dead_band() {
        let (tables, mut law) = (tables(), PositionLaw::new());
        (0..5).for_each(|_| law.update_deadband(&tables, true, true, 1.0, HALF_GAP));
        assert!(law.deadband < 0.01 * FIRST);
    }

    #[test]
    fn late_request_does_not_widen_the_dead_band() {
        let (tables, mut law) = (tables(), PositionLaw::new());
        law.update_deadband(&tables, true, true, 1.0, HALF_GAP);
        (0..1600).for_each(|_| law.update_deadband(&tables, true, true, 0.0, HALF_GAP));
        law.update_deadband(&tables, true, true, -1.0, HALF_GAP);
        assert!((law.deadband / FIRST - 1.0).abs() < 1e-9);
    }

    #[test]
    fn error_within_the_dead_band_asks_for_nothing() {
        let law = PositionLaw { deadband: FIRST, ..PositionLaw::new() };
        let excess = |error: f64| law.error_beyond_deadband(&LoopState { error, ..state() });
        assert_eq!([excess(FIRST), excess(-FIRST), excess(0.0)], [0.0; 3]);
        assert!((excess(-3.0 * FIRST) + 2.0 * FIRST).abs() < 1e-15);
    }

    #[test]
    fn law_of_a_still_joint_is_its_spring() {
        let (tables, state) = (tables(), LoopState { error: 1e-3, mesh_torque: 1.0, ..state() });
        let demand = PositionLaw::new().demand(&tables, &unloaded(), &state, &motion(0.0, 0.0), None);
        assert!((demand.law_torque - 1.2).abs() < 1e-12);
    }

    #[test]
    fn law_holds_the_load() {
        let (tables, state) = (tables(), LoopState { mesh_torque: 3.0, ..state() });
        let load = LoadModel::of_known(3.0, 0.0);
        let demand = PositionLaw::new().demand(&tables, &load, &state, &motion(0.0, 0.0), None);
        assert!((demand.law_torque - 3.0).abs() < 1e-12);
    }

    #[test]
    fn damper_opposes_a_link_faster_than_its_set_point() {
        let (tables, state) = (tables(), LoopState { error_rate: -0.01, mesh_torque: -1.0, ..state() });
        let demand = PositionLaw::new().demand(&tables, &unloaded(), &state, &motion(0.0, 0.0), None);
        assert!((demand.law_torque + 1.2).abs() < 1e-12);
    }

    #[test]
    fn previewed_reversal_is_demanded_ahead() {
        let tables = tables();
        let demand = |ahead: Option<&Motion<f64>>| {
            PositionLaw::new().demand(&tables, &unloaded(), &state(), &motion(0.1, 1.0), ahead)
        };
        let [blind, previewed] = [demand(None), demand(Some(&motion(0.1, -1.0)))];
        assert!(blind.after_crossing > 0.0 && previewed.after_crossing < 0.0);
        assert_eq!(blind.now, previewed.now);
    }

    #[test]
    fn acceleration_ahead_stays_within_the_largest_since_the_rest() {
        let (tables, mut law) = (tables(), PositionLaw::new());
        let trend = |previewed| SetPointTrend { speed: 0.0, acceleration: -1.0, time: 1e-3, previewed };
        assert_eq!(law.motion_ahead(&tables, &motion(0.1, 2.0), &trend(false), false).ahead, -2.0);
        assert_eq!(law.motion_ahead(&tables, &motion(0.1, 2.0), &trend(true), false).ahead, 2.0 - 22.0);
        law.motion_ahead(&tables, &motion(0.0, 0.0), &trend(false), true);
        assert_eq!(law.peak_acceleration, 0.0);
    }

    #[test]
    fn measured_demand_follows_slower_with_a_preview() {
        let followed = |previewed| {
            let mut law = PositionLaw::new();
            let feedback = Feedback { error: 0.0, approach: None, spring: 0.1, damper: 0.0 };
            law.follow_measured_demand(&tables(), &unloaded(), 0.0, &feedback, previewed);
            law.measured_demand
        };
        assert!((followed(false) - 0.003).abs() < 1e-12 && (followed(true) - 0.002).abs() < 1e-12);
    }

    #[test]
    fn large_change_of_the_measured_demand_is_followed_by_half() {
        let mut law = PositionLaw::new();
        let feedback = Feedback { error: 0.0, approach: None, spring: 8.0, damper: 0.0 };
        law.follow_measured_demand(&tables(), &unloaded(), 0.0, &feedback, false);
        assert_eq!(law.measured_demand, 4.0);
    }

    #[test]
    fn loaded_joint_at_rest_keeps_its_flank() {
        let rests_unloaded = |gravity_torque: f64| {
            let load = LoadModel::of_known(gravity_torque, 0.0);
            let demand = PositionLaw::new().demand(&tables(), &load, &state(), &motion(0.0, 0.0), None);
            (demand.rests, demand.rests_unloaded)
        };
        assert_eq!([0.19, 0.21].map(rests_unloaded), [(true, true), (true, false)]);
    }

    #[test]
    fn law_exceeds_the_motor_limit_only_under_a_push() {
        let mut estimates = crate::observer::Estimates::default();
        (estimates.load_torque.value, estimates.load_torque.valid) = (9.0, true);
        let mut pushed = LoadModel::of_known(0.0, 0.0);
        pushed.update(&tables(), &estimates, &state(), true);
        let held = LoopState { mesh_torque: 8.0, ..state() };
        let torque = |load: &LoadModel<f64>| law_torque(&tables(), load, &held, 0.0, 50.0).motor;
        assert!(torque(&unloaded()) <= 10.0 + 1e-12);
        assert_eq!(torque(&pushed), 12.5);
    }

    #[test]
    fn damper_on_the_motor_is_added_after_the_limit() {
        let closing = LoopState { mesh_torque: 8.0, motor_speed: 0.1, ..state() };
        let torque = law_torque(&tables(), &unloaded(), &closing, 0.0, 50.0);
        assert!(torque.motor < 8.7, "{}", torque.motor);
    }

    #[test]
    fn request_within_250_ms_is_hunting() {
        let tables = q1();
        let deadband = |periods: u32| {
            let mut law = PositionLaw::new();
            law.update_deadband(&tables, true, true, 1.0, HALF_GAP);
            (1..periods).for_each(|_| law.update_deadband(&tables, true, true, 0.0, HALF_GAP));
            law.update_deadband(&tables, true, true, -1.0, HALF_GAP);
            law.deadband / FIRST
        };
        // Periods of 0.1 ms; a request for the opposite flank widens the dead band, which opens within a second.
        assert!(deadband(2400) > 1.0 && deadband(2600) < 0.5, "{} {}", deadband(2400), deadband(2600));
    }

    #[test]
    fn dead_band_ends_at_half_of_half_gap() {
        let (tables, mut law) = (q1(), PositionLaw::new());
        [1.0, -1.0].repeat(5).iter().for_each(|side| law.update_deadband(&tables, true, true, *side, HALF_GAP));
        assert!((law.deadband - 0.5 * HALF_GAP).abs() < 1e-9, "{}", law.deadband);
    }

    #[test]
    fn grown_dead_band_decays_in_30_seconds() {
        let (tables, mut law) = (q1(), PositionLaw { deadband: 8.0 * FIRST, ..PositionLaw::new() });
        // 0.3 s leave exp(-0.01).
        (0..3000).for_each(|_| law.update_deadband(&tables, true, true, 0.0, HALF_GAP));
        assert!((law.deadband / (8.0 * FIRST) - 0.99).abs() < 1e-3, "{}", law.deadband / FIRST);
    }

    #[test]
    fn jerk_is_followed_eight_times_faster() {
        let (tables, mut law) = (tables(), PositionLaw::new());
        let steps = [0.0, 1.0].map(|acceleration| law.trend(&tables, &motion(0.0, acceleration), None).acceleration);
        // The measured demand follows 3 % of a change in a period.
        assert!(steps[0] == 0.0 && (steps[1] - 0.24).abs() < 1e-12, "{steps:?}");
    }
}

//! Control of the motor with an adaptive inverse of the backlash (Tao, Kokotovic 1996): while both shafts are seen but
//! the gap is unknown, and after a loop has hunted. Of the link only a slow mean is used, so that no mode of a payload
//! is fed back. The link is damped only if the motor swings against the delays of the loop. The observer's half-gap and
//! offset replace an edge that the demand has not pressed yet; the observer's compliance gives the wind-up.
//!
//! ```text
//! (K18)  u = k_J J a + J_m s'' + K (r + s - theta_m) + D (v + s' - w_m) + f sign(v) + u_i
//!        u_i' = J w^3 (r + s - theta_m)
//! (K21)  p follows d/(pressing demand) through a play of +-1, within [-1, 1]
//!        s -> (drive + back)/2 + 0.75 p (drive - back)/2 + d/S,   double pole at 3 w
//! ```
//!
//! | symbol, referred to the link | identifier |
//! |---|---|
//! | u, u_i | `torque()`, `integral` |
//! | s, s'; its target | `shift`; `target_shift` |
//! | p, from -1 (back flank) to 1 (drive flank) | `share` |
//! | drive, back | `edges` |
//! | k_J, f, d | `demand`, estimated from the torque |
//! | S | `state.stiffness` |
//!
//! - The play keeps noise about zero demand from moving the motor. While only one edge is known, 1 replaces 0.75.
//! - Each edge is the mean of motor less link, less wind-up, while the demand presses that flank and the torque reaches
//!   the teeth.
//! - A link that leaves the pressed flank and lags on the other side moves to the other flank: p jumps there, and the
//!   load is estimated anew.

use super::demand_estimator::DemandEstimator;
use super::integral::Integral;
use super::loop_state::LoopState;
use super::plain::swinging_motor_damping;
use super::set_point::Motion;
use super::slow_task::SlowTask;
use super::thresholds::InverseThresholds;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;

/// State of the PID, its feed-forward and the inverse of the backlash.
#[derive(Debug, Clone)]
pub(super) struct BacklashInverse<T: Real> {
    integral: Integral<T>,
    /// Shift of the set-point [rad] and its rate [rad/s].
    shift: [T; 2],
    /// Share p, -1 on the back flank to 1 on the drive flank [-].
    share: T,
    /// Motor less link on drive and back flank, without wind-up and transmission error, once measured [rad].
    edges: [Option<T>; 2],
    /// Motor less link, without transmission error, when this law began to control [rad].
    anchor: Option<T>,
    /// Target of motor less link [rad].
    target_shift: T,
    /// Torque of this law in the last period, before the limit; zero while it has no share in the torque [N m].
    last_torque: T,
    /// Time for which the demand has pressed a flank [time constants of the loop].
    pressed: T,
    /// True if a flank was pressed long enough since the link last left a flank.
    has_settled: bool,
    demand: DemandEstimator<T>,
}
state_words! {
    struct BacklashInverse<T> {
        integral, shift, share, edges, anchor, target_shift, last_torque, pressed, has_settled, demand,
    }
}

impl<T: Real> BacklashInverse<T> {
    const THRESHOLDS: InverseThresholds<T> = InverseThresholds::TUNED;

    pub fn new(tables: &CompensationTables<T>) -> Self {
        Self {
            integral: Integral::new(),
            shift: [T::ZERO; 2],
            share: T::ZERO,
            edges: [None; 2],
            anchor: None,
            target_shift: T::ZERO,
            last_torque: T::ZERO,
            pressed: T::ZERO,
            has_settled: false,
            demand: DemandEstimator::new(tables),
        }
    }

    /// Resets the edges, because the encoders may return with another offset; estimates of inertia, friction and load
    /// stay.
    pub fn reset_edges(&mut self) {
        (self.integral, self.shift, self.share) = (Integral::new(), [T::ZERO; 2], T::ZERO);
        (self.edges, self.anchor, self.pressed, self.has_settled) = ([None; 2], None, T::ZERO, false);
        self.last_torque = T::ZERO;
        self.demand.reset_plan();
    }

    /// Motor less its target position [rad].
    fn position_error(&self, state: &LoopState<T>) -> T {
        state.motor_lead - state.error - self.shift[0]
    }

    /// Updates share, edges and target in one of [`SlowTask::periods`] periods in which both shafts are seen, whichever
    /// law controls.
    // Not inlined: fewer instructions per tick on a Cortex-M4F, because the controlling law keeps its registers.
    #[inline(never)]
    pub fn update_edges(&mut self, tables: &CompensationTables<T>, state: &LoopState<T>, now: &Motion<T>) {
        self.integral.detect_swing(tables, self.last_torque, SlowTask::periods());
        let Some(pressing) = self.demand.plan(tables, now) else { return };
        self.share = clamp(clamp(self.share, pressing - T::ONE, pressing + T::ONE), -T::ONE, T::ONE);
        if let Some(side) = self.left_towards(state) {
            (self.share, self.has_settled) = (side, false);
            self.demand.reset_load_variance(tables);
        }
        let presses = self.share * pressing > T::ONE && self.share.abs() >= T::ONE && self.demand.is_transmitted();
        let share = SlowTask::periods::<T>() * tables.law.back_calculation;
        let longer = clamp(self.pressed + share, T::ZERO, Self::THRESHOLDS.longest_pressed_time);
        self.pressed = if presses { longer } else { T::ZERO };
        if self.pressed > Self::THRESHOLDS.settling_time {
            self.has_settled = true;
            let edge = state.motor_lead - state.flank_shift - self.demand.torque() / state.stiffness;
            let [drive, back] = &mut self.edges;
            let known = if self.share > T::ZERO { drive } else { back };
            let before = known.unwrap_or(edge);
            *known = Some(before + Self::THRESHOLDS.edge_rate_ratio * share * (edge - before));
        }
        if let Some(anchor) = self.anchor {
            self.target_shift = self.target_shift(state, anchor);
        }
    }

    /// Returns the flank, 1 or -1, to which the link moves although the demand presses the other flank or the edge was
    /// never measured.
    fn left_towards(&self, state: &LoopState<T>) -> Option<T> {
        // While the link swings to and fro, no flank is reported.
        if !self.has_settled {
            return None;
        }
        let (side, edge) = match self.edges {
            [Some(edge), None] => (-T::ONE, edge),
            [None, Some(edge)] => (T::ONE, edge),
            [Some(drive), Some(_)] if self.share > T::ZERO => (-T::ONE, drive),
            [Some(_), Some(back)] => (T::ONE, back),
            [None, None] => return None,
        };
        let least = Self::THRESHOLDS.flank_left_opening * state.half_gap;
        (side * (state.motor_lead - state.flank_shift - edge) > least && side * state.error > least).then_some(side)
    }

    /// Target of motor less link under the demand [rad].
    fn target_shift(&self, state: &LoopState<T>, anchor: T) -> T {
        // An edge that was not measured is computed from a known half-gap, else from the other edge and the guessed
        // half-gap. Without either, the target is the motor position at which the law took over; no wind-up is added.
        let [drive, back] = self.edges;
        let wind_up = self.demand.torque() / state.stiffness;
        let place = |seen: Option<T>, other: Option<T>, flank: Flank| {
            let by_other = |other: T| other + T::TWO * flank.sign::<T>() * state.half_gap;
            let by_gap = || state.half_gap_known.then(|| state.encoder_offset + flank.sign::<T>() * state.half_gap);
            seen.or_else(by_gap).or(other.map(by_other)).map_or(anchor, |edge| edge + wind_up)
        };
        let (drive, back) = (place(drive, back, Flank::Drive), place(back, drive, Flank::Back));
        let back = if back < drive { back } else { drive };
        // While only one edge is known, the inverse is full.
        let both = state.half_gap_known || self.edges.iter().all(Option::is_some);
        let inverted = if both { T::ONE - Self::THRESHOLDS.uninverted_share } else { T::ONE };
        T::HALF * (drive + back + inverted * self.share * (drive - back)) + state.flank_shift
    }

    /// Starts at the present motor position, if this law begins to control.
    fn hold_position(&mut self, state: &LoopState<T>) {
        if self.anchor.is_none() {
            self.anchor = Some(state.motor_lead - state.flank_shift);
            (self.shift, self.target_shift) = ([state.motor_lead, T::ZERO], state.motor_lead);
        }
    }

    /// Computes the torque of a period [N m].
    // Not inlined: fewer instructions per tick on a Cortex-M4F, because the controlling law keeps its registers.
    #[inline(never)]
    pub fn torque(
        &mut self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        now: &Motion<T>,
        payload_swings: bool,
    ) -> T {
        let pole = Self::THRESHOLDS.shift_pole_ratio * tables.law.rate;
        self.hold_position(state);
        let [shift, rate] = self.shift;
        let acceleration = pole * (pole * (self.target_shift - shift) - T::TWO * rate);
        let rate = rate + tables.clock.period * acceleration;
        let shift = shift + tables.clock.period * rate;
        if shift.is_finite() && rate.is_finite() {
            self.shift = [shift, rate];
        }
        // The motor gets all damping until it swings against the delays of the loop; then the link gets the part that
        // the motor does not bear, while the teeth may carry. If a payload swings, the payload is the cause, and
        // damping on the link would drive it.
        let on_motor = if self.integral.swings() && !payload_swings {
            swinging_motor_damping(tables.law.motor_damping)
        } else {
            tables.law.damping
        };
        let on_link = if state.teeth_open { T::ZERO } else { tables.law.damping - on_motor };
        let torque = self.demand.feed_forward(tables, now) + tables.body.motor_inertia * acceleration
            - tables.law.position * self.position_error(state)
            + on_motor * (now.speed + self.shift[1] - state.motor_speed)
            + on_link * state.error_rate
            + self.integral.torque();
        self.last_torque = torque;
        torque
    }

    /// Updates the integral; `cut` is the torque that the limit cut off. `None`: this law has no share in the torque,
    /// and stays ready to take over at the present motor position.
    pub fn update_integral(&mut self, tables: &CompensationTables<T>, state: &LoopState<T>, cut: Option<T>) {
        if let Some(cut) = cut {
            self.integral.integrate(tables, self.position_error(state), cut);
        } else {
            self.integral.decay_toward(tables, self.demand.gravity_torque());
            (self.anchor, self.last_torque) = (None, T::ZERO);
            self.hold_position(state);
        }
    }

    /// Updates inertia, friction and load by the torque of one of [`SlowTask::periods`] periods [N m].
    pub fn estimate(&mut self, tables: &CompensationTables<T>, torque: T) {
        self.demand.estimate(tables, torque);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{HALF_GAP, state, tables};

    fn accelerated(acceleration: f64) -> Motion<f64> {
        Motion { acceleration, ..Motion::default() }
    }

    #[test]
    fn demand_that_presses_a_flank_selects_it() {
        let share = |acceleration| {
            let mut inverse = BacklashInverse::new(&tables());
            inverse.update_edges(&tables(), &state(), &accelerated(acceleration));
            inverse.share
        };
        assert_eq!([2.0, -2.0].map(share), [1.0, -1.0]);
    }

    #[test]
    fn demand_about_zero_keeps_the_flank() {
        let mut inverse = BacklashInverse { share: 1.0, ..BacklashInverse::new(&tables()) };
        [0.01, -0.01, 0.0].iter().for_each(|by| inverse.update_edges(&tables(), &state(), &accelerated(*by)));
        assert!(inverse.share > 0.98);
    }

    /// Presses the drive flank by an acceleration of 2 rad/s^2 for a number of turns of the slow tasks.
    fn pressed(turns: u32, torque: f64) -> BacklashInverse<f64> {
        let mut inverse = BacklashInverse::new(&tables());
        for _ in 0..turns {
            inverse.update_edges(&tables(), &state(), &accelerated(2.0));
            inverse.estimate(&tables(), torque);
        }
        inverse
    }

    #[test]
    fn pressed_flank_shows_its_edge_after_two_time_constants() {
        assert_eq!(pressed(67, 8.0).edges, [None; 2]);
        let [drive, back] = pressed(120, 8.0).edges;
        assert!(drive.is_some_and(|edge| (edge - (HALF_GAP - 6.0 / 1000.0)).abs() < 1e-4) && back.is_none());
    }

    #[test]
    fn torque_that_does_not_reach_the_teeth_shows_no_edge() {
        assert_eq!(pressed(500, 2.0).edges, [None; 2]);
    }

    #[test]
    fn known_gap_is_inverted_by_three_quarters() {
        let target = |share| BacklashInverse { share, ..BacklashInverse::new(&tables()) }.target_shift(&state(), 0.05);
        assert_eq!([1.0, 0.0, -1.0].map(target), [0.75 * HALF_GAP, 0.0, -0.75 * HALF_GAP]);
    }

    #[test]
    fn unknown_gap_holds_the_motor_where_it_stands() {
        let unknown = LoopState { half_gap_known: false, ..state() };
        let inverse = BacklashInverse { share: 1.0, ..BacklashInverse::new(&tables()) };
        assert_eq!(inverse.target_shift(&unknown, 0.05), 0.05);
    }

    #[test]
    fn single_edge_is_inverted_whole() {
        let unknown = LoopState { half_gap_known: false, ..state() };
        let edges = [Some(0.01), None];
        let target = |share| BacklashInverse { share, edges, ..BacklashInverse::new(&tables()) };
        let [drive, back] = [1.0, -1.0].map(|share| target(share).target_shift(&unknown, 0.05));
        assert!((drive - 0.01).abs() < 1e-15 && (back - (0.01 - 2.0 * HALF_GAP)).abs() < 1e-15);
    }

    #[test]
    fn link_beyond_half_the_half_gap_has_left_its_flank() {
        let left = |travel: f64, has_settled: bool| {
            let edges = [Some(HALF_GAP), None];
            let inverse = BacklashInverse { share: 1.0, edges, has_settled, ..BacklashInverse::new(&tables()) };
            let by = travel * HALF_GAP;
            inverse.left_towards(&LoopState { motor_lead: HALF_GAP - by, error: -by, ..state() })
        };
        assert_eq!([left(0.49, true), left(0.51, true), left(0.51, false)], [None, Some(-1.0), None]);
    }

    #[test]
    fn link_leaves_its_flank_by_lead_and_error_together() {
        let left = |lead: f64, error: f64| {
            let edges = [None, Some(-HALF_GAP)];
            let inverse = BacklashInverse { share: -1.0, edges, has_settled: true, ..BacklashInverse::new(&tables()) };
            inverse.left_towards(&LoopState { motor_lead: lead * HALF_GAP, error: error * HALF_GAP, ..state() })
        };
        let found =
            [(-0.4, 0.6), (-0.4, 0.4), (-0.6, 0.6), (-1.6, 0.6), (-0.4, -0.6)].map(|(lead, error)| left(lead, error));
        assert_eq!(found, [Some(1.0), None, None, None, None]);
    }

    #[test]
    fn flank_shift_is_no_opening() {
        let edges = [Some(HALF_GAP), None];
        let inverse = BacklashInverse { share: 1.0, edges, has_settled: true, ..BacklashInverse::new(&tables()) };
        let shifted =
            LoopState { motor_lead: 0.4 * HALF_GAP, flank_shift: -0.2 * HALF_GAP, error: -HALF_GAP, ..state() };
        assert_eq!(inverse.left_towards(&shifted), None);
        assert_eq!(inverse.left_towards(&LoopState { flank_shift: 0.2 * HALF_GAP, ..shifted }), Some(-1.0));
    }

    #[test]
    fn idle_inverse_follows_the_motor() {
        let mut inverse = BacklashInverse::new(&tables());
        inverse.update_integral(&tables(), &state(), None);
        assert_eq!((inverse.shift, inverse.position_error(&state())), ([HALF_GAP, 0.0], 0.0));
    }

    #[test]
    fn reset_forgets_the_edges_only() {
        let mut inverse = pressed(120, 8.0);
        let gravity_torque = inverse.demand.gravity_torque();
        inverse.reset_edges();
        assert_eq!((inverse.edges, inverse.share), ([None; 2], 0.0));
        assert_eq!(inverse.demand.gravity_torque(), gravity_torque);
    }
}

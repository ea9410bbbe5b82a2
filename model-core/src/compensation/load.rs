//! Load model: splits the observer's load torque into gravity torque and dry friction (`load_friction`), which predicts
//! the torque after a reversal. A load that may swing (`payload_swing`) is followed more slowly than it swings.
//!
//! ```text
//! (K6)  load torque = L + f dir,   L' = rate,   Kalman filter for L and f
//! ```
//!
//! Symbols: L = `gravity_torque`, f = `friction`, dir = `direction()`, f dir = `friction_torque()`. L contains every
//! torque that does not depend on the direction of motion: weight and steady pushes.

use super::load_friction::LoadFrictionFilter;
use super::loop_state::{LoopState, friction_direction};
use super::payload_swing::PayloadSwing;
use super::thresholds::LoadThresholds;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{clamp, deadband};
use crate::numbers::state_words::state_words;
use crate::observer::Estimates;

/// Gravity torque and dry friction of the load torque.
#[derive(Debug, Clone)]
pub(super) struct LoadModel<T: Real> {
    filter: LoadFrictionFilter<T>,
    /// Speed of the set-point less speed of the link, smoothed [rad/s].
    speed_error: T,
    /// Speed of the link over the speed at which dry friction reaches its full size [-].
    speed: T,
    /// Rate of the gravity torque [N m/s].
    rate: T,
    /// Load torque of a link that no flank carries, smoothed [N m].
    free_load: Option<T>,
    /// Largest recent load torque on the link, decaying [N m].
    peak_load: T,
    /// Direction of the link's last motion: 1, -1, or 0 before the first motion.
    last_direction: T,
    /// State at the beginning of creeping, while the link creeps.
    creep: Option<Creep<T>>,
    /// 1 while the motor's limit cuts torque off, then decaying over the loop's transient [-].
    saturation: T,
    /// Detector of a swinging payload.
    swing: PayloadSwing<T>,
}
state_words! {
    struct LoadModel<T> {
        filter, speed_error, speed, rate, free_load, peak_load, last_direction, creep, saturation, swing,
    }
}

/// Gravity torque before the link began to creep.
#[derive(Debug, Clone, Copy)]
struct Creep<T: Real> {
    gravity_torque: T,
    /// Growth of the gravity torque's variance while the link creeps.
    variance: T,
}
state_words! { struct Creep<T> { gravity_torque, variance } }

impl<T: Real> LoadModel<T> {
    const THRESHOLDS: LoadThresholds<T> = LoadThresholds::TUNED;

    pub fn new() -> Self {
        Self {
            filter: LoadFrictionFilter::new(T::ZERO, [T::ONE; 2]),
            speed_error: T::ZERO,
            speed: T::ZERO,
            rate: T::ZERO,
            free_load: None,
            peak_load: T::ZERO,
            last_direction: T::ZERO,
            creep: None,
            saturation: T::ZERO,
            swing: PayloadSwing::new(),
        }
    }

    /// Returns a model with a known gravity torque and friction [N m].
    #[cfg(test)]
    pub fn of_known(gravity_torque: T, friction: T) -> Self {
        let mut load = Self::new();
        (load.filter.gravity_torque, load.filter.friction) = (gravity_torque, friction);
        load
    }

    /// Records whether the motor's limit has cut torque off in this period.
    pub fn record_saturation(&mut self, tables: &CompensationTables<T>, is_cut: bool) {
        self.saturation = if is_cut { T::ONE } else { self.saturation * tables.switching.transient_left };
    }

    /// True while the load swings like a payload on a flexible arm.
    pub fn payload_swings(&self) -> bool {
        self.swing.swings()
    }

    /// Gain over the gain for a load that does not swing [-].
    fn gain_share(&self) -> T {
        if self.swing.may_swing() { Self::THRESHOLDS.swing_gain_share } else { T::ONE }
    }

    /// Share and sign of the dry friction at the speed of the link, -1 to 1.
    fn direction(&self) -> T {
        clamp(self.speed, -T::ONE, T::ONE)
    }

    pub fn gravity_torque(&self) -> T {
        self.filter.gravity_torque
    }

    /// Rate of the gravity torque, as of a weight that turns with the link [N m/s].
    pub fn gravity_rate(&self) -> T {
        self.rate
    }

    pub fn friction(&self) -> T {
        self.filter.friction
    }

    /// True if the link was recently pushed harder than the limit of the teeth. The limit is then suspended: the push
    /// loads the teeth anyway.
    pub fn external_impact(&self, tables: &CompensationTables<T>) -> bool {
        self.peak_load > tables.limits.teeth
    }

    /// Load torque on the link if no flank carried it [N m].
    pub fn free_load_torque(&self) -> T {
        self.free_load.unwrap_or(self.filter.gravity_torque + self.friction_torque())
    }

    /// Smallest torque that the start of a link at rest needs [N m]; 0 for a link that a flank must hold. A load within
    /// friction does not move a link without a flank, but a start must overcome that friction.
    pub fn start_torque(&self, tables: &CompensationTables<T>) -> T {
        let held = deadband(self.filter.gravity_torque, tables.switching.measured + self.filter.friction) == T::ZERO;
        if held { T::TWO * tables.switching.measured + self.filter.friction } else { T::ZERO }
    }

    /// Dry friction at a planned speed [N m].
    pub fn planned_friction(&self, tables: &CompensationTables<T>, speed: T) -> T {
        self.filter.friction * friction_direction(tables, speed)
    }

    /// Dry friction at the speed of the link [N m].
    pub fn friction_torque(&self) -> T {
        self.filter.friction * self.direction()
    }

    /// True if the link is so slow that any part of its friction may act.
    fn creeps(&self) -> bool {
        creeps(self.speed)
    }

    /// Updates the model by the estimated load torque, unless the teeth are known to be open. `acts`: the load is fed
    /// forward; only then does its swing concern the loop.
    pub fn update(
        &mut self,
        tables: &CompensationTables<T>,
        estimates: &Estimates<T>,
        state: &LoopState<T>,
        acts: bool,
    ) {
        self.estimate_speed(tables, state);
        self.predict(tables, state);
        let torque = estimates.load_torque;
        let known = torque.valid && torque.value.is_finite() && state.link_seen;
        let carried = known && !state.teeth_open;
        self.record_peak(tables, known.then_some(torque.value));
        // A load beyond the motor's limit cannot be carried.
        let load = clamp(torque.value, -tables.limits.motor, tables.limits.motor);
        self.swing.update(tables, (carried && acts).then_some(load - self.friction_torque()));
        // While the torque alternates between the limits the load is known with a lag. Friction is then not estimated,
        // because it would absorb the lag.
        if carried && self.saturation > Self::THRESHOLDS.saturation {
            self.follow(tables, load);
        } else if carried {
            self.correct(tables, load);
        } else {
            self.rate *= tables.load.rate_left;
        }
        self.update_free_load(tables, (known && !carried).then_some(load));
    }

    /// Advances the gravity torque by a period. The torque of a weight changes only while the link turns. Without the
    /// link's position the gravity torque decays, because the integral of plain control takes over.
    fn predict(&mut self, tables: &CompensationTables<T>, state: &LoopState<T>) {
        if self.creeps() {
            self.rate = T::ZERO;
        }
        let limit = tables.limits.motor;
        self.filter.gravity_torque = clamp(self.filter.gravity_torque + tables.clock.period * self.rate, -limit, limit);
        if !state.link_seen {
            self.filter.gravity_torque -= tables.law.back_calculation * self.filter.gravity_torque;
        }
    }

    /// Records the largest recent load torque, which decays.
    fn record_peak(&mut self, tables: &CompensationTables<T>, torque: Option<T>) {
        self.peak_load *= tables.switching.transient_left;
        let Some(torque) = torque else { return };
        let push = clamp(torque.abs(), T::ZERO, tables.limits.motor + tables.limits.motor);
        if push > self.peak_load {
            self.peak_load = push;
        }
    }

    /// Follows a measured load in the gravity torque alone; friction stays.
    fn follow(&mut self, tables: &CompensationTables<T>, torque: T) {
        self.filter.gravity_torque +=
            self.gain_share() * tables.load.gain * (torque - self.filter.gravity_torque - self.friction_torque());
    }

    /// Smooths the load torque of a link that no flank carries. Friction alone holds such a link at rest.
    fn update_free_load(&mut self, tables: &CompensationTables<T>, torque: Option<T>) {
        let last = self.free_load_torque();
        self.free_load = torque.map(|torque| last + tables.switching.smoothing * (torque - last));
        if let Some(free_load) = self.free_load
            && self.creeps()
        {
            self.filter.gravity_torque =
                clamp(self.filter.gravity_torque, free_load - self.filter.friction, free_load + self.filter.friction);
        }
    }

    /// Integrates an error into the gravity torque, where a flank should carry but the teeth are open and the force is
    /// unknown.
    pub fn integrate_error(&mut self, tables: &CompensationTables<T>, error: T) {
        let next = self.filter.gravity_torque + tables.law.integral * error;
        if next.is_finite() {
            self.filter.gravity_torque = clamp(next, -tables.limits.motor, tables.limits.motor);
        }
    }

    /// Estimates the speed of the link from the set-point, which has no noise, and the smoothed speed error.
    fn estimate_speed(&mut self, tables: &CompensationTables<T>, state: &LoopState<T>) {
        let set_point_speed = state.link_speed + state.error_rate;
        let speed_error = self.speed_error + tables.switching.smoothing * (state.error_rate - self.speed_error);
        let speed = tables.load.friction_slope * (set_point_speed - speed_error);
        if speed.is_finite() {
            (self.speed_error, self.speed) = (speed_error, speed);
        }
    }

    /// Updates gravity torque and friction by a measurement while a flank carries. On a creeping link any part of the
    /// friction may act: the sum is followed in the gravity torque until the link moves again.
    fn correct(&mut self, tables: &CompensationTables<T>, torque: T) {
        let [gravity_growth, friction_growth, noise] = tables.load.variances;
        let gain_share = self.gain_share();
        let [gravity_growth, friction_growth] =
            [gravity_growth, friction_growth].map(|growth| gain_share * gain_share * growth);
        // While the link creeps, a speed within the noise does not count as motion.
        if creeps(if self.creep.is_some() { Self::THRESHOLDS.creep_release_share * self.speed } else { self.speed }) {
            let gravity_torque = self.filter.gravity_torque;
            let creep = self.creep.get_or_insert(Creep { gravity_torque, variance: T::ZERO });
            creep.variance += gravity_growth;
            self.follow(tables, torque);
            return;
        }
        let direction = self.direction();
        if let Some(creep) = self.creep.take()
            && self.last_direction * direction <= T::ZERO
        {
            let followed = self.filter.gravity_torque + self.filter.friction * direction;
            self.filter.gravity_torque = creep.gravity_torque;
            self.filter.predict([creep.variance, T::ZERO]);
            self.filter.correct(followed, direction, tables.load.gain * noise, tables.limits.motor);
        }
        self.last_direction = direction;
        self.filter.predict([gravity_growth, friction_growth]);
        let by = self.filter.correct(torque, direction, noise, tables.limits.motor);
        self.rate = clamp(self.rate + tables.load.rate_gain * by, -tables.load.fastest, tables.load.fastest);
    }
}

/// True if a link at this speed is so slow that any part of its friction may act.
fn creeps<T: Real>(speed: T) -> bool {
    speed < T::ONE && speed > -T::ONE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{q1, state, tables};

    /// Estimates with a load torque [N m].
    fn measured(torque: f64) -> Estimates<f64> {
        let mut estimates = Estimates::default();
        (estimates.load_torque.value, estimates.load_torque.valid) = (torque, true);
        estimates
    }

    /// State of a link that moves as asked [rad/s].
    fn moving(speed: f64) -> LoopState<f64> {
        LoopState { link_speed: speed, ..state() }
    }

    #[test]
    fn gravity_torque_follows_a_load_at_rest() {
        let mut load = LoadModel::new();
        (0..2000).for_each(|_| load.update(&tables(), &measured(3.0), &state(), true));
        assert!((load.gravity_torque() - 3.0).abs() < 1e-6 && load.friction() == 0.0);
    }

    #[test]
    fn motion_both_ways_finds_the_friction() {
        let mut load = LoadModel::new();
        for period in 0..20_000 {
            let direction = if (period / 500) % 2 == 0 { 1.0 } else { -1.0 };
            load.update(&tables(), &measured(2.0 + direction), &moving(0.1 * direction), true);
        }
        assert!((load.gravity_torque() - 2.0).abs() < 0.1 && (load.friction() - 1.0).abs() < 0.1);
    }

    #[test]
    fn invalid_load_changes_nothing() {
        for (value, valid) in [(3.0, false), (f64::NAN, true), (f64::INFINITY, true)] {
            let (mut load, mut estimates) = (LoadModel::of_known(1.0, 0.5), measured(value));
            estimates.load_torque.valid = valid;
            load.update(&tables(), &estimates, &state(), true);
            assert_eq!((load.gravity_torque(), load.friction()), (1.0, 0.5));
            assert!(!load.external_impact(&tables()));
        }
    }

    #[test]
    fn load_beyond_the_motor_counts_as_its_limit() {
        let mut load = LoadModel::new();
        (0..2000).for_each(|_| load.update(&tables(), &measured(50.0), &state(), true));
        assert!((load.gravity_torque() - 10.0).abs() < 1e-6);
    }

    #[test]
    fn load_beyond_the_negative_limit_counts_as_it() {
        let mut load = LoadModel::new();
        (0..2000).for_each(|_| load.update(&tables(), &measured(-50.0), &state(), true));
        assert!((load.gravity_torque() + 10.0).abs() < 1e-6);
    }

    #[test]
    fn saturated_motor_teaches_no_friction() {
        let mut load = LoadModel::of_known(2.0, 1.0);
        for period in 0..4000 {
            let direction = if (period / 500) % 2 == 0 { 1.0 } else { -1.0 };
            load.record_saturation(&tables(), true);
            load.update(&tables(), &measured(2.0 + 3.0 * direction), &moving(direction), true);
            assert_eq!(load.friction(), 1.0);
        }
        let before = load.gravity_torque();
        load.record_saturation(&tables(), true);
        load.update(&tables(), &measured(before + 1.0 + 0.5), &moving(1.0), true);
        let share = (load.gravity_torque() - before) / 0.5;
        assert!(share > 0.0 && share < 1.0, "a part of the difference to gravity torque and friction: {share}");
    }

    #[test]
    fn push_beyond_the_teeth_is_an_impact_for_a_transient() {
        let impact = |torque: f64, after: u32| {
            let mut load = LoadModel::new();
            load.update(&tables(), &measured(torque), &state(), true);
            (0..after).for_each(|_| load.update(&tables(), &measured(0.0), &state(), true));
            load.external_impact(&tables())
        };
        assert!(!impact(7.9, 0) && impact(8.1, 0) && impact(-8.1, 0));
        assert!(impact(20.0, 80) && !impact(20.0, 100), "0.99^91 of 20 N m are 8 N m");
        assert!(!impact(1e9, 100), "a push counts twice the motor's limit at most");
    }

    #[test]
    fn unseen_link_hands_its_load_to_the_integral() {
        let mut load = LoadModel::of_known(5.0, 0.0);
        load.update(&tables(), &measured(5.0), &LoopState { link_seen: false, ..state() }, true);
        assert!((load.gravity_torque() - 4.95).abs() < 1e-12);
    }

    #[test]
    fn friction_has_the_sign_of_the_motion() {
        let mut load = LoadModel::of_known(0.0, 2.0);
        let friction = [0.02, -0.02, 0.005].map(|speed| {
            load.estimate_speed(&tables(), &moving(speed));
            load.friction_torque()
        });
        assert_eq!(friction, [2.0, -2.0, 1.0]);
    }

    #[test]
    fn start_of_a_held_link_needs_its_friction() {
        let start = |gravity_torque| LoadModel::of_known(gravity_torque, 1.0).start_torque(&tables());
        // Friction and the uncertainty of 0.2 N m hold the link.
        assert_eq!([0.0, 1.19, -1.19, 1.21].map(start), [1.4, 1.4, 1.4, 0.0]);
    }

    #[test]
    fn open_teeth_leave_the_link_to_its_free_load() {
        let mut load = LoadModel::of_known(1.0, 0.0);
        let open = LoopState { teeth_open: true, ..moving(0.1) };
        (0..500).for_each(|_| load.update(&tables(), &measured(3.0), &open, true));
        assert!((load.free_load_torque() - 3.0).abs() < 1e-4);
        assert_eq!(load.gravity_torque(), 1.0);
        load.update(&tables(), &measured(3.0), &moving(0.1), true);
        assert_eq!(load.free_load_torque(), load.gravity_torque() + load.friction_torque());
    }

    #[test]
    fn cut_torque_keeps_the_friction() {
        let friction = |is_cut| {
            let mut load = LoadModel::of_known(0.0, 1.0);
            load.record_saturation(&tables(), is_cut);
            load.update(&tables(), &measured(5.0), &moving(0.1), true);
            load.friction()
        };
        assert_eq!(friction(true), 1.0);
        assert!(friction(false) > 1.0);
    }

    #[test]
    fn integrated_error_stays_within_the_motor_limit() {
        let mut load = LoadModel::of_known(9.999, 0.0);
        load.integrate_error(&tables(), 1.0);
        assert_eq!(load.gravity_torque(), 10.0);
        load.integrate_error(&tables(), f64::NAN);
        assert_eq!(load.gravity_torque(), 10.0);
    }

    #[test]
    fn link_within_the_noise_of_its_speed_still_creeps() {
        let friction = |speed: f64| {
            let mut load = LoadModel::of_known(0.0, 1.0);
            load.update(&tables(), &measured(5.0), &moving(0.0), true);
            load.update(&tables(), &measured(5.0), &moving(speed), true);
            load.friction()
        };
        // Three times 0.01 rad/s.
        assert_eq!(friction(0.029), 1.0);
        assert!(friction(0.031) != 1.0);
    }

    #[test]
    fn load_that_may_swing_is_followed_slower() {
        let followed = |acts: bool| {
            let mut load = LoadModel::of_known(0.0, 0.0);
            // Only a load that is fed forward can be shown not to swing.
            (0..1100).for_each(|_| load.update(&tables(), &measured(0.0), &state(), acts));
            load.update(&tables(), &measured(1.0), &state(), acts);
            load.gravity_torque()
        };
        assert!((followed(true) - 0.3).abs() < 1e-9 && (followed(false) - 0.3 / 8.0).abs() < 1e-9);
    }

    #[test]
    fn cut_pauses_friction_for_69_periods() {
        let friction = |periods: u32| {
            let mut load = LoadModel::of_known(0.0, 1.0);
            load.record_saturation(&tables(), true);
            (0..periods).for_each(|_| load.record_saturation(&tables(), false));
            load.update(&tables(), &measured(5.0), &moving(0.1), true);
            load.friction()
        };
        // 0.99^69 is a half: 0.7 transients of 100 periods.
        assert_eq!(friction(68), 1.0);
        assert!(friction(69) > 1.0);
    }

    /// Model of Q1's load that is known not to swing, of a link at rest without a load.
    fn steady() -> LoadModel<f64> {
        let (tables, mut load) = (q1(), LoadModel::new());
        // A second of 10,000 periods.
        (0..11_000).for_each(|_| load.update(&tables, &measured(0.0), &state(), true));
        load
    }

    #[test]
    fn gravity_torque_follows_in_3_ms() {
        let (tables, mut load) = (q1(), steady());
        // 3.2 ms: a time constant.
        (0..32).for_each(|_| load.update(&tables, &measured(1.0), &state(), true));
        assert!((load.gravity_torque() - 0.637).abs() < 0.02, "{}", load.gravity_torque());
    }

    #[test]
    fn friction_is_followed_in_100_ms() {
        let (tables, mut load) = (q1(), steady());
        let mut shake = |friction: f64, periods: u32| {
            for period in 0..periods {
                let direction = if period % 2 == 0 { 1.0 } else { -1.0 };
                load.update(&tables, &measured(friction * direction), &moving(0.1 * direction), true);
            }
            load.friction()
        };
        shake(0.0, 20_000);
        let found = shake(1.0, 1000);
        assert!((found - 0.632).abs() < 0.02, "{found}");
    }

    #[test]
    fn load_changes_by_the_motor_limit_in_30_ms() {
        let (tables, mut load) = (q1(), LoadModel::new());
        load.rate = 499.0;
        load.update(&tables, &measured(15.0), &moving(0.1), true);
        // 15 N m in 30 ms.
        assert!((load.gravity_rate() - 500.0).abs() < 1e-9, "{}", load.gravity_rate());
    }

    #[test]
    fn rate_of_an_uncarried_load_decays_in_100_ms() {
        let (tables, mut load) = (q1(), LoadModel::new());
        load.rate = 1.0;
        let open = LoopState { teeth_open: true, ..moving(0.1) };
        (0..1000).for_each(|_| load.update(&tables, &measured(0.0), &open, true));
        assert!((load.gravity_rate() - 0.368).abs() < 1e-3, "{}", load.gravity_rate());
    }

    #[test]
    fn friction_is_full_from_10_mrad_per_s() {
        let mut load = LoadModel::of_known(0.0, 2.0);
        let [below, above] = [9e-3, 11e-3].map(|speed| {
            load.estimate_speed(&q1(), &moving(speed));
            load.friction_torque()
        });
        assert!((below - 1.8).abs() < 1e-9 && above == 2.0, "{below} {above}");
    }
}

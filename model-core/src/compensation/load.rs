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
use crate::numbers::arithmetic::{beyond, clamp};
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

/// Gravity torque before the link began to creep.
#[derive(Debug, Clone, Copy)]
struct Creep<T: Real> {
    gravity_torque: T,
    /// Growth of the gravity torque's variance while the link creeps.
    variance: T,
}

impl<T: Real> LoadModel<T> {
    const THRESHOLDS: LoadThresholds<T> = LoadThresholds::VALUES;

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
        let held = beyond(self.filter.gravity_torque, tables.switching.measured + self.filter.friction) == T::ZERO;
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
        let asked = state.link_speed + state.error_rate;
        let speed_error = self.speed_error + tables.switching.smoothing * (state.error_rate - self.speed_error);
        let speed = tables.load.friction_slope * (asked - speed_error);
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

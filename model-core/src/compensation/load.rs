//! Load model: splits the observer's load torque into even load and dry friction (`brakes`), which predicts the torque after a reversal.
//! A load that may swing (`load_swing`) is followed more slowly than it swings.
//!
//! ```text
//! (K6)  load torque = L + f dir,   L' = rate
//! ```
//!
//! Symbols: L = `even`, f = `friction`, dir = `direction()`.

use super::brakes::Brakes;
use super::load_swing::LoadSwing;
use super::situation::{Situation, planned_direction};
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{clamp, deadband};
use crate::observer::Estimates;

/// Even load and dry friction of the load torque.
#[derive(Debug, Clone)]
pub(super) struct LoadModel<T: Real> {
    brakes: Brakes<T>,
    /// Speed of the set-point less speed of the link, smoothed [rad/s].
    slip: T,
    /// Speed of the link over the speed at which dry friction reaches its full size [-].
    speed: T,
    /// Rate of the even load [N m/s].
    rate: T,
    /// Load torque of a link that no flank carries, smoothed [N m].
    alone: Option<T>,
    /// Largest recent load torque on the link, decaying [N m].
    hardest: T,
    /// Direction of the link's last motion: 1, -1, or 0 before the first motion.
    moved: T,
    /// State at the beginning of creeping, while the link creeps.
    creep: Option<Creep<T>>,
    /// 1 while the motor's limit cuts torque off, then decaying over the loop's transient [-].
    cut: T,
    /// Detector of a swinging payload.
    swing: LoadSwing<T>,
}

/// Even load before the link began to creep.
#[derive(Debug, Clone, Copy)]
struct Creep<T: Real> {
    even: T,
    /// Growth of the even load's variance while the link creeps.
    variance: T,
}

impl<T: Real> LoadModel<T> {
    /// Share of the speed of a creeping link that must exceed the creeping speed before the link counts as moving [-]:
    /// noise reaches three times the creeping speed.
    const STILL_CREEPS: T = T::THIRD;

    /// Gain for a load that may swing, over the gain for other loads [-]: time constant of 25 ms, half the period of 20
    /// Hz.
    const SLOWLY: T = T::EIGHTH;

    pub fn new() -> Self {
        Self {
            brakes: Brakes::new(T::ZERO, [T::ONE; 2]),
            slip: T::ZERO,
            speed: T::ZERO,
            rate: T::ZERO,
            alone: None,
            hardest: T::ZERO,
            moved: T::ZERO,
            creep: None,
            cut: T::ZERO,
            swing: LoadSwing::new(),
        }
    }

    /// Records whether the motor's limit has cut torque off in this period.
    pub fn take_cut(&mut self, tables: &CompensationTables<T>, is_cut: bool) {
        self.cut = if is_cut { T::ONE } else { self.cut * tables.switching.transient_left };
    }

    /// True while the load swings like a payload on a flexible arm.
    pub fn swings(&self) -> bool {
        self.swing.swings()
    }

    /// Gain over the gain for a load that does not swing [-].
    fn pace(&self) -> T {
        if self.swing.may_swing() { Self::SLOWLY } else { T::ONE }
    }

    /// Share and sign of the dry friction at the speed of the link, -1 to 1.
    fn direction(&self) -> T {
        clamp(self.speed, -T::ONE, T::ONE)
    }

    pub fn even(&self) -> T {
        self.brakes.even
    }

    /// Rate of the even load, as of a weight that turns with the link [N m/s].
    pub fn rate(&self) -> T {
        self.rate
    }

    pub fn friction(&self) -> T {
        self.brakes.friction
    }

    /// True if the link was recently pushed harder than the limit of the teeth. The limit is then suspended: the push
    /// loads the teeth anyway.
    pub fn throws(&self, tables: &CompensationTables<T>) -> bool {
        self.hardest > tables.limits.teeth
    }

    /// Load torque on the link if no flank carried it [N m].
    pub fn free(&self) -> T {
        self.alone.unwrap_or(self.brakes.even + self.drag())
    }

    /// Smallest torque that the start of a link at rest needs [N m]; 0 for a link that a flank must hold. A load within
    /// friction does not move a link without a flank, but a start must overcome that friction.
    pub fn start(&self, tables: &CompensationTables<T>) -> T {
        let held = deadband(self.brakes.even, tables.switching.measured + self.brakes.friction) == T::ZERO;
        if held { T::TWO * tables.switching.measured + self.brakes.friction } else { T::ZERO }
    }

    /// Dry friction at a planned speed [N m].
    pub fn planned_drag(&self, tables: &CompensationTables<T>, speed: T) -> T {
        self.brakes.friction * planned_direction(tables, speed)
    }

    /// Dry friction at the speed of the link [N m].
    pub fn drag(&self) -> T {
        self.brakes.friction * self.direction()
    }

    /// True if the link is so slow that any part of its friction may act.
    fn creeps(&self) -> bool {
        creeps(self.speed)
    }

    /// Updates the model by the estimated load torque, unless the teeth are known to be open. `acts`: the load is fed
    /// forward; only then does its swing concern the loop.
    pub fn observe(
        &mut self,
        tables: &CompensationTables<T>,
        estimates: &Estimates<T>,
        situation: &Situation<T>,
        acts: bool,
    ) {
        self.follow(tables, situation);
        // The torque of a weight changes only while the link turns.
        if self.creeps() {
            self.rate = T::ZERO;
        }
        self.brakes.even =
            clamp(self.brakes.even + tables.clock.period * self.rate, -tables.limits.motor, tables.limits.motor);
        // Without the link's position, the integral of plain control takes over.
        if !situation.feels {
            self.brakes.even -= tables.law.back_calculation * self.brakes.even;
        }
        let torque = estimates.load_torque;
        let known = torque.valid && torque.value.is_finite() && situation.feels;
        // A load beyond the motor's limit cannot be carried.
        let held = clamp(torque.value, -tables.limits.motor, tables.limits.motor);
        self.hardest *= tables.switching.transient_left;
        let push = clamp(torque.value.abs(), T::ZERO, tables.limits.motor + tables.limits.motor);
        if known && push > self.hardest {
            self.hardest = push;
        }
        let carried = known && !situation.open;
        self.swing.take(tables, (carried && acts).then_some(held - self.drag()));
        // While the torque alternates between the limits the load is known with a lag. Friction is then not estimated,
        // because it would absorb the lag.
        if carried && self.cut > T::HALF {
            self.brakes.even += self.pace() * tables.load.gain * (held - self.brakes.even - self.drag());
        } else if carried {
            self.learn(tables, held);
        } else {
            self.rate *= tables.load.rate_left;
        }
        let before = self.free();
        self.alone = (known && !carried).then(|| before + tables.switching.smoothing * (held - before));
        // Friction alone holds a link at rest without a flank.
        if let Some(alone) = self.alone
            && self.creeps()
        {
            self.brakes.even = clamp(self.brakes.even, alone - self.brakes.friction, alone + self.brakes.friction);
        }
    }

    /// Integrates an error into the even load, where a flank should carry but the teeth are open and the force is
    /// unknown.
    pub fn lean(&mut self, tables: &CompensationTables<T>, error: T) {
        let next = self.brakes.even + tables.law.integral * error;
        if next.is_finite() {
            self.brakes.even = clamp(next, -tables.limits.motor, tables.limits.motor);
        }
    }

    /// Estimates the speed of the link from the set-point, which has no noise, and the smoothed slip.
    fn follow(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>) {
        let asked = situation.link_speed + situation.error_rate;
        let slip = self.slip + tables.switching.smoothing * (situation.error_rate - self.slip);
        let speed = tables.load.friction_slope * (asked - slip);
        if speed.is_finite() {
            (self.slip, self.speed) = (slip, speed);
        }
    }

    /// Updates even load and friction by a measurement while a flank carries. On a creeping link any part of the
    /// friction may act: the sum is followed in the even load until the link moves again.
    fn learn(&mut self, tables: &CompensationTables<T>, torque: T) {
        let [growth_even, growth_friction, noise] = tables.load.variances;
        let pace = self.pace();
        let [growth_even, growth_friction] = [growth_even, growth_friction].map(|growth| pace * pace * growth);
        // While the link creeps, a speed within the noise does not count as motion.
        if creeps(if self.creep.is_some() { Self::STILL_CREEPS * self.speed } else { self.speed }) {
            let even = self.brakes.even;
            let creep = self.creep.get_or_insert(Creep { even, variance: T::ZERO });
            creep.variance += growth_even;
            self.brakes.even += self.pace() * tables.load.gain * (torque - self.brakes.even - self.drag());
            return;
        }
        let direction = self.direction();
        if let Some(creep) = self.creep.take()
            && self.moved * direction <= T::ZERO
        {
            let followed = self.brakes.even + self.brakes.friction * direction;
            self.brakes.even = creep.even;
            self.brakes.grow([creep.variance, T::ZERO]);
            self.brakes.take(followed, direction, tables.load.gain * noise, tables.limits.motor);
        }
        self.moved = direction;
        self.brakes.grow([growth_even, growth_friction]);
        let by = self.brakes.take(torque, direction, noise, tables.limits.motor);
        self.rate = clamp(self.rate + tables.load.rate_gain * by, -tables.load.fastest, tables.load.fastest);
    }
}

/// True if a link at this speed is so slow that any part of its friction may act.
fn creeps<T: Real>(speed: T) -> bool {
    speed < T::ONE && speed > -T::ONE
}

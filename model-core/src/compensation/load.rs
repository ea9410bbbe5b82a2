//! What brakes the link, by the observer's load torque, split into an even part and dry friction (`brakes`). The split is what makes the
//! torque after a reversal predictable. A load that may swing (`load_swing`) is followed more slowly than it swings.

use super::brakes::Brakes;
use super::load_swing::LoadSwing;
use super::situation::{Situation, planned_direction};
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{beyond, clamp};
use crate::observer::Estimates;

/// Even part and dry friction of the load torque.
#[derive(Debug, Clone)]
pub(super) struct LoadModel<T: Real> {
    brakes: Brakes<T>,
    /// By how much the link is slower than asked, smoothed [rad/s].
    slip: T,
    /// Its speed over that at which dry friction has its full size.
    speed: T,
    /// Rate of the even part [N m/s].
    rate: T,
    /// What brakes a link that no flank carries, smoothed [N m].
    alone: Option<T>,
    /// The hardest that the link was pushed of late, fading [N m].
    hardest: T,
    /// 1 or -1: where the link last moved to, 0 before it has.
    moved: T,
    /// How it began to creep, while it does.
    creep: Option<Creep<T>>,
    /// 1 while the motor's limit cuts torque off, fading over the loop's transient [-].
    cut: T,
    /// Whether it is a payload that swings.
    swing: LoadSwing<T>,
}

/// What was known before the link began to creep.
#[derive(Debug, Clone, Copy)]
struct Creep<T: Real> {
    even: T,
    /// By how much the even part's variance has grown since.
    variance: T,
}

impl<T: Real> LoadModel<T> {
    /// A link that creeps moves again only at a speed of which this part [-] is no creeping: noise makes up to three times
    /// the speed of creeping.
    const STILL_CREEPS: T = T::THIRD;

    /// How fast a load is followed that may swing, over how fast another one is [-]: in 25 ms, half the period of 20 Hz.
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

    /// Whether the motor's limit has cut torque off in this period.
    pub fn take_cut(&mut self, tables: &CompensationTables<T>, is_cut: bool) {
        self.cut = if is_cut { T::ONE } else { self.cut * tables.switching.transient_left };
    }

    /// Whether the load swings as a payload on a flexible arm does.
    pub fn swings(&self) -> bool {
        self.swing.swings()
    }

    /// How fast the load is followed, over how fast a load is that does not swing [-].
    fn pace(&self) -> T {
        if self.swing.may_swing() { Self::SLOWLY } else { T::ONE }
    }

    /// -1 to 1: what share of the dry friction brakes the link.
    fn direction(&self) -> T {
        clamp(self.speed, -T::ONE, T::ONE)
    }

    pub fn even(&self) -> T {
        self.brakes.even
    }

    /// Rate of the even part: weight turns with the link [N m/s].
    pub fn rate(&self) -> T {
        self.rate
    }

    pub fn friction(&self) -> T {
        self.brakes.friction
    }

    /// Whether the link was pushed of late with more than the teeth shall pass on. Then the teeth are not spared: whoever pushes presses them.
    pub fn throws(&self, tables: &CompensationTables<T>) -> bool {
        self.hardest > tables.limits.teeth
    }

    /// What would brake the link now if no flank carried it.
    pub fn free(&self) -> T {
        self.alone.unwrap_or(self.brakes.even + self.drag())
    }

    /// What the start of a link at rest will ask for at least [N m]; 0 for a link that a flank has to hold. Under a
    /// load within its friction the link stays where it is without a flank, but a start must overcome that friction.
    pub fn start(&self, tables: &CompensationTables<T>) -> T {
        let held = beyond(self.brakes.even, tables.switching.measured + self.brakes.friction) == T::ZERO;
        if held { T::TWO * tables.switching.measured + self.brakes.friction } else { T::ZERO }
    }

    /// Friction at a speed that is planned.
    pub fn planned_drag(&self, tables: &CompensationTables<T>, speed: T) -> T {
        self.brakes.friction * planned_direction(tables, speed)
    }

    /// Friction at the speed that the link has.
    pub fn drag(&self) -> T {
        self.brakes.friction * self.direction()
    }

    /// Whether the link is so slow that it may rub with any part of its friction.
    fn creeps(&self) -> bool {
        creeps(self.speed)
    }

    /// Takes the estimate of the load torque, unless the teeth are known to be open. `acts` is whether it is fed forward: only then is a
    /// swing the loop's own affair.
    pub fn observe(
        &mut self,
        tables: &CompensationTables<T>,
        estimates: &Estimates<T>,
        situation: &Situation<T>,
        acts: bool,
    ) {
        self.follow(tables, situation);
        // A weight turns with the link.
        if self.creeps() {
            self.rate = T::ZERO;
        }
        self.brakes.even =
            clamp(self.brakes.even + tables.clock.period * self.rate, -tables.limits.motor, tables.limits.motor);
        // Without a link to be seen the integral of plain control takes over.
        if !situation.feels {
            self.brakes.even -= tables.law.back_calculation * self.brakes.even;
        }
        let torque = estimates.load_torque;
        let known = torque.valid && torque.value.is_finite() && situation.feels;
        // More than the motor can hold is no load that it carries.
        let held = clamp(torque.value, -tables.limits.motor, tables.limits.motor);
        self.hardest *= tables.switching.transient_left;
        let push = clamp(torque.value.abs(), T::ZERO, tables.limits.motor + tables.limits.motor);
        if known && push > self.hardest {
            self.hardest = push;
        }
        let carried = known && !situation.open;
        self.swing.take(tables, (carried && acts).then_some(held - self.drag()));
        // What brakes a link that is jerked from limit to limit is known with a lag: it is followed as one, for shared out it
        // would make friction of the lag.
        if carried && self.cut > T::HALF {
            self.brakes.even += self.pace() * tables.load.gain * (held - self.brakes.even - self.drag());
        } else if carried {
            self.learn(tables, held);
        } else {
            self.rate *= tables.load.rate_left;
        }
        let before = self.free();
        self.alone = (known && !carried).then(|| before + tables.switching.smoothing * (held - before));
        // What holds a link that rests alone is its friction.
        if let Some(alone) = self.alone
            && self.creeps()
        {
            self.brakes.even = clamp(self.brakes.even, alone - self.brakes.friction, alone + self.brakes.friction);
        }
    }

    /// Integrates an error instead, where a flank should carry and no estimate says with what force.
    pub fn lean(&mut self, tables: &CompensationTables<T>, error: T) {
        let next = self.brakes.even + tables.law.integral * error;
        if next.is_finite() {
            self.brakes.even = clamp(next, -tables.limits.motor, tables.limits.motor);
        }
    }

    /// Follows the link's speed: what is asked for has no noise, and a link that is controlled keeps to it.
    fn follow(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>) {
        let asked = situation.link_speed + situation.error_rate;
        let slip = self.slip + tables.switching.smoothing * (situation.error_rate - self.slip);
        let speed = tables.load.friction_slope * (asked - slip);
        if speed.is_finite() {
            (self.slip, self.speed) = (slip, speed);
        }
    }

    /// Learns from a reading while a flank carries. A link that creeps may rub with any part of its friction: what brakes
    /// it is followed then without asking which part it is, until it moves again.
    fn learn(&mut self, tables: &CompensationTables<T>, torque: T) {
        let [growth_even, growth_friction, noise] = tables.load.variances;
        let pace = self.pace();
        let [growth_even, growth_friction] = [growth_even, growth_friction].map(|growth| pace * pace * growth);
        // Once it creeps, a speed that noise may have made does not say that it moves.
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

/// Whether a link of this speed is so slow that it may rub with any part of its friction.
fn creeps<T: Real>(speed: T) -> bool {
    speed < T::ONE && speed > -T::ONE
}

//! The link's inertia, from how it answers mesh forces that change faster than any weight does: a landing, a swing of the
//! teeth, a push. What a motion as slow as a weight's says of it is left out, for the two look the same there.
//!
//! The load side is linear: what it says is what it would say of the same force on a link that stands still, times
//! mobility (1 over the inertia, designed inertia 1), less what it says of the motion alone. The first of these runs along
//! here, an interval at a time. So the answer of the link is known behind the very filter that the force has passed, and
//! a new mobility can be put into the load side as if it had always been known.

use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::observer::filters::load_side::LoadSide;
use crate::observer::tables::InertiaTable;

/// Normalised innovation beyond which something else has moved the link [standard deviations].
const GATE: i32 = 4;

/// The link's mobility, and what it is learnt with.
#[derive(Debug, Clone, Copy)]
pub struct Inertia<T: Real> {
    /// Sum of the meshes' torque over the periods of the interval [N m].
    sum: T,
    /// What the load side would say of the same torque on a link that stands still.
    still: LoadSide<T>,
    /// Slow parts of that torque and of the link's answer, each twice smoothed [N m].
    slow: [[T; 2]; 2],
    /// Designed inertia over the link's.
    mobility: T,
    /// Variance of that.
    variance: T,
    /// Mean square of what pushes the link as fast without any force of the meshes [N^2 m^2].
    restless: T,
    /// Intervals for which the link has gone one way: its dry friction has stayed the same; negative while it goes back.
    gone_for: i32,
}

impl<T: Real> Inertia<T> {
    pub fn new(table: &InertiaTable<T>) -> Self {
        Self {
            sum: T::ZERO,
            still: LoadSide::default(),
            slow: [[T::ZERO; 2]; 2],
            mobility: T::ONE,
            variance: table.prior,
            restless: T::TWO * table.most_restless,
            gone_for: 0,
        }
    }

    /// What is learnt.
    pub fn numbers(&self) -> impl Iterator<Item = T> {
        [self.mobility, self.variance].into_iter()
    }

    /// Takes the same back.
    pub fn set_numbers(&mut self, next: &mut impl FnMut() -> T) {
        self.mobility = next();
        self.variance = next();
    }

    /// Whether the mobility is one that is believed of a link, and no less sure than beforehand.
    pub fn is_possible(&self, table: &InertiaTable<T>) -> bool {
        self.mobility == believed(table, self.mobility)
            && self.variance >= T::ZERO
            && self.variance <= table.prior + table.drift
    }

    /// What the meshes pass on, as the load side takes it; once a period.
    pub fn pass(&mut self, from_meshes: T) -> T {
        self.sum += from_meshes;
        self.mobility * from_meshes
    }

    /// Inertia over the designed one, and its variance.
    pub fn ratio(&self) -> [T; 2] {
        let ratio = T::ONE.over(self.mobility);
        let squared = ratio * ratio;
        [ratio, self.variance * squared * squared]
    }

    /// Once an interval: what the link answered.
    pub fn learn(&mut self, table: &InertiaTable<T>, load: &mut LoadSide<T>, seen: bool) {
        let torque = core::mem::replace(&mut self.sum, T::ZERO) * table.per_periods;
        let before = [self.still.ahead, self.still.speed, self.still.torque];
        let row = |row: &[T; 4]| {
            let [angle, speed, taken, given] = *row;
            angle * before[0] + speed * before[1] + taken * before[2] + given * torque
        };
        let [angle, speed, taken] = &table.still;
        self.still = LoadSide { ahead: row(angle), speed: row(speed), torque: row(taken) };
        let [given, answered] = &mut self.slow;
        let force = fast(given, table.slow, self.still.torque);
        let answer = fast(answered, table.slow, self.mobility * self.still.torque - load.torque);
        let one_way = if !seen {
            0
        } else if load.speed > table.moving && self.gone_for >= 0 {
            self.gone_for.saturating_add(1)
        } else if -load.speed > table.moving && self.gone_for <= 0 {
            self.gone_for.saturating_sub(1)
        } else {
            0
        };
        self.gone_for = one_way;
        if self.variance < table.prior {
            self.variance += table.drift;
        }
        if self.gone_for.unsigned_abs() < table.settled_after {
            return;
        }
        let innovation = answer - self.mobility * force;
        // Where something pushes the link time after time, forces answer it, and not the link the forces.
        let ignorance = self.variance * force * force;
        let beyond = innovation * innovation - ignorance;
        self.restless += ((if beyond > T::ZERO { beyond } else { T::ZERO }) - self.restless) * table.memory;
        if force.abs() < table.least || self.restless > table.most_restless {
            return;
        }
        let expected = table.noise + ignorance;
        if innovation * innovation > T::from_i32(GATE * GATE) * expected {
            return;
        }
        let gain = self.variance * force.over(expected);
        let before = self.mobility;
        self.mobility = believed(table, before + gain * innovation);
        let by = self.mobility - before;
        self.variance -= gain * force * self.variance;
        load.ahead += by * self.still.ahead;
        load.speed += by * self.still.speed;
        load.torque += by * self.still.torque;
    }
}

/// A mobility within what is believed of a link.
fn believed<T: Real>(table: &InertiaTable<T>, mobility: T) -> T {
    T::ONE + clamp(mobility - T::ONE, -table.limit, table.limit)
}

/// What of a value is faster than a weight's changes; its slow parts follow.
fn fast<T: Real>(slow: &mut [T; 2], part: T, value: T) -> T {
    slow.iter_mut().fold(value, |value, slow| {
        *slow += (value - *slow) * part;
        value - *slow
    })
}

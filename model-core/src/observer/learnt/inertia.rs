//! Inertia of the link (O6), from its response to mesh forces that change faster than a weight's torque: a landing, an
//! oscillation of the teeth, a push. Slow responses are not used: weight and inertia are not separable there.
//!
//! The load filter is linear. Its torque is mobility (designed inertia over inertia) times its response to the mesh
//! torque on a stationary link, less its response to the motion alone. The first response is computed here, once per
//! interval. Force and response of the link thus pass one filter, and a changed mobility can be applied to the load
//! side in retrospect.

use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::observer::filters::load_side::LoadSide;
use crate::observer::tables::InertiaTable;

/// Normalised innovation of an outlier, caused by another force on the link [standard deviations].
const GATE: i32 = 4;

/// Estimate of the link's mobility.
#[derive(Debug, Clone, Copy)]
pub struct Inertia<T: Real> {
    /// Sum of the mesh torque over the periods of the interval [N m].
    sum: T,
    /// Response of the load filter to the mesh torque on a stationary link.
    still: LoadSide<T>,
    /// Slow parts of this torque and of the link's response, two stages each [N m].
    slow: [[T; 2]; 2],
    /// Designed inertia over the link's inertia (m) [-].
    mobility: T,
    /// Variance of the mobility [-].
    variance: T,
    /// Mean square of equally fast torques on the link from other sources than the meshes [N^2 m^2].
    restless: T,
    /// Intervals of motion in one direction, with constant dry friction; negative for backward motion.
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

    /// Saved numbers.
    pub fn numbers(&self) -> impl Iterator<Item = T> {
        [self.mobility, self.variance].into_iter()
    }

    /// Restores the saved numbers.
    pub fn set_numbers(&mut self, next: &mut impl FnMut() -> T) {
        self.mobility = next();
        self.variance = next();
    }

    /// Returns true if the mobility is within its limits and its variance does not exceed the initial one.
    pub fn is_possible(&self, table: &InertiaTable<T>) -> bool {
        self.mobility == believed(table, self.mobility)
            && self.variance >= T::ZERO
            && self.variance <= table.prior + table.drift
    }

    /// Scales the mesh torque of a period by the mobility for the load side.
    pub fn pass(&mut self, from_meshes: T) -> T {
        self.sum += from_meshes;
        self.mobility * from_meshes
    }

    /// Inertia over the designed inertia, and its variance [-].
    pub fn ratio(&self) -> [T; 2] {
        let ratio = T::ONE.over(self.mobility);
        let squared = ratio * ratio;
        [ratio, self.variance * squared * squared]
    }

    /// Updates the mobility once per interval with the link's response.
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
        // If external forces push the link repeatedly, mesh forces respond to the link instead of the link to mesh
        // forces.
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

/// Limits a mobility to its range.
fn believed<T: Real>(table: &InertiaTable<T>, mobility: T) -> T {
    T::ONE + clamp(mobility - T::ONE, -table.limit, table.limit)
}

/// Removes the slow parts of a value, and updates them.
fn fast<T: Real>(slow: &mut [T; 2], part: T, value: T) -> T {
    slow.iter_mut().fold(value, |value, slow| {
        *slow += (value - *slow) * part;
        value - *slow
    })
}

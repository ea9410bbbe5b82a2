//! Inertia of the link (O6), from its response to mesh forces that change faster than a weight's torque: a landing, an
//! oscillation of the teeth, a push. Slow responses are not used: weight and inertia are not separable there.
//!
//! The load filter is linear. Its torque is mobility (designed inertia over inertia) times its response to the mesh
//! torque on a stationary link, less its response to the motion alone. The first response is computed here, once per
//! interval. Force and response of the link thus pass one filter, and a changed mobility can be applied to the load
//! side in retrospect.

use super::thresholds::OUTLIER;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::observer::filters::load_side::LoadSide;
use crate::observer::tables::InertiaTable;

/// Estimate of the link's mobility.
#[derive(Debug, Clone, Copy)]
pub struct LinkInertia<T: Real> {
    /// Sum of the mesh torque over the periods of the interval [N m].
    sum: T,
    /// Response of the load filter to the mesh torque on a stationary link.
    stationary_response: LoadSide<T>,
    /// Slow parts of this torque and of the link's response, two stages each [N m].
    slow: [[T; 2]; 2],
    /// Designed inertia over the link's inertia (m) [-].
    mobility: T,
    /// Variance of the mobility [-].
    variance: T,
    /// Mean square of equally fast torques on the link from other sources than the meshes [N^2 m^2].
    external_variance: T,
    /// Intervals of motion in one direction, with constant dry friction; negative for backward motion.
    one_way_intervals: i32,
}

impl<T: Real> LinkInertia<T> {
    pub fn new(table: &InertiaTable<T>) -> Self {
        Self {
            sum: T::ZERO,
            stationary_response: LoadSide::default(),
            slow: [[T::ZERO; 2]; 2],
            mobility: T::ONE,
            variance: table.prior,
            external_variance: T::TWO * table.most_restless,
            one_way_intervals: 0,
        }
    }

    /// Saved numbers.
    pub fn saved_numbers(&self) -> impl Iterator<Item = T> {
        [self.mobility, self.variance].into_iter()
    }

    /// Restores the saved numbers.
    pub fn restore_numbers(&mut self, next_number: &mut impl FnMut() -> T) {
        self.mobility = next_number();
        self.variance = next_number();
    }

    /// Returns true if the mobility is within its limits and its variance does not exceed the initial one.
    pub fn is_in_range(&self, table: &InertiaTable<T>) -> bool {
        self.mobility == limit_mobility(table, self.mobility)
            && self.variance >= T::ZERO
            && self.variance <= table.prior + table.drift
    }

    /// Scales the mesh torque of a period by the mobility for the load side.
    pub fn mesh_torque_for_load(&mut self, from_meshes: T) -> T {
        self.sum += from_meshes;
        self.mobility * from_meshes
    }

    /// Inertia over the designed inertia, and its variance [-].
    pub fn ratio(&self) -> [T; 2] {
        let ratio = T::ONE / self.mobility;
        let squared = ratio * ratio;
        [ratio, self.variance * squared * squared]
    }

    /// Updates the mobility once per interval with the link's response.
    pub fn update(&mut self, table: &InertiaTable<T>, load: &mut LoadSide<T>, is_usable: bool) {
        let torque = core::mem::replace(&mut self.sum, T::ZERO) * table.per_periods;
        let before =
            [self.stationary_response.angle_residual, self.stationary_response.speed, self.stationary_response.torque];
        let row = |row: &[T; 4]| {
            let [angle, speed, torque_row, given] = *row;
            angle * before[0] + speed * before[1] + torque_row * before[2] + given * torque
        };
        let [angle, speed, torque_row] = &table.still;
        self.stationary_response = LoadSide { angle_residual: row(angle), speed: row(speed), torque: row(torque_row) };
        let [given, answered] = &mut self.slow;
        let force = high_pass(given, table.slow, self.stationary_response.torque);
        let answer = high_pass(answered, table.slow, self.mobility * self.stationary_response.torque - load.torque);
        let one_way = if !is_usable {
            0
        } else if load.speed > table.moving && self.one_way_intervals >= 0 {
            self.one_way_intervals.saturating_add(1)
        } else if -load.speed > table.moving && self.one_way_intervals <= 0 {
            self.one_way_intervals.saturating_sub(1)
        } else {
            0
        };
        self.one_way_intervals = one_way;
        if self.variance < table.prior {
            self.variance += table.drift;
        }
        if self.one_way_intervals.unsigned_abs() < table.settled_after {
            return;
        }
        let innovation = answer - self.mobility * force;
        // If external forces push the link repeatedly, mesh forces respond to the link instead of the link to mesh
        // forces.
        let mobility_variance = self.variance * force * force;
        let excess = innovation * innovation - mobility_variance;
        self.external_variance +=
            ((if excess > T::ZERO { excess } else { T::ZERO }) - self.external_variance) * table.memory;
        if force.abs() < table.least || self.external_variance > table.most_restless {
            return;
        }
        let expected = table.noise + mobility_variance;
        if innovation * innovation > T::from_i32(OUTLIER.inertia_sigma * OUTLIER.inertia_sigma) * expected {
            return;
        }
        let gain = self.variance * (force / expected);
        let before = self.mobility;
        self.mobility = limit_mobility(table, before + gain * innovation);
        let change = self.mobility - before;
        self.variance -= gain * force * self.variance;
        load.angle_residual += change * self.stationary_response.angle_residual;
        load.speed += change * self.stationary_response.speed;
        load.torque += change * self.stationary_response.torque;
    }
}

/// Limits a mobility to its range.
fn limit_mobility<T: Real>(table: &InertiaTable<T>, mobility: T) -> T {
    T::ONE + clamp(mobility - T::ONE, -table.limit, table.limit)
}

/// Removes the slow parts of a value, and updates them.
fn high_pass<T: Real>(slow: &mut [T; 2], part: T, value: T) -> T {
    slow.iter_mut().fold(value, |value, slow| {
        *slow += (value - *slow) * part;
        value - *slow
    })
}

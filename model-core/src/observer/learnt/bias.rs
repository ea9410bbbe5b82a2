//! Torque bias and dry friction of the motor, read off inside the gap, where the meshes carry nothing: a recursive least
//! squares for two numbers, both bounded.

use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::observer::tables::ContactTable;

/// Normalised innovation beyond which it was no open gap that was read [standard deviations].
const GATE: i32 = 4;

/// What the motor side sees as force although no mesh carries any: bias + friction * direction [N].
#[derive(Debug, Clone, Copy)]
pub struct Bias<T: Real> {
    pub bias: T,
    pub friction: T,
    /// Variances of both, then their covariance.
    pub variance: [T; 3],
}

impl<T: Real> Bias<T> {
    pub fn new(table: &ContactTable<T>) -> Self {
        Self { bias: T::ZERO, friction: T::ZERO, variance: [table.bias_prior, table.bias_prior, T::ZERO] }
    }

    /// Whether both are no larger than they can become, and no less sure than beforehand.
    pub fn is_possible(&self, table: &ContactTable<T>) -> bool {
        let [bias, friction, both] = self.variance;
        let most = table.bias_prior + table.bias_drift;
        self.bias.abs() <= table.bias_limit
            && self.friction >= T::ZERO
            && self.friction <= table.bias_limit
            && [bias, friction].iter().all(|variance| *variance >= T::ZERO && *variance <= most)
            && both.abs() <= most
    }

    /// Direction of dry friction at a motor speed: from -1 to 1, in proportion where noise hides the sign.
    pub fn direction(table: &ContactTable<T>, speed: T) -> T {
        clamp(speed * table.per_turning, -T::ONE, T::ONE)
    }

    /// Force that is none, for a direction.
    pub fn at(&self, direction: T) -> T {
        self.bias + self.friction * direction
    }

    /// Variance of that.
    pub fn variance_at(&self, direction: T) -> T {
        let [bias, friction, both] = self.variance;
        bias + direction * (T::TWO * both + direction * friction)
    }

    /// Takes in a force read in the open gap.
    pub fn learn(&mut self, table: &ContactTable<T>, force: T, direction: T) {
        let [bias, friction, both] = self.variance;
        let (from_bias, from_friction) = (bias + direction * both, both + direction * friction);
        let expected = table.bias_noise + from_bias + direction * from_friction;
        let innovation = force - self.at(direction);
        // Far from what is believed of them it is no open gap that was read.
        if innovation * innovation > T::from_i32(GATE * GATE) * expected {
            return;
        }
        let (bias_gain, friction_gain) = (from_bias.over(expected), from_friction.over(expected));
        self.bias = clamp(self.bias + bias_gain * innovation, -table.bias_limit, table.bias_limit);
        // Friction never drives.
        let friction_now = clamp(self.friction + friction_gain * innovation, -table.bias_limit, table.bias_limit);
        self.friction = if friction_now > T::ZERO { friction_now } else { T::ZERO };
        self.variance =
            [bias - bias_gain * from_bias, friction - friction_gain * from_friction, both - bias_gain * from_friction];
    }

    /// Everything that is learnt.
    pub fn numbers(&self) -> impl Iterator<Item = T> {
        [self.bias, self.friction].into_iter().chain(self.variance)
    }

    /// Takes the same back.
    pub fn set_numbers(&mut self, next: &mut impl FnMut() -> T) {
        [&mut self.bias, &mut self.friction].into_iter().chain(&mut self.variance).for_each(|number| *number = next());
    }

    /// Lets time pass: one learning interval.
    pub fn age(&mut self, table: &ContactTable<T>) {
        let [bias, friction, _] = &mut self.variance;
        for variance in [bias, friction] {
            if *variance < table.bias_prior {
                *variance += table.bias_drift;
            }
        }
    }
}

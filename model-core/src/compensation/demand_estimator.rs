//! Demand of a motion on the teeth, estimated from the motor's torque alone: free of payload modes and observer errors.
//!
//! ```text
//! (K19)  y = u - k_J J a - f sign(v) - L_0;   k_J' = 4/s y J a/max (J a)^2;   f, L_0 by a Kalman filter
//! (K20)  d = (k_J J - J_m) a + (f - f_m) sign(v) + L_0
//! ```
//!
//! | symbol, referred to the link | identifier |
//! |---|---|
//! | k_J; J a, J_m a | `inertia`; `inertia_torques` |
//! | f, L_0; sign(v) | `load` (`load_friction`); `direction` |
//! | max (J a)^2; f_m; d | `peak_square`; `frictions[0]`; `torque` |
//!
//! (K19) is feedback-error learning (Kawato 1990); the filter begins with the friction of the joint file. d presses a
//! flank beyond a threshold (K21): the friction that the motor may hold at rest, plus the standard deviation of the
//! filter, plus the smallest demand of the monitor.

use super::load_friction::LoadFrictionFilter;
use super::loop_state::friction_direction;
use super::set_point::Motion;
use super::slow_task::SlowTask;
use super::thresholds::{DemandThresholds, EstimateBounds};
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;

/// Demand of a motion on the teeth, with the estimates that it follows from.
#[derive(Debug, Clone)]
pub(super) struct DemandEstimator<T: Real> {
    /// Estimated inertia over the designed inertia [-].
    inertia: T,
    /// Dry friction of motor and link, and gravity torque.
    load: LoadFrictionFilter<T>,
    /// Square of the largest recent torque that accelerates the designed inertia, decaying [N^2 m^2].
    peak_square: T,
    /// Recent torque beyond the torque that accelerates the motor alone, smoothed [N m].
    transmitted: T,
    /// Planned demand on the teeth; `friction_torque`: friction in the planned motor torque [N m].
    torque: T,
    friction_torque: T,
    /// Set-point torque of the last planned demand, until it is used for estimation.
    planned: Option<PlannedTorque<T>>,
}
state_words! {
    struct DemandEstimator<T> {
        inertia, load, peak_square, transmitted, torque, friction_torque, planned,
    }
}

/// Torque that a set-point asks for.
#[derive(Debug, Clone, Copy)]
struct PlannedTorque<T: Real> {
    /// Torque that accelerates the designed inertia, and the motor alone [N m].
    inertia_torques: [T; 2],
    /// Share and sign of dry friction at the planned speed, -1 to 1.
    direction: T,
}
state_words! { struct PlannedTorque<T> { inertia_torques, direction } }

impl<T: Real> DemandEstimator<T> {
    const THRESHOLDS: DemandThresholds<T> = DemandThresholds::TUNED;

    /// Starts from the designed values.
    pub fn new(tables: &CompensationTables<T>) -> Self {
        let [motor, link] = tables.load.frictions;
        let friction = motor + link;
        // Friction on a data sheet may be wrong by a third, and a small friction may be missing.
        let deviation = Self::THRESHOLDS.friction_deviation * friction
            + Self::THRESHOLDS.omitted_friction_deviation * Self::THRESHOLDS.torque_deviation * tables.limits.motor;
        Self {
            inertia: T::ONE,
            load: LoadFrictionFilter::new(friction, [Self::unknown_load_variance(tables), deviation * deviation]),
            peak_square: T::ZERO,
            transmitted: T::ZERO,
            torque: T::ZERO,
            friction_torque: T::ZERO,
            planned: None,
        }
    }

    /// Variance of an unknown load [N^2 m^2].
    fn unknown_load_variance(tables: &CompensationTables<T>) -> T {
        let deviation = Self::THRESHOLDS.unknown_load_deviation * tables.limits.motor;
        deviation * deviation
    }

    /// Resets the planned demand; estimates stay.
    pub fn reset_plan(&mut self) {
        (self.transmitted, self.torque, self.friction_torque, self.planned) = (T::ZERO, T::ZERO, T::ZERO, None);
    }

    /// Planned demand on the teeth [N m].
    pub fn torque(&self) -> T {
        self.torque
    }

    /// Gravity torque [N m].
    pub fn gravity_torque(&self) -> T {
        self.load.gravity_torque
    }

    /// Torque of the motor for a motion without a load [N m].
    pub fn feed_forward(&self, tables: &CompensationTables<T>, now: &Motion<T>) -> T {
        self.inertia * (tables.body.motor_inertia + tables.body.load_inertia) * now.acceleration + self.friction_torque
    }

    /// True if the recent torque has passed more than half of the demand to the teeth, with the sign of the demand.
    pub fn is_transmitted(&self) -> bool {
        let transmitted = if self.torque < T::ZERO { -self.transmitted } else { self.transmitted };
        transmitted > Self::THRESHOLDS.transmitted_share * self.torque.abs()
    }

    /// Resets the variance of the gravity torque, which has changed.
    pub fn reset_load_variance(&mut self, tables: &CompensationTables<T>) {
        self.load.reset_gravity_variance(Self::unknown_load_variance(tables));
    }

    /// Plans the demand of a motion. Returns the demand over the torque that surely presses a flank: above 1 it presses
    /// the drive flank, below -1 the back flank. `None` if the motion is not finite.
    pub fn plan(&mut self, tables: &CompensationTables<T>, now: &Motion<T>) -> Option<T> {
        let [motor_friction, _] = tables.load.frictions;
        let motor_alone = tables.body.motor_inertia * now.acceleration;
        let designed = motor_alone + tables.body.load_inertia * now.acceleration;
        let direction = friction_direction(tables, now.speed);
        let friction_torque = clamp(self.load.friction - motor_friction, T::ZERO, self.load.friction);
        let demand = self.inertia * designed - motor_alone + friction_torque * direction + self.load.gravity_torque;
        if !demand.is_finite() {
            (self.torque, self.friction_torque) = (T::ZERO, T::ZERO);
            return None;
        }
        self.friction_torque = self.load.friction * direction;
        // A set-point may ask for any torque; the motor is bound to its limit, and the teeth pass at most twice that
        // limit.
        let most = T::TWO * tables.limits.motor;
        self.torque = clamp(demand, -most, most);
        self.planned =
            (designed.abs() <= most).then_some(PlannedTorque { inertia_torques: [designed, motor_alone], direction });
        let held = motor_friction * (T::ONE - direction.abs());
        let deviation = self.load.variance(direction).square_root();
        Some(self.torque / (tables.watch.least_demand + held + deviation))
    }

    /// Updates the estimates by the torque of one of [`SlowTask::periods`] periods [N m].
    // Not inlined: fewer instructions per tick on a Cortex-M4F, because the controlling law keeps its registers.
    #[inline(never)]
    pub fn estimate(&mut self, tables: &CompensationTables<T>, torque: T) {
        let Some(PlannedTorque { inertia_torques: [designed, motor_alone], direction }) = self.planned.take() else {
            return;
        };
        let limit = tables.limits.motor;
        let time = SlowTask::periods::<T>() * tables.clock.period;
        let braking_torque = torque - self.inertia * designed;
        let square = designed * designed;
        if !(braking_torque.is_finite() && square.is_finite()) {
            return;
        }
        self.transmitted +=
            SlowTask::periods::<T>() * tables.law.back_calculation * (torque - motor_alone - self.transmitted);
        let share = Self::THRESHOLDS.inertia_rate * time;
        let decayed = self.peak_square - T::HALF * share * self.peak_square;
        self.peak_square = if square > decayed { square } else { decayed };
        let min_torque = Self::THRESHOLDS.inertia_min_torque * limit;
        if self.peak_square > min_torque * min_torque {
            let excess = braking_torque - self.load.torque(direction);
            // The link inertia stays within a quarter to four times the designed value, as everywhere.
            let correction = T::TWO * share * (excess * designed / self.peak_square);
            let link = tables.body.load_share;
            let [lightest, heaviest] =
                EstimateBounds::<T>::TUNED.link_inertia_ratio.map(|ratio| T::ONE + link * (ratio - T::ONE));
            self.inertia = clamp(self.inertia + correction, lightest, heaviest);
        }
        // At rest friction may hold any part of the torque.
        let (unexplained, held) =
            (Self::THRESHOLDS.torque_deviation * limit, self.load.friction * (T::ONE - direction.abs()));
        let noise = unexplained * unexplained + held * held;
        self.load.predict(Self::THRESHOLDS.load_rates.map(|rate| rate * time * (rate * time) * noise));
        self.load.correct(braking_torque, direction, noise, Self::THRESHOLDS.max_friction * limit);
        self.load.gravity_torque = clamp(self.load.gravity_torque, -limit, limit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::tables;

    fn motion(speed: f64, acceleration: f64) -> Motion<f64> {
        Motion { speed, acceleration, ..Motion::default() }
    }

    #[test]
    fn demand_of_an_acceleration_is_that_of_the_link() {
        let mut demand = DemandEstimator::new(&tables());
        demand.plan(&tables(), &motion(0.0, 1.0)).expect("a number");
        assert_eq!(demand.torque(), 3.0);
    }

    #[test]
    fn motion_that_is_not_finite_demands_nothing() {
        let mut demand = DemandEstimator::new(&tables());
        for acceleration in [f64::NAN, f64::INFINITY] {
            assert_eq!(demand.plan(&tables(), &motion(0.1, acceleration)), None);
            assert_eq!(demand.torque(), 0.0);
        }
    }

    #[test]
    fn demand_is_bounded_to_twice_the_motor_limit() {
        let mut demand = DemandEstimator::new(&tables());
        demand.plan(&tables(), &motion(0.0, -1e6)).expect("a number");
        assert_eq!(demand.torque(), -20.0);
    }

    #[test]
    fn inertia_stays_within_its_bounds() {
        for (torque, inertia) in [(1e3, 3.25), (-1e3, 0.4375)] {
            let mut demand = DemandEstimator::new(&tables());
            for _ in 0..2000 {
                demand.plan(&tables(), &motion(0.0, 2.0)).expect("a number");
                demand.estimate(&tables(), torque);
            }
            assert_eq!(demand.inertia, inertia);
        }
    }

    #[test]
    fn small_acceleration_does_not_show_the_inertia() {
        let inertia = |acceleration: f64| {
            let mut demand = DemandEstimator::new(&tables());
            demand.plan(&tables(), &motion(0.0, acceleration)).expect("a number");
            demand.estimate(&tables(), 5.0);
            demand.inertia
        };
        // A twentieth of the motor's limit accelerates 4 kg m^2 by 0.125 rad/s^2.
        assert_eq!(inertia(0.124), 1.0);
        assert!(inertia(0.126) > 1.0);
    }

    #[test]
    fn torque_that_is_no_number_estimates_nothing() {
        let mut demand = DemandEstimator::new(&tables());
        demand.plan(&tables(), &motion(0.0, 2.0)).expect("a number");
        demand.estimate(&tables(), f64::NAN);
        assert_eq!((demand.inertia, demand.gravity_torque()), (1.0, 0.0));
    }

    #[test]
    fn half_of_the_demand_at_the_teeth_counts_as_transmitted() {
        let transmitted = |torque: f64, transmitted: f64| {
            DemandEstimator { torque, transmitted, ..DemandEstimator::new(&tables()) }.is_transmitted()
        };
        assert!(!transmitted(4.0, 2.0) && transmitted(4.0, 2.1) && transmitted(-4.0, -2.1));
        assert!(!transmitted(4.0, -2.1));
    }

    #[test]
    fn friction_is_at_most_half_of_limit() {
        let mut demand = DemandEstimator::new(&tables());
        for period in 0..2000 {
            let side = if (period / 10) % 2 == 0 { 1.0 } else { -1.0 };
            demand.plan(&tables(), &motion(0.1 * side, 0.0)).expect("a number");
            demand.estimate(&tables(), 9.0 * side);
        }
        assert_eq!(demand.load.friction, 5.0);
    }
}

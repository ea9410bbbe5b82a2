//! Easing of a load at rest that may be friction alone: a link that friction holds wound up keeps the motor on a flank
//! for no use, and perhaps on the wrong flank for the next motion. The load is reduced until friction holds the link or
//! the link gives way.

use super::load::LoadModel;
use super::loop_state::LoopState;
use super::thresholds::EasingThresholds;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{clamp, deadband};
use crate::numbers::state_words::state_words;

/// State of the easing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Easing<T: Real> {
    /// Load at the beginning of the steady time [N m].
    load: T,
    /// Time for which the load has been steady, saturating [s].
    steady_time: T,
    /// Set-point less link at the beginning of the easing; `None` while the load is held [rad].
    start_error: Option<T>,
    /// True if the link gave way: the load is more than friction, and is held until the joint has moved.
    gave_way: bool,
}
state_words! { struct Easing<T> { load, steady_time, start_error, gave_way } }

impl<T: Real> Easing<T> {
    const THRESHOLDS: EasingThresholds<T> = EasingThresholds::TUNED;

    pub fn new() -> Self {
        Self { load: T::ZERO, steady_time: T::ZERO, start_error: None, gave_way: false }
    }

    /// Updates the easing by a period. Returns the share of the load to be held [-]: a half while eased, so that the
    /// load fades as fast as it is followed, because friction takes over the part that the teeth no longer pass.
    pub fn step(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        state: &LoopState<T>,
        rests: bool,
        friction_holds: bool,
    ) -> T {
        if !rests {
            *self = Self::new();
            return T::ONE;
        }
        let max_travel = Self::THRESHOLDS.max_travel * tables.rest.first_deadband * state.half_gap;
        let gives_way = |start_error: T| !friction_holds || (state.error - start_error).abs() > max_travel;
        self.gave_way = (self.gave_way || self.start_error.is_some_and(gives_way)) && !load.external_impact(tables);
        let measured = tables.switching.measured;
        let least = measured * tables.switching.least;
        let is_felt = deadband(load.gravity_torque(), least) != T::ZERO;
        let may_be_friction = deadband(load.gravity_torque(), measured + measured + load.friction()) == T::ZERO;
        let is_steady = deadband(state.error, max_travel) == T::ZERO
            && deadband(load.gravity_torque() - self.load, least) == T::ZERO;
        let may_ease = friction_holds && !self.gave_way && is_felt && may_be_friction;
        if !may_ease || self.start_error.is_none() && !is_steady {
            *self = Self { load: load.gravity_torque(), steady_time: T::ZERO, start_error: None, ..*self };
            return T::ONE;
        }
        self.steady_time = clamp(self.steady_time + tables.clock.period, T::ZERO, tables.rest.hunting);
        if self.steady_time >= tables.rest.hunting {
            self.start_error = self.start_error.or(Some(state.error));
        }
        if self.start_error.is_some() { Self::THRESHOLDS.held_share } else { T::ONE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{state, tables};
    use crate::observer::Estimates;

    /// Steady time before the load is eased [periods].
    const STEADY: u32 = 1500;

    /// Returns the share that is held after a steady load at rest [N m] and `periods`, at an error over the largest
    /// travel of a steady load.
    fn held(gravity_torque: f64, friction: f64, error: f64, periods: u32) -> f64 {
        let (tables, load, mut easing) = (tables(), LoadModel::of_known(gravity_torque, friction), Easing::new());
        let max_travel = 0.5 * tables.rest.first_deadband * state().half_gap;
        let state = LoopState { error: error * max_travel, ..state() };
        // The first period records the load.
        (0..periods).for_each(|_| _ = easing.step(&tables, &load, &state, true, true));
        easing.step(&tables, &load, &state, true, true)
    }

    #[test]
    fn steady_load_within_friction_is_eased() {
        assert_eq!((held(1.0, 2.0, 0.0, STEADY - 5), held(1.0, 2.0, 0.0, STEADY + 5)), (1.0, 0.5));
    }

    #[test]
    fn load_beyond_friction_is_held() {
        // Friction and twice the uncertainty of torques.
        assert_eq!((held(2.39, 2.0, 0.0, STEADY + 5), held(2.41, 2.0, 0.0, STEADY + 5)), (0.5, 1.0));
        assert_eq!(held(-2.41, 2.0, 0.0, STEADY + 5), 1.0);
    }

    #[test]
    fn load_within_the_noise_is_held() {
        assert_eq!((held(0.059, 2.0, 0.0, STEADY + 5), held(0.061, 2.0, 0.0, STEADY + 5)), (1.0, 0.5));
    }

    #[test]
    fn error_beyond_the_travel_keeps_the_load() {
        assert_eq!((held(1.0, 2.0, 0.9, STEADY + 5), held(1.0, 2.0, 1.1, STEADY + 5)), (0.5, 1.0));
    }

    #[test]
    fn link_that_gives_way_keeps_the_load_until_it_moves() {
        let (tables, load, mut easing) = (tables(), LoadModel::of_known(1.0, 2.0), Easing::new());
        let at = |error: f64| LoopState { error, ..state() };
        (0..STEADY + 5).for_each(|_| _ = easing.step(&tables, &load, &at(0.0), true, true));
        assert_eq!(easing.step(&tables, &load, &at(1e-4), true, true), 1.0);
        (0..2 * STEADY).for_each(|_| assert_eq!(easing.step(&tables, &load, &at(0.0), true, true), 1.0));
        assert_eq!(easing.step(&tables, &load, &at(0.0), false, true), 1.0);
        (0..STEADY + 5).for_each(|_| _ = easing.step(&tables, &load, &at(0.0), true, true));
        assert_eq!(easing.step(&tables, &load, &at(0.0), true, true), 0.5);
    }

    #[test]
    fn link_that_friction_does_not_hold_keeps_the_load() {
        let (tables, load, mut easing) = (tables(), LoadModel::of_known(1.0, 2.0), Easing::new());
        (0..2 * STEADY).for_each(|_| assert_eq!(easing.step(&tables, &load, &state(), true, false), 1.0));
    }

    #[test]
    fn push_lets_the_load_be_eased_again() {
        let (tables, mut easing) = (tables(), Easing { gave_way: true, ..Easing::new() });
        let mut estimates = Estimates::default();
        (estimates.load_torque.value, estimates.load_torque.valid) = (8.1, true);
        let mut pushed = LoadModel::of_known(1.0, 2.0);
        pushed.update(&tables, &estimates, &state(), true);
        easing.step(&tables, &pushed, &state(), true, true);
        assert!(!easing.gave_way);
    }
}

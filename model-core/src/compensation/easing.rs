//! Easing of a load at rest that may be friction alone: a link that friction holds wound up keeps the motor on a flank
//! for no use, and perhaps on the wrong flank for the next motion. The load is reduced until friction holds the link or
//! the link gives way.

use super::load::LoadModel;
use super::loop_state::LoopState;
use super::thresholds::EasingThresholds;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{beyond, clamp};

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

impl<T: Real> Easing<T> {
    const THRESHOLDS: EasingThresholds<T> = EasingThresholds::VALUES;

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
        let is_felt = beyond(load.gravity_torque(), least) != T::ZERO;
        let may_be_friction = beyond(load.gravity_torque(), measured + measured + load.friction()) == T::ZERO;
        let is_steady =
            beyond(state.error, max_travel) == T::ZERO && beyond(load.gravity_torque() - self.load, least) == T::ZERO;
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

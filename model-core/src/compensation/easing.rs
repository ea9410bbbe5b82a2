//! Easing of a load at rest that may be friction alone: a link that friction holds wound up keeps the motor on a flank
//! for no use, and perhaps on the wrong flank for the next motion. The load is reduced until friction holds the link or
//! the link gives way.

use super::load::LoadModel;
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{clamp, deadband};

/// State of the easing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Easing<T: Real> {
    /// Load at the beginning of the steady time [N m].
    load: T,
    /// Time for which the load has been steady, saturating [s].
    steady: T,
    /// Set-point less link at the beginning of the easing; `None` while the load is held [rad].
    place: Option<T>,
    /// True if the link gave way: the load is more than friction, and is held until the joint has moved.
    gave_way: bool,
}

impl<T: Real> Easing<T> {
    /// Largest error of a steady load, and travel by which the link gives way, over the first dead band [-]: two counts
    /// of a good encoder.
    const SLIGHT: T = T::HALF;

    pub fn new() -> Self {
        Self { load: T::ZERO, steady: T::ZERO, place: None, gave_way: false }
    }

    /// Updates the easing by a period. Returns the share of the load to be held [-]: a half while eased, so that the
    /// load fades as fast as it is followed, because friction takes over the part that the teeth no longer pass.
    pub fn step(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        rests: bool,
        stands: bool,
    ) -> T {
        if !rests {
            *self = Self::new();
            return T::ONE;
        }
        let slight = Self::SLIGHT * tables.rest.first_deadband * situation.half;
        let gives_way = |place: T| !stands || (situation.error - place).abs() > slight;
        self.gave_way = (self.gave_way || self.place.is_some_and(gives_way)) && !load.throws(tables);
        let measured = tables.switching.measured;
        let least = measured * tables.switching.least;
        let is_felt = deadband(load.even(), least) != T::ZERO;
        let may_be_friction = deadband(load.even(), measured + measured + load.friction()) == T::ZERO;
        let is_steady =
            deadband(situation.error, slight) == T::ZERO && deadband(load.even() - self.load, least) == T::ZERO;
        let goes_on = stands && !self.gave_way && is_felt && may_be_friction;
        if !goes_on || self.place.is_none() && !is_steady {
            *self = Self { load: load.even(), steady: T::ZERO, place: None, ..*self };
            return T::ONE;
        }
        self.steady = clamp(self.steady + tables.clock.period, T::ZERO, tables.rest.hunting);
        if self.steady >= tables.rest.hunting {
            self.place = self.place.or(Some(situation.error));
        }
        if self.place.is_some() { T::HALF } else { T::ONE }
    }
}

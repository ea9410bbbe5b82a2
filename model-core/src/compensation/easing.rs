//! A load at rest that may be nothing but friction is let go of: a link that friction holds wound up against its flank keeps
//! the motor there for nothing, on what may be the wrong flank for what comes next.

use super::load::LoadModel;
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{beyond, clamp};

/// Whether the load is let go of, and what came of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Easing<T: Real> {
    /// The load that has been steady [N m].
    load: T,
    /// For how long, as far as that matters [s].
    steady: T,
    /// Where the link was when its load was let go of, from the set-point, while it is [rad].
    place: Option<T>,
    /// Whether the link gave way: what loads it is more than friction, and is held until the joint has moved.
    gave_way: bool,
}

impl<T: Real> Easing<T> {
    /// Error that is let be while the load is let go of, and travel by which the link gives way, over the first deadband [-]:
    /// two counts of a good encoder.
    const SLIGHT: T = T::HALF;

    pub fn new() -> Self {
        Self { load: T::ZERO, steady: T::ZERO, place: None, gave_way: false }
    }

    /// Takes in whether the joint is asked to rest and whether its link stands still. The part of the load that is to be held
    /// [-]: half of it while it is let go of, so that it fades as fast as it is followed, for friction takes over what the
    /// teeth do not pass on.
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
        let is_felt = beyond(load.even(), least) != T::ZERO;
        let may_be_friction = beyond(load.even(), measured + measured + load.friction()) == T::ZERO;
        let is_steady = beyond(situation.error, slight) == T::ZERO && beyond(load.even() - self.load, least) == T::ZERO;
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

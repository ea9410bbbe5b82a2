//! Teeth that are pressed together for sure, at rest or not: what is learnt from them before they leave and soon after they
//! have landed, where one flank is met next to the other. What settled contact shows is left to `interval`.

use super::contact::{sign, with_hysteresis};
use super::motion::magnitude;
use super::state::Observer;
use crate::numbers::Real;
use parameters::ContactState;

/// Intervals of a touch that ended early from which it is learnt, once the width is known.
const LEAST: u8 = 2;

/// Standard deviations of one way's noise by which a force that changes may move the way while its estimate lags behind.
const LAGGING: i32 = 4;

/// The same by which the wind-up changes in an interval where teeth may part.
const FALLING: i32 = 2;

/// Standard deviations of the steady force above which teeth are pressed that no way confirms yet.
const UNCONFIRMED: i32 = 4;

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// The flank on which teeth are pressed by more than any bias, while the force does not change so fast that the lag of
    /// its estimate would matter; `Separated` where that is not sure. Once the width is known, the way has to agree. The way
    /// is less the transmission error [m], and the force with its rise is an interval's [N].
    pub(super) fn pressed(&self, way: T, force: T, rise: T) -> ContactState {
        let known = &self.knowledge;
        let table = &self.tables.learner;
        let [_, compliance] = self.shape();
        let lags = magnitude(rise) * compliance * table.force_lag;
        if lags > T::from_i32(LAGGING) * table.noise {
            return ContactState::Separated;
        }
        if !known.width_is_known {
            return self.pressed_by_force(force);
        }
        if magnitude(force) <= T::THREE * known.mean_force_deviation {
            return ContactState::Separated;
        }
        let position = self.by_position(way, T::ZERO, T::ZERO);
        let (contact, _) = position.contact(ContactState::Separated, force, known.both_deviation);
        if sign::<T>(contact) * force > T::ZERO { contact } else { ContactState::Separated }
    }

    /// The flank that an interval's force tells alone [N]. Motors that are held coarsely shake more from interval to interval
    /// than teeth press that meet softly, so it takes the steady force to be sure; that lags, so the present one has to agree.
    fn pressed_by_force(&self, force: T) -> ContactState {
        let known = &self.knowledge;
        let told = |force: T, least: T| with_hysteresis(ContactState::Separated, force, least, least);
        let steadily = told(self.interval.steady, T::from_i32(UNCONFIRMED) * known.steady_force_deviation);
        let now = told(force, T::TWO * known.mean_force_deviation);
        if steadily == now { now } else { ContactState::Separated }
    }

    /// Whether teeth that are felt on a side stay there until the interval is over: what is measured of the force lags, so
    /// teeth that part seem to be pressed still. Once the width is known, the way says so sooner. The rise is an interval's of
    /// the steady force [N].
    pub(super) fn lasts(&self, side: T, rise: T) -> bool {
        let known = &self.knowledge;
        let table = &self.tables.learner;
        let [_, compliance] = self.shape();
        let falls = -side * rise * compliance > T::from_i32(FALLING) * table.noise;
        let ahead = self.interval.steady + (T::ONE + table.force_lag) * rise;
        known.width_is_known || !falls || side * ahead > known.force_deviation
    }

    /// Intervals of a touch that ended early from which it is learnt. Until the width is known, half a block of rest counts
    /// too: a link that is thrown to and fro rests no longer than that on a flank.
    pub(super) fn least_intervals(&self) -> u8 {
        if self.knowledge.width_is_known { LEAST } else { (self.tables.learner.block as u8).div_ceil(2) }
    }
}

//! Which way a joint at rest is likely to start: on or back, as it did the last time. Most motions that nobody foresees go
//! to and fro or on and on, and which of them it is the last start tells.

use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// What the last rests and starts were like.
#[derive(Debug, Clone, Copy)]
pub(super) struct StartPrediction<T: Real> {
    /// The flank that the motion went towards last; `None` before it has gone.
    came: Option<Flank>,
    /// Whether it went on from its last rest, rather than back; `None` before it has done either.
    goes_on: Option<bool>,
    /// Whether it has been asked to rest since it went.
    rests: bool,
    /// For how long the link has stood still, as far as that matters [s].
    stood: T,
    /// Where, from the set-point [rad].
    place: T,
}

impl<T: Real> StartPrediction<T> {
    /// How long a link has to stand still for it to be held by friction, as a part of the time of hunting [-].
    const STANDS: T = T::QUARTER;

    /// Travel of a link that stands still, as a part of the half-gap [-]: its speed is too rough, it flickers with the last
    /// count of the encoder.
    const STILL: T = T::EIGHTH;

    pub fn new() -> Self {
        Self { came: None, goes_on: None, rests: false, stood: T::ZERO, place: T::ZERO }
    }

    /// How long it has to stand still [s].
    fn enough(tables: &CompensationTables<T>) -> T {
        Self::STANDS * tables.rest.hunting
    }

    /// Whether friction holds the link of a joint that is asked to rest.
    pub fn stands(&self, tables: &CompensationTables<T>) -> bool {
        self.stood >= Self::enough(tables)
    }

    /// Takes in a period and which way it is asked to go. The flank towards which a joint at rest is likely to start; `None`
    /// if nothing tells or if its link does not stand still: one that no friction holds needs its flank for itself.
    pub fn step(
        &mut self,
        tables: &CompensationTables<T>,
        situation: &Situation<T>,
        direction: T,
        rests: bool,
    ) -> Option<Flank> {
        if rests {
            self.rests = true;
            let enough = Self::enough(tables);
            if (situation.error - self.place).abs() > Self::STILL * situation.half {
                (self.place, self.stood) = (situation.error, T::ZERO);
            }
            self.stood = clamp(self.stood + tables.clock.period, T::ZERO, enough);
            if !self.stands(tables) {
                return None;
            }
            let goes_on = self.goes_on?;
            return self.came.map(|came| if goes_on { came } else { came.opposite() });
        }
        self.stood = T::ZERO;
        if let Some(goes) = Flank::towards(direction) {
            if self.rests {
                self.goes_on = self.came.map(|came| came == goes);
            }
            (self.came, self.rests) = (Some(goes), false);
        }
        None
    }
}

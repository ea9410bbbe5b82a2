//! Prediction of the next start of a joint at rest, without a preview: the start continues or reverses as the last
//! start did, because most unforeseen motions go to and fro or on and on.

use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Record of the last rest and start.
#[derive(Debug, Clone, Copy)]
pub(super) struct StartPrediction<T: Real> {
    /// Flank of the last motion; `None` before the first motion.
    came: Option<Flank>,
    /// True if the last start continued the motion before the rest, false if it reversed; `None` before the first such
    /// start.
    goes_on: Option<bool>,
    /// True if the joint was asked to rest since its last motion.
    rests: bool,
    /// Time for which the link has stood still, saturating [s].
    stood: T,
    /// Position less set-point at which the link stands [rad].
    place: T,
}

impl<T: Real> StartPrediction<T> {
    /// Time of standing still after which friction holds the link, over `rest.hunting` [-].
    const STANDS: T = T::QUARTER;

    /// Travel below which the link stands still, over the half-gap [-]; the speed is too coarse, because it flickers
    /// with the last count of the encoder.
    const STILL: T = T::EIGHTH;

    pub fn new() -> Self {
        Self { came: None, goes_on: None, rests: false, stood: T::ZERO, place: T::ZERO }
    }

    /// Time of standing still after which friction holds the link [s].
    fn enough(tables: &CompensationTables<T>) -> T {
        Self::STANDS * tables.rest.hunting
    }

    /// True if friction holds the link of a joint that is asked to rest.
    pub fn stands(&self, tables: &CompensationTables<T>) -> bool {
        self.stood >= Self::enough(tables)
    }

    /// Updates the record by the direction asked for in a period. Returns the flank of the next start of a joint at
    /// rest; `None` without a record, or if the link does not stand still: a link that friction does not hold needs its
    /// present flank.
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

//! Prediction of the next start of a joint at rest, without a preview: the start continues or reverses as the last
//! start did, because most unforeseen motions go to and fro or on and on.

use super::loop_state::LoopState;
use super::thresholds::StartThresholds;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Record of the last rest and start.
#[derive(Debug, Clone, Copy)]
pub(super) struct StartPrediction<T: Real> {
    /// Flank of the last motion; `None` before the first motion.
    last_flank: Option<Flank>,
    /// True if the last start continued the motion before the rest, false if it reversed; `None` before the first such
    /// start.
    continues: Option<bool>,
    /// True if the joint was asked to rest since its last motion.
    rests: bool,
    /// Time for which the link has stood still, saturating [s].
    standstill_time: T,
    /// Position less set-point at which the link stands [rad].
    standstill_error: T,
}

impl<T: Real> StartPrediction<T> {
    const THRESHOLDS: StartThresholds<T> = StartThresholds::VALUES;

    pub fn new() -> Self {
        Self { last_flank: None, continues: None, rests: false, standstill_time: T::ZERO, standstill_error: T::ZERO }
    }

    /// Time of standing still after which friction holds the link [s].
    fn required_standstill(tables: &CompensationTables<T>) -> T {
        Self::THRESHOLDS.standstill_time * tables.rest.hunting
    }

    /// True if friction holds the link of a joint that is asked to rest.
    pub fn friction_holds(&self, tables: &CompensationTables<T>) -> bool {
        self.standstill_time >= Self::required_standstill(tables)
    }

    /// Updates the record by the direction asked for in a period. Returns the flank of the next start of a joint at
    /// rest; `None` without a record, or if the link does not stand still: a link that friction does not hold needs its
    /// present flank.
    pub fn step(
        &mut self,
        tables: &CompensationTables<T>,
        state: &LoopState<T>,
        direction: T,
        rests: bool,
    ) -> Option<Flank> {
        if rests {
            self.rests = true;
            let required_standstill = Self::required_standstill(tables);
            if (state.error - self.standstill_error).abs() > Self::THRESHOLDS.standstill_travel * state.half_gap {
                (self.standstill_error, self.standstill_time) = (state.error, T::ZERO);
            }
            self.standstill_time = clamp(self.standstill_time + tables.clock.period, T::ZERO, required_standstill);
            if !self.friction_holds(tables) {
                return None;
            }
            let continues = self.continues?;
            return self.last_flank.map(|last_flank| if continues { last_flank } else { last_flank.opposite() });
        }
        self.standstill_time = T::ZERO;
        if let Some(goes) = Flank::towards(direction) {
            if self.rests {
                self.continues = self.last_flank.map(|last_flank| last_flank == goes);
            }
            (self.last_flank, self.rests) = (Some(goes), false);
        }
        None
    }
}

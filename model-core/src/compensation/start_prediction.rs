//! Prediction of the next start of a joint at rest, without a preview: the start continues or reverses as the last
//! start did, because most unforeseen motions go to and fro or on and on.

use super::loop_state::LoopState;
use super::thresholds::StartThresholds;
use crate::compensation::tables::CompensationTables;
use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;

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
state_words! { struct StartPrediction<T> { last_flank, continues, rests, standstill_time, standstill_error } }

impl<T: Real> StartPrediction<T> {
    const THRESHOLDS: StartThresholds<T> = StartThresholds::TUNED;

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
        if let Some(flank) = Flank::towards(direction) {
            if self.rests {
                self.continues = self.last_flank.map(|last_flank| last_flank == flank);
            }
            (self.last_flank, self.rests) = (Some(flank), false);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{state, tables};

    /// Time after which friction holds the link [periods].
    const STANDSTILL: u32 = 375;

    /// Moves in a direction, then rests.
    fn move_and_rest(start: &mut StartPrediction<f64>, direction: f64, periods: u32) -> Option<Flank> {
        start.step(&tables(), &state(), direction, false);
        (0..periods).fold(None, |_, _| start.step(&tables(), &state(), 0.0, true))
    }

    #[test]
    fn joint_that_never_moved_predicts_nothing() {
        let mut start = StartPrediction::new();
        (0..2 * STANDSTILL).for_each(|_| assert_eq!(start.step(&tables(), &state(), 0.0, true), None));
    }

    #[test]
    fn first_motion_predicts_nothing() {
        assert_eq!(move_and_rest(&mut StartPrediction::new(), 1.0, STANDSTILL + 1), None);
    }

    #[test]
    fn motion_that_went_on_is_expected_to_go_on() {
        let mut start = StartPrediction::new();
        move_and_rest(&mut start, 1.0, STANDSTILL + 1);
        assert_eq!(move_and_rest(&mut start, 1.0, STANDSTILL + 1), Some(Flank::Drive));
    }

    #[test]
    fn motion_that_reversed_is_expected_to_reverse() {
        let mut start = StartPrediction::new();
        move_and_rest(&mut start, 1.0, STANDSTILL + 1);
        assert_eq!(move_and_rest(&mut start, -1.0, STANDSTILL + 1), Some(Flank::Drive));
    }

    #[test]
    fn link_is_held_after_the_standstill() {
        let mut start = StartPrediction::new();
        move_and_rest(&mut start, 1.0, STANDSTILL - 2);
        assert!(!start.friction_holds(&tables()));
        (0..4).for_each(|_| _ = start.step(&tables(), &state(), 0.0, true));
        assert!(start.friction_holds(&tables()));
    }

    #[test]
    fn travel_beyond_an_eighth_of_the_half_gap_restarts_the_standstill() {
        for (travel, holds) in [(0.12, true), (0.13, false)] {
            let mut start = StartPrediction::new();
            move_and_rest(&mut start, 1.0, STANDSTILL + 1);
            let moved = LoopState { error: travel * state().half_gap, ..state() };
            start.step(&tables(), &moved, 0.0, true);
            assert_eq!(start.friction_holds(&tables()), holds, "{travel}");
        }
    }
}

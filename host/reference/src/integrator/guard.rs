//! Guards: functions of the state that are positive while the mode holds. `event` finds where one turns negative.

/// Quantity that stays positive while the mode of a system holds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Guard {
    /// Negative once the mode no longer holds.
    pub value: f64,
    /// Rate of change of `value` [1/s].
    pub rate: f64,
}

/// Greatest number of guards of a system.
pub const MAX_GUARDS: usize = 20;

/// Guards of a system at one time.
#[derive(Debug, Clone, Copy)]
pub struct Guards {
    pub(super) list: [Guard; MAX_GUARDS],
    pub(super) length: usize,
}

impl Guards {
    pub(super) fn none() -> Self {
        Self { list: [Guard::default(); MAX_GUARDS], length: 0 }
    }

    /// Adds a guard; the order must not change within a mode.
    pub fn watch(&mut self, value: f64, rate: f64) {
        self.list[self.length] = Guard { value, rate };
        self.length += 1;
    }
}

//! Switched system: smooth within a discrete mode, with guards that turn negative where the mode ends.

use super::guard::Guards;

/// Greatest number of entries of a state.
pub const MAX_ENTRIES: usize = 21;

/// State or its rates; only the first `dimension` entries count.
pub type Entries = [f64; MAX_ENTRIES];

/// System that is smooth between events.
pub trait SwitchedSystem {
    /// Number of entries in use.
    fn dimension(&self) -> usize;
    /// Rates of change of the state, in the selected mode.
    fn derivative(&self, time: f64, state: &Entries, rates: &mut Entries);
    /// Selects the mode from the state.
    fn select_mode(&mut self, time: f64, state: &Entries);
    /// Lists the guards of the mode; none is negative just after `select_mode` at an equal state.
    fn guards(&self, time: f64, state: &Entries, rates: &Entries, guards: &mut Guards);
    /// Depth below zero at which a guard's event is declared.
    fn guard_resolution(&self) -> f64;
    /// Error tolerance of one step in an entry.
    fn tolerance(&self, entry: usize) -> f64;
    /// Longest step within the mode: no guard may have more than one extremum within it [s].
    fn longest_step(&self) -> f64;
}

//! A switched system: smooth within a discrete mode, with guards that turn negative where the mode ends.

use super::guard::Guards;

/// The most entries that a state may have.
pub const MAX_ENTRIES: usize = 21;

/// A state or its rates; only the first `dimension` entries count.
pub type Entries = [f64; MAX_ENTRIES];

/// A system that is smooth between events.
pub trait SwitchedSystem {
    /// Number of entries in use.
    fn dimension(&self) -> usize;
    /// Rates of change of the state, in the selected mode.
    fn derivative(&self, time: f64, state: &Entries, rates: &mut Entries);
    /// Selects the mode from the state.
    fn select_mode(&mut self, time: f64, state: &Entries);
    /// Lists the guards of the mode: never negative just after `select_mode` at the same state.
    fn guards(&self, time: f64, state: &Entries, rates: &Entries, guards: &mut Guards);
    /// How far below zero a guard may be when its event is declared.
    fn guard_resolution(&self) -> f64;
    /// Error that one step may make in an entry.
    fn tolerance(&self, entry: usize) -> f64;
    /// Longest step within the mode: no guard may have more than one extremum within it [s].
    fn longest_step(&self) -> f64;
}

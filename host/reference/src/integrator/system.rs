//! What is integrated: a system that is smooth as long as some choices are frozen, and says when they no longer hold.

use super::guard::Guards;

/// The most entries that a state may have.
pub const MAX_ENTRIES: usize = 20;

/// A state or its rates; only the first `dimension` entries count.
pub type Entries = [f64; MAX_ENTRIES];

/// A system that is smooth between events.
pub trait SwitchedSystem {
    /// Number of entries in use.
    fn dimension(&self) -> usize;
    /// Rates of change of the state, under the frozen choices.
    fn derivative(&self, time: f64, state: &Entries, rates: &mut Entries);
    /// Decides the choices from the state and freezes them.
    fn freeze(&mut self, time: f64, state: &Entries);
    /// Lists the guards of the frozen choices: never negative just after `freeze` at the same state.
    fn guards(&self, time: f64, state: &Entries, rates: &Entries, guards: &mut Guards);
    /// How far below zero a guard may be when its event is declared.
    fn guard_resolution(&self) -> f64;
    /// Error that one step may make in an entry.
    fn tolerance(&self, entry: usize) -> f64;
    /// Longest step under the frozen choices: no guard may have more than one extremum within it [s].
    fn longest_step(&self) -> f64;
}

//! Resolution of an encoder: the angle of a count, and its words.

use std::f64::consts::TAU;

/// Returns the angle of a count of an encoder with so many counts in a turn [rad].
pub fn count_angle(turn: u64) -> f64 {
    TAU / turn as f64
}

/// Returns the words for a resolution: bits, or counts in a turn where they are no power of two.
pub fn resolution(turn: u64) -> String {
    if turn.is_power_of_two() { format!("{} bits", turn.ilog2()) } else { format!("{turn} counts") }
}

//! Resolution of an encoder as angle and as text.

use std::f64::consts::TAU;

/// Angle of one count of an encoder with `turn` counts per turn [rad].
pub fn count_angle(turn: u64) -> f64 {
    TAU / turn as f64
}

/// Resolution as text: bits for a power of two, otherwise counts.
pub fn resolution(turn: u64) -> String {
    if turn.is_power_of_two() { format!("{} bits", turn.ilog2()) } else { format!("{turn} counts") }
}

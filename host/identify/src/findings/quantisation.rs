//! Systematic errors by quantisation that depend on angle, flank or direction, beside the scatter that a fit sees.

use crate::prior::PriorModel;
use log_reader::resolution::count_angle;

/// Largest amplitude mimicked by counts and teeth [counts]. Measured on simulated logs of joints without these errors.
const COUNTS: f64 = 0.03;

/// Error of one encoder with `turn` counts per turn [rad].
pub(super) fn angle(turn: u64) -> f64 {
    COUNTS * count_angle(turn)
}

/// Error of motor over ratio less output [rad].
pub(super) fn twist(prior: &PriorModel) -> f64 {
    angle(prior.motor_turn) / prior.ratio() + angle(prior.output_turn)
}

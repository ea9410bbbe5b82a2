//! What the counts of encoders feign of what goes with angle, side or direction, beside the scatter that a fit sees.

use crate::prior::PriorModel;
use log_reader::resolution::count_angle;

/// Amplitude that counts and teeth may feign [counts]. Found on simulated logs of joints without such errors.
const COUNTS: f64 = 0.03;

/// Of one encoder with so many counts in a turn [rad].
pub(super) fn angle(turn: u64) -> f64 {
    COUNTS * count_angle(turn)
}

/// Of motor over ratio less output [rad].
pub(super) fn twist(prior: &PriorModel) -> f64 {
    angle(prior.motor_turn) / prior.ratio() + angle(prior.output_turn)
}

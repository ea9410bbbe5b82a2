//! What the counts of encoders feign of what goes with angle, side or direction, beside the scatter that a fit sees.

use crate::prior::PriorModel;

/// Amplitude that counts and teeth may feign [counts]. Found on simulated logs of joints without such errors.
const COUNTS: f64 = 0.03;

/// Of one encoder [rad].
pub(super) fn angle(bits: u32) -> f64 {
    COUNTS * std::f64::consts::TAU / f64::from(1_u32 << bits)
}

/// Of motor over ratio less output [rad].
pub(super) fn twist(prior: &PriorModel) -> f64 {
    angle(prior.motor_bits) / prior.ratio() + angle(prior.output_bits)
}

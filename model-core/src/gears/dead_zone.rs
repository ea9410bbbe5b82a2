//! Dead zone of a gear mesh: sharp (eq. 12), and smoothed by tanh (eq. 13, with the factor missing in print).
//!
//! Equations: (P7), (P8) in docs/theory/paper.md.

use crate::numbers::Real;

/// Sharp dead zone, eq. 12: x - b above b, x + b below -b, exactly zero between. `half_backlash` must not be negative.
///
/// ```
/// use model_core::gears::dead_zone::{sharp, smoothed};
///
/// // Teeth with a half-backlash of 40 um, in um: only what goes beyond it presses.
/// assert_eq!([-60.0, -40.0, 15.0, 60.0].map(|deflection| sharp(deflection, 40.0)), [-20.0, 0.0, 0.0, 20.0]);
/// // The smoothed one leaves it by no more than 0.14 / sharpness, at the corner.
/// assert!((smoothed(40.0, 40.0, 2.0) - sharp(40.0, 40.0_f64)).abs() < 0.14 / 2.0);
/// ```
pub fn sharp<T: Real>(deflection: T, half_backlash: T) -> T {
    if deflection > half_backlash {
        deflection - half_backlash
    } else if deflection < -half_backlash {
        deflection + half_backlash
    } else {
        T::ZERO
    }
}

/// Smoothed dead zone, eq. 13 corrected: x + (x/2)(t1 - t2) - (b/2)(t1 + t2), t1 = tanh(s (x - b)), t2 = tanh(s (x + b)).
///
/// In print the factor x of the first bracket is missing, which gives x - 1 inside the gap. The largest difference from
/// eq. 12 is about 0.14 / s, at the corners.
pub fn smoothed<T: Real>(deflection: T, half_backlash: T, sharpness: T) -> T {
    let above = (sharpness * (deflection - half_backlash)).tanh();
    let below = (sharpness * (deflection + half_backlash)).tanh();
    deflection + T::HALF * (deflection * (above - below) - half_backlash * (above + below))
}

//! Thresholds of the published estimates. Each folder has its own `thresholds`.

use crate::numbers::{Real, thresholds};

thresholds! {
    /// Largest variances of valid parameters (`outputs`).
    ValidityThresholds<T> {
        /// Largest standard deviation of a valid half-backlash and of a valid encoder offset, over the half-gap [-].
        /// Derived: two standard deviations move a flank by a quarter of the half-gap.
        half_gap: T = T::EIGHTH,
        /// Largest variance of a valid compliance over the squared compliance [-]: a standard deviation of 22 %.
        compliance: T = T::TWENTIETH,
        /// Largest variance of valid bias and friction over their initial variance [-].
        bias: T = T::HALF,
    }
}

#[cfg(feature = "sensitivity")]
pub(crate) fn list() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [ValidityThresholds::<f64>::TUNED.list()].concat()
}

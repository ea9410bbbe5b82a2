//! Thresholds of the filters.

use crate::numbers::{Real, thresholds};

thresholds! {
    /// Motor side (`drive_side`).
    MotorSideThresholds<T> {
        /// Decay of `peak_torque` per control period [-]: a speed computed from counts follows a torque within a few
        /// periods, so that braking by an earlier torque still counts. Checked by `wild motor_encoder`.
        peak_decay: T = T::TWENTIETH,
    }
}

#[cfg(feature = "sensitivity")]
pub(crate) fn list() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [MotorSideThresholds::<f64>::TUNED.list()].concat()
}

//! Thresholds of the sensors. `observer late` and `wild motor_encoder` are modules of `cargo test -p host-tests --test
//! observer` and `--test wild`.

use crate::numbers::thresholds;

thresholds! {
    /// Age of motor readings (`latency`).
    LATENCY: LatencyThresholds {
        /// Control periods without a new reading over which the motor state is extrapolated. Derived: the force during
        /// this time is a guess; after more than two periods a landing could pass unnoticed. Checked by `observer
        /// late`.
        extrapolated_periods: u32 = 2,
        /// Excess of late periods over punctual ones up to which late readings are tolerated [control periods]: a few
        /// lost frames must not stop the estimation. Checked by `observer late`.
        tolerated_late_periods: u8 = 4,
        /// Punctual control periods that end persistent lateness: the errors that late readings cause on the motor side
        /// have decayed by then. Checked by `observer late`.
        recovery_periods: u8 = 32,
        /// Least increase of age at which a reading counts as repeated [`AGE_PARTS` of a control period]. Derived: one
        /// period (16 parts) less a quarter, the clock jitter of a sampling line.
        repeated_age_increase: u32 = 12,
    }
}

thresholds! {
    /// Consecutive counts of one encoder (`counts`).
    COUNTS: CountThresholds {
        /// Consecutive readings rejected as too far away; the next such reading counts as a jump of the encoder.
        /// Checked by `wild motor_encoder`.
        rejections_before_jump: u8 = 3,
    }
}

#[cfg(feature = "sensitivity")]
pub(crate) fn list() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [LATENCY.list(), COUNTS.list()].concat()
}

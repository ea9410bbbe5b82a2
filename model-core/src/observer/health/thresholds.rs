//! Thresholds of the encoder checks. `observer faults`, `observer hour` and `observer motor_only` are modules of
//! `cargo test -p host-tests --test observer`.

use crate::numbers::{Real, thresholds};

/// Base-2 logarithm of the parts of a count.
pub(crate) const PART_BITS: u32 = 6;

/// Resolution of the estimated speed of a shaft [parts of a count].
pub(crate) const PARTS_PER_COUNT: i32 = 1 << PART_BITS;

thresholds! {
    /// Plausibility of successive readings (O21, O22). Limits in `PARTS_PER_COUNT`.
    PLAUSIBILITY: PlausibilityThresholds {
        /// Equal readings before a standstill can be a fault, plus one per count of noise. Derived: two equal readings
        /// may be one reading given twice.
        min_standstill_readings: u16 = 3,
        /// Readings that must confirm a jump. Derived: wrong bits in one or two readings are ignored.
        jump_confirmations: u8 = 3,
        /// Missing travel beyond noise at which an encoder counts as frozen [parts of a count]: one count of rounding
        /// and one more. Checked by `observer faults` and `hil/encoder-faults.toml`.
        missing_counts: i32 = 2 * PARTS_PER_COUNT,
        /// Jump of a reading beyond noise at which the reading is suspect [parts of a count]. Checked by `observer
        /// faults`; false alarms: `observer hour`.
        jump: i32 = 8 * PARTS_PER_COUNT,
        /// Mean deviations of the readings added to `missing_counts`, and twice to `jump` [-]. Derived: four mean
        /// deviations are five standard deviations of normal noise.
        noise_factor: i32 = 4,
    }
}

thresholds! {
    /// Faults of the motor encoder (O22).
    MOTOR_FAULT: MotorFaultThresholds {
        /// Travel that the commanded torque would have given a free motor before a stationary motor counts as blocked
        /// [counts]: four times the travel that a free motor loses while it reverses under a torque. Tuned on
        /// `hil/motor-faults.toml`.
        blocked_free_travel: i32 = 16,
        /// Time until the estimated speed follows a torque [control periods]: the gain 1/4 of the speed average has
        /// settled to 18 % (0.75^6). Checked by `hil/motor-faults.toml`.
        speed_lag: i32 = 6,
    }
}

thresholds! {
    /// Faults of the output encoder (O23, O24), and its readmission.
    OUTPUT_FAULT: OutputFaultThresholds {
        /// Longest interval between two readings over which the speed of the link is kept [control periods]. Checked by
        /// `observer faults`.
        speed_kept_periods: u32 = 6,
        /// Factor on the time of agreement for an encoder that turns with the motor at another constant offset [-].
        /// Checked by `observer faults`.
        new_offset_factor: u16 = 3,
        /// Learning intervals between two stored load torques. Derived: the restored torque is 16 to 32 ms old, and
        /// most faults are declared sooner. A freeze in slow motion is declared after 8 to 22 ms, so that a torque may
        /// be stored after the output encoder froze.
        load_torque_intervals: u16 = 16,
    }
}

thresholds! {
    /// Link without an output encoder (O26, O27). `observer motor_only` checks the variances.
    UnseenLinkThresholds<T> {
        /// Time by which contact may have ended before the smoothed force shows it [control periods]. Checked by
        /// `observer motor_only`.
        contact_lag: i32 = 30,
        /// Standard deviations of the smoothed force above which contact is certain: no bias explains the force.
        certain_begin: i32 = 4,
        /// Standard deviations of the smoothed force that keep certain contact.
        certain_keep: i32 = 3,
        /// Standard deviations of the smoothed force above which contact is likelier than an open gap (O27). Derived:
        /// both are equally likely at F^2 = 2 s^2 ln(F_max / (sqrt(2 pi) s)), with s the standard deviation without
        /// contact and, in contact, any force up to F_max: 2 deviations for a bias known to 5 % of the motor's largest
        /// torque, 2.5 for 2 %. One deviation keeps contact.
        likely_begin: i32 = 2,
        /// Time for which the last flank is kept without a force [control periods]: the force estimate lags.
        flank_kept_periods: u16 = 10,
        /// Decay rate of the landing speeds over the rate of the smoothed force [-]: bounces last eight times as long.
        landing_speed_decay: T = T::EIGHTH,
    }
}

thresholds! {
    /// Sign check of torque and motor encoder (O25). Checked by `model-core/tests/torque_response.rs`.
    TorqueResponseThresholds<T> {
        /// Net votes for the right sign after which the check ends.
        right_votes: i8 = 6,
        /// Net votes for the wrong sign from which a motor that runs against its torque is declared reversed.
        wrong_votes: i8 = 4,
        /// Net blocks with the motor accelerating against the torque from which the motor counts as running against its
        /// torque.
        against_blocks: u8 = 2,
        /// Consecutive blocks without missing readings and without a tooth impact that a comparison needs.
        undisturbed_blocks: u8 = 4,
        /// Least change of acceleration that votes, over the change of torque [-]. Derived: a link six times as heavy
        /// as the joint file states.
        min_response: T = T::SIXTH,
    }
}

#[cfg(feature = "sensitivity")]
pub(crate) fn list() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [
        PLAUSIBILITY.list(),
        MOTOR_FAULT.list(),
        OUTPUT_FAULT.list(),
        UnseenLinkThresholds::<f64>::TUNED.list(),
        TorqueResponseThresholds::<f64>::TUNED.list(),
    ]
    .concat()
}

//! Thresholds of the parameter estimation. `observer learning`, `observer gap` and `observer monte_carlo` are modules
//! of `cargo test -p host-tests --test observer`.

use crate::numbers::{Real, thresholds};

thresholds! {
    /// Acceptance of dwells, and resets of parameters (`consistency`). Checked by `observer learning` and `observer
    /// faults`.
    CONSISTENCY: ConsistencyThresholds {
        /// Normalised innovation above which a dwell is an outlier [standard deviations].
        outlier_sigma: i32 = 5,
        /// Consecutive outliers after which the half-gap counts as wrong. Derived: a single outlier may be an impact.
        outliers_until_half_gap: u8 = 2,
        /// Consecutive outliers after which all parameters count as wrong.
        outliers_until_all: u8 = 12,
        /// Consecutive learning intervals in which teeth transmit force between the estimated flanks, after which the
        /// half-gap counts as wrong. Derived: three batches of 8 intervals.
        gap_force_intervals: u8 = 24,
        /// Errors of a trusted half-gap that are attributed to its variation around the turn before another cause is
        /// assumed.
        variation_errors: u8 = 3,
        /// Accepted dwells after which the count of `variation_errors` is cleared. Derived: a quarter of a second of
        /// contact on both flanks.
        dwells_until_forgiven: u8 = 64,
        /// Accepted dwells on each flank after which a half-gap is trusted. Derived: 32 batches of 8 ms are a quarter
        /// of a second of contact.
        trusted_dwells: u8 = 32,
    }
}

thresholds! {
    /// Flank of a dwell (`flank`, `interval`, `last_dwell`). Checked by `observer learning`; also `compensation width`
    /// and `compensation holding`.
    FLANK: FlankThresholds {
        /// Intervals of rest on a flank after which contact counts as settled: the window of the speed is over, and the
        /// oscillation after an impact has decayed.
        settled_intervals: u8 = 3,
        /// Shortest contact that updates the parameters once the half-gap is known [intervals]. Derived: the first
        /// interval is mostly landing.
        shortest_contact: u8 = 2,
        /// Largest deflection by the lag of the force estimate [standard deviations of one deflection's noise].
        lag_sigma: i32 = 4,
        /// Steady force above which contact is loaded without confirmation by the deflection [standard deviations].
        unconfirmed_sigma: i32 = 4,
        /// Change of the deflection that proves a crossing [standard deviations]. Derived: noise causes one in 16,000
        /// dwells to exceed this limit.
        crossing_sigma: i32 = 4,
    }
}

thresholds! {
    /// Contact from the common motion of motor and link (`co_motion`). Checked by `observer learning`.
    CoMotionThresholds<T> {
        /// Departure of the link from constant speed that proves contact [spans of the crossing]. Derived: with open
        /// teeth the load would have reproduced the motor's motion to one part in 64, as the deflection may change by
        /// an eighth of the gap meanwhile.
        departure: i32 = 8,
        /// Lower limit of the half-gap after a crossing, over the observed span of the crossing [-]. Derived: a
        /// crossing is detected if its span exceeds four standard deviations. The span less one standard deviation is
        /// then at least 3/4 of the span, which is two half-gaps of 3/8 each.
        proven_share: T = T::THREE_EIGHTHS,
        /// Largest change of the deflection during a dwell on one flank, over the gap [-].
        max_drift: T = T::EIGHTH,
    }
}

thresholds! {
    /// Parameter estimation (`ParameterEstimator`).
    EstimatorThresholds<T> {
        /// Longest time over which the force of a dwell is averaged [intervals].
        averaged_dwell: u8 = 16,
        /// Intervals well inside the gap after which the motor side's force estimate has decayed to zero.
        open_intervals: u8 = 3,
        /// Intervals after the readmission of an encoder during which bias, friction, inertia and cogging are not
        /// estimated: 0.5 s. Measured (presets Q1, L1, C1 and D2, motor encoder frozen or random for half a second):
        /// the loop takes up to 0.15 s to bring the link back at full torque, and the filters carry readings from
        /// before the fault declaration.
        probation: u16 = 500,
        /// Gain per interval of the filter for the steady mesh force [-]; the filter reduces the noise variance to 1/7,
        /// as a mean of seven intervals does.
        steady_gain: T = T::QUARTER,
        /// Deviation of the transmission error, over the half-gap, above which dwells on an unknown flank update the
        /// transmission error first [-]: the error could hide a crossing; see `TravelDetector::distinguishes_rest`.
        hidden_crossing: T = T::QUARTER,
        /// Remaining part of the error maps' blur once maps and half-gap are known [-].
        remaining_blur: T = T::EIGHTH,
        /// Distance from a flank within which the gap may no longer be open, over the half-gap [-]: teeth of a fast
        /// crossing land before the deflection shows it.
        near_flank: T = T::EIGHTH,
        /// Largest variation of the half-gap around the turn, over the half-gap [-]: worn gears vary by 30 %.
        max_variation: T = T::THREE_EIGHTHS,
        /// Standard deviation added to a half-gap that differs at this place of the turn, over the half-gap [-]: the
        /// half-gap becomes invalid until a dwell has shown it, and the gap coordinate stays valid.
        inflation: T = T::EIGHTH,
        /// Turn of motor and mesh phase up to which slopes replace the exact position errors [rad]. Derived: at a
        /// quarter of a radian the second harmonic of the error maps, at twice the angle, is off by an eighth of
        /// itself.
        slope_angle: T = T::QUARTER,
        /// Largest motion hidden by noise in a window of rest, over the half-gap [-].
        hidden_motion: T = T::QUARTER,
        /// Batches over which mean and variance of the force are taken. Derived: 64 batches of 8 ms are half a second
        /// of contact.
        force_batches: u8 = 64,
        /// Weight of a contact that ended early while the half-gap is unknown [-]: the teeth may not have touched, so
        /// that sixteen of these contacts count as one dwell.
        unsure_contact_weight: T = T::QUARTER,
    }
}

thresholds! {
    /// Limits derived from variances (`uncertainty`). Checked by `observer gap` and `observer monte_carlo`.
    UncertaintyThresholds<T> {
        /// Variance of the steady force's noise over the variance of an interval's noise [-]: a filter with a gain of a
        /// quarter has 1/7, reduced by the correlation of neighbouring intervals.
        steady_noise: T = T::EIGHTH,
        /// Largest distance from a flank within which teeth count as touching, over the half-gap [-]: an error of the
        /// gap coordinate that still permits compensation.
        near_share: T = T::TWENTIETH,
        /// Weight of a dwell in the mean over dwells [-].
        dwell_weight: T = T::TWENTIETH,
        /// Mean normalised innovation above which the half-gap has changed [-]. Derived: the mean over dwells of
        /// independent noise has a standard deviation of sqrt(share / (2 - share)) = 0.16, so that 1 is six of them.
        changed_half_gap: T = T::ONE,
    }
}

thresholds! {
    /// Variation of the half-gap around the turn (O20).
    GapVariationThresholds<T> {
        /// Initial relative variation of the half-gap per radian [-]: the steepest change of a variation of 25 % once
        /// per turn. Tuned on `hil/real-any.toml`.
        initial_variation: T = T::QUARTER,
        /// Weight of the initial variation [rad^2].
        initial_weight: T = T::QUARTER,
        /// Largest weight of the sums [rad^2]; above it the sums are halved, because gears wear.
        max_weight: T = T::SIX,
        /// Least angle after which a dwell shows the variation [rad].
        min_angle: T = T::QUARTER,
        /// Angle above which the variance no longer grows [rad].
        max_angle: T = T::TWO,
    }
}

thresholds! {
    /// Innovations that the small estimators reject [standard deviations].
    OUTLIER: OutlierThresholds {
        /// Innovation of the cogging estimate above which a sample is an outlier [standard deviations].
        cogging_sigma: i32 = 5,
        /// Innovation of bias and friction above which a force sample is rejected, because the gap was not open
        /// [standard deviations].
        bias_sigma: i32 = 4,
        /// Innovation of the mobility above which a sample is rejected, because another force acted on the link
        /// [standard deviations].
        inertia_sigma: i32 = 4,
    }
}

thresholds! {
    /// Limits of parameters and covariance (`least_squares`).
    LEAST_SQUARES: LeastSquaresLimits {
        /// Largest deviation of a parameter from its mean [initial standard deviations], against failing encoders: four
        /// times the deviation of a joint that fits its file. The offset has no limit.
        max_deviation: i32 = 16,
        /// Largest factor above the diagonal, in units of the initial standard deviations: ratio of the motions of two
        /// parameters that the motion separates.
        max_factor: i32 = 1000,
    }
}

#[cfg(feature = "sensitivity")]
pub(crate) fn list() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [
        CONSISTENCY.list(),
        FLANK.list(),
        CoMotionThresholds::<f64>::TUNED.list(),
        EstimatorThresholds::<f64>::TUNED.list(),
        UncertaintyThresholds::<f64>::TUNED.list(),
        GapVariationThresholds::<f64>::TUNED.list(),
        OUTLIER.list(),
        LEAST_SQUARES.list(),
    ]
    .concat()
}

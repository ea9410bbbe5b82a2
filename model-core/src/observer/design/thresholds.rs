//! Times, fractions and rates from which the tables are computed. Test names are modules of
//! `cargo test -p host-tests --test observer`.

use core::f64::consts::TAU;

use crate::numbers::thresholds;

thresholds! {
    /// Times of the parameter estimation.
    LEARNING_DESIGN: LearningDesign {
        /// Length of a learning interval [s]: short against motions in which contact settles, long against noise.
        /// Checked by `observer learning` and `observer monte_carlo`.
        interval: f64 = 1e-3,
        /// Learning intervals over which the rate of the deflection is measured [-].
        window: f64 = 8.0,
        /// Length of settled contact averaged into one deflection for the estimation [s]: about one period of cogging
        /// and of wind-up swings, so that errors of successive batches are nearly independent.
        batch: f64 = 8e-3,
        /// Time constant of the growth of variances by wear and temperature [s].
        memory: f64 = 100.0,
    }
}

thresholds! {
    /// Clock of the samples.
    CLOCK_DESIGN: ClockDesign {
        /// Shortest and longest control period on the samples' clock without a lost period [control periods].
        accepted_periods: [f64; 2] = [0.5, 1.5],
        /// Age above which a reading counts as lost [control periods]: up to this age the torques since the reading are
        /// known well enough.
        oldest_reading: f64 = 10.0,
    }
}

thresholds! {
    /// Contact, and deviations that count as noise.
    CONTACT_DESIGN: ContactDesign {
        /// Lag of the measured deflection at a landing, output filter included [control periods].
        landing_lag: f64 = 3.0,
        /// Standard deviation of a flank's position, over the half-gap, below which positions decide on contact [-]:
        /// six standard deviations are half of the half-gap.
        known_half_gap: f64 = 0.08,
        /// Share of the motor encoder's errors that remains after the error maps [-].
        unmodelled_errors: f64 = 0.1,
        /// Standard deviations treated as noise: of bias and friction, of a deflection at rest, of a speed [-].
        noise_sigma: f64 = 3.0,
        /// Time constant of a mean over a few learning intervals [learning intervals].
        smoothing_intervals: f64 = 1.5,
    }
}

thresholds! {
    /// Torque bias and dry friction (O16).
    BIAS_DESIGN: BiasDesign {
        /// Correlation length of cogging and noise [learning intervals]; inflates the variance of a bias measurement by
        /// 5.
        correlated_intervals: f64 = 5.0,
        /// Time in which bias and friction may change by their prior standard deviation [s]: a motor warms up more
        /// slowly.
        drift_time: f64 = 10.0,
    }
}

thresholds! {
    /// Exclusion and readmission of the encoders (O21 to O24). Checked by `observer faults` and
    /// `hil/encoder-faults.toml`; false alarms: `observer hour`.
    SUPERVISION_DESIGN: SupervisionDesign {
        /// Time outside the possible range after which a fault of the output encoder is declared [s]: longer than
        /// impacts ring.
        output_fault_time: f64 = 4e-3,
        /// Shortest time in which an obstacle stops a link, independent of the speed [s]: a quarter of a swing of 250
        /// Hz. A link that is stopped faster, as by steel on steel, is mistaken for a frozen encoder: counts alone
        /// cannot distinguish the two (`docs/theory/observer.md`, Limits).
        link_stop_time: f64 = 1e-3,
        /// Largest torque with which teeth and load brake the link without an obstacle, over the motor's largest torque
        /// at the output [-].
        link_brake: f64 = 2.0,
        /// Time for which a stationary motor is judged by its last speed [s]: noise accumulates over longer times.
        motor_speed_kept: f64 = 3e-3,
        /// Time of unchanged motor counts after which the deflection may exclude the motor encoder [s]: longer than
        /// repeated counts by noise, or the reversal of a motor.
        motor_standstill: f64 = 1e-3,
        /// Time for which the readings of an excluded motor encoder must be plausible and agree with the output encoder
        /// before readmission [s]. Random counts are not plausible for three readings.
        motor_readmission: f64 = 20e-3,
        /// Time before readmission if the motor's counts stand still or have slipped [s].
        motor_slip_readmission: f64 = 100e-3,
        /// Travel that proves motion of an output encoder [counts]: above the flicker by noise.
        min_motion: f64 = 4.0,
        /// Time without a fresh reading after which the output encoder is silent [s]: longer than readings are lost by
        /// chance.
        output_silence: f64 = 10e-3,
        /// Time for which an excluded output encoder must agree with the motor before readmission [s]: longer than the
        /// link's swings after a fault.
        output_readmission: f64 = 0.3,
        /// Margin of the deflection's possible range, over the half-gap and over the wind-up under the largest torque,
        /// for errors of maps and compliance [-].
        deflection_margin: f64 = 0.1,
        /// Largest standard deviation of a valid gap coordinate, over the gap [-].
        widest_gap: f64 = 0.1,
    }
}

thresholds! {
    /// Speeds at which the rounding of a reading counts as independent noise (O5).
    ROUNDING_DESIGN: RoundingDesign {
        /// Link speed v_w at which the rounding of an output reading counts as independent noise [rad/s]. At lower
        /// speed or with coarser encoders a count lasts longer than a period, and readings within one count share their
        /// rounding error. A robot joint at work; at 10 kHz the variance grows below 15 bits.
        link_speed: f64 = 2.0,
        /// Motor-side speed v_w, a link speed times the ratio, at which the rounding of a motor reading counts as
        /// independent noise [rad/s]. Tuned on hil/never-worse.toml: with 2 rad/s the RMS error with motor encoders of
        /// 12 bits on Q1 is 4 % larger in the mean of 250 seeds; with 3 rad/s the variance grows below 2^14.4/ratio
        /// counts at 10 kHz, so that 12 bits keep their variance.
        motor_speed: f64 = 3.0,
    }
}

thresholds! {
    /// Blocks of the sign check (O25).
    RESPONSE_DESIGN: ResponseDesign {
        /// Least change of the angle per block, from block to block, by the largest torque [motor counts]: noise of a
        /// count causes a change of 3.
        block_counts: f64 = 24.0,
        /// Least change of the angle per block by the largest torque, over the gap at the motor [-]: rattling between
        /// the flanks causes a change of 1.
        block_gaps: f64 = 4.0,
        /// Least length of a block, in periods of the swing of motor against link [-]: a swing must be over within a
        /// block.
        block_swings: f64 = 0.5,
        /// Shortest and longest block in which torque and acceleration are compared [s]: longer than the ringing of
        /// teeth, short enough to detect a runaway joint soon.
        block_time: [f64; 2] = [2e-3, 30e-3],
        /// Least length of a block [control periods]: a torque acts after one to three periods.
        block_periods: f64 = 8.0,
        /// Torque, and change of torque, that suffices for a vote, over the motor's largest torque [-]: above friction
        /// and bias.
        large_torque: f64 = 0.25,
    }
}

thresholds! {
    /// Assumed rates of torque changes, which set the bandwidths of the filters (O2 to O4).
    FILTER_DESIGN: FilterDesign {
        /// Time in which the load torque changes by the motor's largest torque at the output, one standard deviation
        /// [s]. Friction at a reversal and collisions are faster, gravity is slower; the filter follows friction and
        /// collisions with a lag of a few milliseconds.
        load_change_time: f64 = 3.0,
        /// Shortest half swing of motor against load that the motor side follows [control periods].
        shortest_half_swing: f64 = 20.0,
        /// Change of the mesh force in half a swing of motor against load, over the motor's largest torque [-].
        mesh_change: f64 = 0.2,
        /// Error of the mesh force for about a millisecond after an impact, over the motor's largest torque [-].
        impact_error: f64 = 0.05,
        /// Duration of the error after an impact [s].
        impact_time: f64 = 1e-3,
        /// Rate of all three poles of the motor side while its readings are late [rad/s]: swings of the teeth, which
        /// the prediction cannot foresee, must not be extrapolated.
        late_poles: f64 = 1000.0,
    }
}

thresholds! {
    /// Torque samples.
    TORQUE_DESIGN: TorqueDesign {
        /// Torque above which a sample is rejected, over the motor's limit [-]: above noise and a controller's
        /// overshoot.
        largest: f64 = 2.0,
        /// Time after a rejected torque sample in which the filters may still be wrong [s]: several times the slowest
        /// time constant of the filters.
        uncertain_time: f64 = 20e-3,
    }
}

thresholds! {
    /// Cogging of the motor (O17).
    COGGING_DESIGN: CoggingDesign {
        /// Time constant t_s of the high-pass filter, applied twice, that removes slow changes of the load's own torque
        /// [s].
        slow_time: f64 = 20e-3,
        /// Least advance of the cogging phase within that time [rad]: the high-pass filter removes slower cogging.
        min_phase: f64 = 0.6,
        /// Largest advance of the cogging phase in a learning interval, and from one motor count to the next [rad].
        max_phase: f64 = 1.0,
        /// Averaging time of the motor speed [s].
        speed_average: f64 = 50e-3,
        /// Largest deviation from the averaged speed, over the speed [-]. The response holds for a constant cogging
        /// frequency, and torques of faster speed changes repeat from motion to motion as cogging does.
        unsteadiness: f64 = 0.3,
        /// Time on one flank after which the load torque has settled from the landing [s]. As long as impacts ring.
        settled_time: f64 = 20e-3,
        /// Correlation length of the load torque's noise after the high-pass filter [learning intervals].
        correlated_intervals: f64 = 5.0,
        /// Largest accepted sine or cosine amplitude, over the joint file's ripple [-]: three standard deviations.
        largest: f64 = 3.0,
        /// Averaging time of the noise variance [s].
        noise_average: f64 = 0.1,
    }
}

thresholds! {
    /// Inertia of the link (O6).
    INERTIA_DESIGN: InertiaDesign {
        /// Prior standard deviation of the mobility, the designed inertia over the link's inertia [-].
        uncertainty: f64 = 0.3,
        /// Time constant of the high-pass filter that removes torques of a weight [s]: longer than a swing of the teeth
        /// after a landing, shorter than the link's turn through a tenth of a circle.
        slow_time: f64 = 20e-3,
        /// Least fast torque for an update, over the motor's largest torque [-]: smaller torques show more noise than
        /// inertia.
        min_torque: f64 = 0.05,
        /// Standard deviation of fast changes of the load torque itself, over the motor's largest torque [-].
        load_noise: f64 = 0.01,
        /// Averaging time of the detection of external pushes [s].
        external_average: f64 = 0.5,
        /// Largest share of the noise variance that may remain after the high-pass filter [-]: a larger remainder means
        /// an external push.
        external_share: f64 = 0.5,
        /// Correlation length of the noise [learning intervals].
        correlated_intervals: f64 = 10.0,
    }
}

thresholds! {
    /// Width probe (O28). Checked by `observer probe`.
    PROBE_DESIGN: ProbeDesign {
        /// Longest duration of a probe [s].
        longest: f64 = 0.5,
        /// Settling time of a torque: the gap is crossed and the wind-up has stopped swinging [s].
        settle: f64 = 50e-3,
        /// Averaging time of a rest angle [s].
        average: f64 = 10e-3,
        /// Time constant of the torque's rise: slow against a crossing, for soft landings [s].
        rise: f64 = 12e-3,
        /// Rate at which the damping torque removes the motor's speed: slow against any current loop [rad/s].
        damping: f64 = TAU * 50.0,
        /// Torque of the usual probe over the motor's limit [-]: well above friction, without hard landings.
        usual_share: f64 = 0.2,
        /// Least torque of the usual probe, over the torque uncertainty [-]: twice the least torque of any probe.
        usual_uncertainties: f64 = 8.0,
    }
}

#[cfg(feature = "sensitivity")]
pub(crate) fn list() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [
        LEARNING_DESIGN.list(),
        CLOCK_DESIGN.list(),
        CONTACT_DESIGN.list(),
        BIAS_DESIGN.list(),
        SUPERVISION_DESIGN.list(),
        ROUNDING_DESIGN.list(),
        RESPONSE_DESIGN.list(),
        FILTER_DESIGN.list(),
        TORQUE_DESIGN.list(),
        COGGING_DESIGN.list(),
        INERTIA_DESIGN.list(),
        PROBE_DESIGN.list(),
    ]
    .concat()
}

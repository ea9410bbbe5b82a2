//! Bounds on the observer against the fine-step plant, most of them relative to the gap 4b. Measured values are the worst of the short
//! tests; the long run over many seeds prints its own figures.

bounds! {
    /// Gap coordinate with ideal encoders of 18 bits.
    GAP_IDEAL: "error of the gap coordinate, ideal encoders, RMS over the gap",
        below 3.4e-3, was 1.7e-3,
        scatters "Requirement of a joint; most of the error is noise of the motor's torque on the wind-up.";

    /// Gap coordinate with real encoders of 16 and 18 bits.
    GAP_FINE: "error of the gap coordinate, 16 and 18 bits with harmonics and skew, RMS over the gap",
        below 2.6e-3, was 1.3e-3,
        scatters "Requirement of a joint; the narrowest gap tried is 20 um.";

    /// Gap coordinate with the preset's encoders.
    GAP_COARSE: "error of the gap coordinate, 14 and 17 bits with harmonics and skew, RMS over the gap",
        below 8e-3, was 4e-3,
        scatters "Requirement of a joint; one count of the motor is 2.7 um of a gap of 80 to 320 um.";

    /// Gap coordinate with the preset's encoders, worst moment.
    GAP_WORST: "worst error of the gap coordinate, 14 and 17 bits, over the gap",
        below 0.1, was 0.08,
        scatters "Impacts excite the carrier against the wind-up, faster than the load side follows.";

    /// Share of time in which the reported contact is wrong.
    CONTACT_WRONG: "share of the time in which the reported contact is wrong, outside bands of 5 %",
        below 8.2e-3, was 4.1e-3,
        scatters "A controller that trusts the reported contact pushes the wrong way meanwhile.";

    /// Median delay of a reported landing.
    LANDING_DELAY: "median delay of a reported landing [s]",
        below 0.3e-3 + 1e-9, was 0.3e-3,
        argued "Three control periods.";

    /// 95th percentile of the delay of a reported landing.
    LANDING_DELAY_LONG: "95th percentile of the delay of a reported landing [s]",
        below 1.2e-3, was 6e-4,
        scatters "Slow landings show late in any measured quantity.";

    /// Load torque.
    LOAD_TORQUE: "error of the load torque, RMS over the motor's largest torque at the output",
        below 0.025, was 0.013,
        scatters "Reversals of dry friction are followed with a lag of a few milliseconds.";

    /// Load torque with the link's inertia wrong by 30 %.
    LOAD_TORQUE_WRONG_INERTIA: "error of the load torque with the link's inertia wrong by 30 %, RMS over the motor's largest torque at the output",
        below 0.025, was 0.015,
        scatters "Without estimation the error would be 0.048, 30 % of the torques of this motion. The inertia is estimated, so the bound of a known inertia applies.";

    /// Estimated inertia of the link.
    LINK_INERTIA: "estimated inertia of the link, relative",
        below 0.1, was 0.053,
        scatters "Includes a torque constant wrong by 3 %; six landings.";

    /// Transmitted torque.
    MESH_TORQUE: "error of the transmitted torque, RMS over the motor's largest torque at the output",
        below 0.019, was 9.9e-3,
        scatters "Includes a torque constant wrong by 3 %.";

    /// Half-backlash at the end of a recording.
    WIDTH: "half-backlash at the end, relative",
        below 0.02, was 0.011,
        scatters "A guess wrong by half, corrected within the recording.";

    /// Half-backlash after steps, RMS over all cases.
    WIDTH_FROM_STEPS: "half-backlash after 8 s of steps between two places under the compensation, relative, root mean square of all",
        below 0.02, was 0.011,
        scatters "Each flank is in contact mostly at one of the places; both are near the middle, where teeth part and land.";

    /// Half-backlash after steps, worst case.
    WIDTH_FROM_STEPS_WORST: "half-backlash after 8 s of steps between two places under the compensation, relative, worst",
        below 0.04, was 0.025,
        scatters "The width estimated from a record of steps scatters by this much: half a micrometre of twenty.";

    /// Half-backlash after two short contacts.
    WIDTH_FROM_BOUNCES: "half-backlash after a push that sends the link from flank to flank, relative",
        below 0.062, was 0.031,
        scatters "Two contacts of some 15 ms each; the width then counts as known.";

    /// Time until the width is right to 5 % for good, from the end of the first crossing.
    WIDTH_TIME: "time from first contact on both flanks until the width is right to 5 % for good [s]",
        below 0.12, was 0.061,
        scatters "Time allowed for commissioning.";

    /// Time until the width is right to 5 % for good, in steps between two places under the compensation.
    WIDTH_TIME_IN_STEPS: "time of steps in contact until the width is right to 5 % for good [s]",
        below 0.25, was 0.17,
        scatters "Only the impacts that occur inform the width.";

    /// Improvement by the error maps.
    GAP_WITH_MAP_OVER_WITHOUT: "error of the gap coordinate with the error maps over the error without",
        below 0.04, was 0.027,
        scatters "At least five times better: harmonics of 0.1 degrees are 15 % of the gap. An observer without a map attributes them to a \
                  half-gap that varies around the turn, which fits 2.4 times as well as a wrong half-gap.";

    /// Encoder error harmonics outside the map.
    FOURTH_HARMONIC: "increase of the gap coordinate's error by 0.02 degrees four times a turn, RMS over the gap",
        below 8.4e-3, was 4.2e-3,
        scatters "The map does not contain this harmonic: 2.5 um of gap coordinate.";

    /// Single against double precision.
    SINGLE_PRECISION: "gap coordinate in f32 less gap coordinate in f64, RMS over the gap, at the start and after 300 turns",
        below 1.6e-7, was 8.1e-8,
        scatters "Counts are whole numbers; only differences become floating point.";

    /// Gap coordinate with a torque bias of 5 %.
    GAP_WITH_BIAS: "error of the gap coordinate with a torque bias of 5 % of the limit, RMS over the gap",
        below 8.4e-3, was 4.2e-3,
        scatters "The bias is measured inside the gap, where the meshes carry no load.";

    /// Torque bias.
    TORQUE_BIAS: "measured torque bias over the injected bias, less one",
        below 0.082, was 0.041,
        scatters "Both directions of a few crossings separate dry friction from the bias.";

    /// Time to detect a failed output encoder.
    FAULT_DETECTION_TIME: "time until a frozen output encoder is excluded while the joint turns [s]",
        below 15e-3, was 9.4e-3,
        scatters "The check waits four milliseconds, so that no impact looks like a fault; before the width is known, the motor first travels by the widest possible gap.";

    /// Time to exclude a frozen or jumping output encoder at speed.
    FAULT_DETECTION_TIME_AT_SPEED: "time until a frozen or jumping output encoder is excluded while the link turns by 0.4 rad/s or more [s]",
        below 8e-4, was 4e-4,
        scatters "A link moves on for this long whatever it runs into; until then control uses wrong readings.";

    /// A single wrong bit in a reading of the output encoder.
    ONE_WRONG_BIT: "change of the load torque by an error of 64 counts in one of 777 readings, over the rated torque",
        below 0.04, was 0.021,
        scatters "An implausible reading is not used until the next readings confirm it.";

    /// Time to detect an output encoder that loses a few counts.
    LOST_COUNTS_DETECTION_TIME: "time until an output encoder that loses 0.3 % of its counts to and fro is excluded [s]",
        below 0.4, was 0.26,
        scatters "Half a swing at 1 Hz: then the gap seems narrower on one flank, which wear cannot explain.";

    /// Motor cogging.
    COGGING: "error of the cogging estimated in a slow motion against friction, over the cogging of Q1's file",
        below 0.16, was 0.08,
        scatters "The load torque, the source of the estimate, contains friction and encoder noise.";

    /// Half-backlash after a failing output encoder.
    WIDTH_AFTER_LOST_COUNTS: "error of the half-backlash after an output encoder lost 3 % of its counts, over the half-backlash",
        below 5e-3, was 2.9e-3,
        scatters "When the encoder is excluded, the estimates from before its fault are restored.";

    /// Angle of the link after its encoder slipped.
    LINK_ANGLE_AFTER_SLIP: "error of the link angle after its encoder slipped and was readmitted [rad]",
        below 1.5e-4, was 1.03e-4,
        since "Three counts of 17 bits: the slip is measured over one estimation interval and corrected in whole counts, and the encoder's own error differs after it.";

    /// Consistency of the variance without an output encoder, in the motions for which it is stated.
    MOTOR_ONLY_NEES: "squared error of the gap over its variance, motor only, mean over the valid time",
        below 0.28, was 0.14,
        scatters "The 95 % point of one squared standard deviation: separations are few, and each is one sample.";

    /// Width probe.
    PROBED_WIDTH: "half-backlash from the probe, relative",
        below 0.042, was 0.021,
        scatters "Friction of the motor leaves about 4 N of wind-up undetermined on each flank.";
}

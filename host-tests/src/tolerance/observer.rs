//! Bounds on the observer against the fine-step plant, most of them relative to the gap 4b. Measured values are the worst of the short
//! tests; the long run over many seeds prints its own figures.

bounds! {
    /// Gap coordinate with ideal encoders of 18 bits.
    GAP_IDEAL: "error of the gap coordinate, ideal encoders, RMS over the gap",
        below 3.4e-3, was 1.7e-3,
        scatters "What a joint needs; noise of the motor's torque on the wind-up is most of what is left.";

    /// Gap coordinate with real encoders of 16 and 18 bits.
    GAP_FINE: "error of the gap coordinate, 16 and 18 bits with harmonics and skew, RMS over the gap",
        below 2.6e-3, was 1.3e-3,
        scatters "What a joint needs; the least width tried is 20 um.";

    /// Gap coordinate with the preset's encoders.
    GAP_COARSE: "error of the gap coordinate, 14 and 17 bits with harmonics and skew, RMS over the gap",
        below 8e-3, was 4e-3,
        scatters "What a joint needs; a count of the motor alone is 2.7 um of a gap of 80 to 320 um.";

    /// Gap coordinate with the preset's encoders, worst moment.
    GAP_WORST: "worst error of the gap coordinate, 14 and 17 bits, over the gap",
        below 0.1, was 0.08,
        scatters "Impacts excite the carrier against the wind-up, faster than the load side follows.";

    /// Share of time in which the reported contact is wrong.
    CONTACT_WRONG: "part of the time in which the reported contact is wrong, outside bands of 5 %",
        below 8.2e-3, was 4.1e-3,
        scatters "A controller that trusts it pushes the wrong way for that long.";

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
        scatters "Dry friction that turns round is followed with a lag of a few milliseconds.";

    /// Load torque with the link's inertia wrong by 30 %.
    LOAD_TORQUE_WRONG_INERTIA: "error of the load torque with the link's inertia wrong by 30 %, RMS over the motor's largest torque at the output",
        below 0.025, was 0.015,
        scatters "Not known, it would cost 0.048: 30 % of the torques of this motion. It is learnt, so this is the bound of a known one.";

    /// Estimated inertia of the link.
    LINK_INERTIA: "inertia of the link as learnt, relative",
        below 0.1, was 0.053,
        scatters "A torque constant wrong by 3 % is in it; six landings.";

    /// Transmitted torque.
    MESH_TORQUE: "error of the transmitted torque, RMS over the motor's largest torque at the output",
        below 0.019, was 9.9e-3,
        scatters "A torque constant wrong by 3 % is in it.";

    /// Half-backlash at the end of a recording.
    WIDTH: "half-backlash at the end, relative",
        below 0.02, was 0.011,
        scatters "A guess wrong by half, corrected within the recording.";

    /// Half-backlash after steps, RMS over all cases.
    WIDTH_IN_STEPS: "half-backlash after 8 s of steps between two places under the compensation, relative, root mean square of all",
        below 0.02, was 0.011,
        scatters "Each flank is met mostly at one of the places; near the middle, where teeth part and land, both are.";

    /// Half-backlash after steps, worst case.
    WIDTH_IN_STEPS_WORST: "half-backlash after 8 s of steps between two places under the compensation, relative, worst",
        below 0.04, was 0.025,
        scatters "What a record of steps says of the width scatters by that: half a micrometre of twenty.";

    /// Half-backlash after two short contacts.
    WIDTH_IN_PASSING: "half-backlash after a push that sends the link from flank to flank, relative",
        below 0.062, was 0.031,
        scatters "Two contacts of some 15 ms each; the width then counts as known.";

    /// Time until the width is right to 5 % for good, from the end of the first crossing.
    WIDTH_AFTER: "time from first contact on both flanks until the width is right to 5 % for good [s]",
        below 0.12, was 0.061,
        scatters "What commissioning may take.";

    /// Time until the width is right to 5 % for good, in steps between two places under the compensation.
    WIDTH_AFTER_STEPS: "time of steps in contact until the width is right to 5 % for good [s]",
        below 0.25, was 0.17,
        scatters "The width is learnt from what blows there are.";

    /// Improvement by the error maps.
    WITHOUT_MAP: "error of the gap coordinate with the error maps over the one without",
        below 0.04, was 0.027,
        scatters "Five times better at least: harmonics of 0.1 degrees are 15 % of the gap. An observer without a map puts them down to a \
                  half-gap that varies around the turn, 2.4 times as well as to a wrong one.";

    /// Encoder error harmonics outside the map.
    FOURTH_HARMONIC: "error of the gap coordinate with 0.02 degrees four times a turn besides, RMS over the gap, more than without",
        below 8.4e-3, was 4.2e-3,
        scatters "It is not in the map: 2.5 um of gap coordinate.";

    /// Single against double precision.
    SINGLE_PRECISION: "gap coordinate in f32 less the one in f64, RMS over the gap, at the start and after 300 turns",
        below 1.6e-7, was 8.1e-8,
        scatters "Counts are whole numbers; only differences become floating point.";

    /// Gap coordinate with a torque bias of 5 %.
    GAP_WITH_BIAS: "error of the gap coordinate with a torque bias of 5 % of the limit, RMS over the gap",
        below 8.4e-3, was 4.2e-3,
        scatters "It is read inside the gap, where the meshes carry nothing.";

    /// Torque bias.
    TORQUE_BIAS: "torque bias as read over the one put in, less one",
        below 0.082, was 0.041,
        scatters "Dry friction is told from it by the two directions of a few crossings.";

    /// Time to detect a failed output encoder.
    FAILURE_FOUND: "time until a frozen output encoder is given up while the joint turns [s]",
        below 15e-3, was 9.4e-3,
        scatters "Four milliseconds are waited, so that no impact looks like a failure; before the width is known, the motor goes on by all that it may be first.";

    /// Time to exclude a frozen or jumping output encoder at speed.
    FAILURE_FOUND_AT_SPEED: "time until an output encoder that freezes or jumps is given up while the link turns by 0.4 rad/s or more [s]",
        below 8e-4, was 4e-4,
        scatters "A link goes on for that long whatever it runs into; until then the law is driven by what is not.";

    /// A single wrong bit in a reading of the output encoder.
    ONE_WRONG_BIT: "change of the load torque by one reading in 777 that is 64 counts off, over the rated torque",
        below 0.04, was 0.021,
        scatters "A reading that no link could follow is not used until the next ones confirm it.";

    /// Time to detect an output encoder that loses a few counts.
    LOST_COUNTS_FOUND: "time until an output encoder that loses 0.3 % of its counts to and fro is given up [s]",
        below 0.4, was 0.26,
        scatters "Half a swing at 1 Hz: then the gap seems narrower on one flank or the other, as no wear makes it.";

    /// Motor cogging.
    COGGING: "cogging as learnt in a slow motion against friction less what it is, over that of Q1's file",
        below 0.16, was 0.08,
        scatters "The load torque that it is read from has friction and noise of the encoders in it.";

    /// Half-backlash after a failing output encoder.
    WIDTH_AFTER_LOST_COUNTS: "error of the half-backlash after an output encoder lost 3 % of its counts, over the half-backlash",
        below 5e-3, was 2.9e-3,
        scatters "What was learnt while the encoder was sound: it is gone back to when the encoder is given up.";

    /// Angle of the link after its encoder slipped.
    PLACE_AFTER_SLIP: "place of the link after its encoder slipped and was taken back, beside where it is [rad]",
        below 1.5e-4, was 1.03e-4,
        since "Three counts of 17 bits: the slip is read from one learning interval and taken back in whole counts, and the encoder's own error is elsewhere after it.";

    /// Consistency of the variance without an output encoder, in the motions for which it is stated.
    MOTOR_ONLY_HONESTY: "squared error of the gap over its variance, motor only, mean over the time that counts as valid",
        below 0.28, was 0.14,
        scatters "The 95 % point of one squared standard deviation: separations are few and each is one draw.";

    /// Width probe.
    PROBED_WIDTH: "half-backlash from the probe, relative",
        below 0.042, was 0.021,
        scatters "Friction of the motor leaves some 4 N of wind-up open on each flank.";
}

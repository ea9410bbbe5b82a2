//! Bounds of the observer against the fine-step plant, most of them parts of the gap 4b. What was measured is the worst of
//! the short tests; the long run over many seeds prints its own figures.

use super::Bound;

/// Gap coordinate with ideal encoders of 18 bits.
pub const GAP_IDEAL: Bound = Bound {
    of: "error of the gap coordinate, ideal encoders, RMS over the gap",
    limit: 5e-3,
    measured: 3.1e-3,
    reason: "What a joint needs; noise of the motor's torque on the wind-up is most of what is left.",
};

/// Gap coordinate with real encoders of 16 and 18 bits.
pub const GAP_FINE: Bound = Bound {
    of: "error of the gap coordinate, 16 and 18 bits with harmonics and skew, RMS over the gap",
    limit: 8e-3,
    measured: 1.3e-3,
    reason: "What a joint needs; the least width tried is 20 um.",
};

/// Gap coordinate with the preset's encoders.
pub const GAP_COARSE: Bound = Bound {
    of: "error of the gap coordinate, 14 and 17 bits with harmonics and skew, RMS over the gap",
    limit: 15e-3,
    measured: 4.7e-3,
    reason: "What a joint needs; a count of the motor alone is 2.7 um of a gap of 80 to 320 um.",
};

/// The same, worst moment.
pub const GAP_WORST: Bound = Bound {
    of: "worst error of the gap coordinate, 14 and 17 bits, over the gap",
    limit: 0.1,
    measured: 0.056,
    reason: "Impacts excite the carrier against the wind-up, faster than the load side follows.",
};

/// Time in which the reported contact is wrong.
pub const CONTACT_WRONG: Bound = Bound {
    of: "part of the time in which the reported contact is wrong, outside bands of 5 %",
    limit: 0.015,
    measured: 4.2e-3,
    reason: "A controller that trusts it pushes the wrong way for that long.",
};

/// Median delay of a reported landing.
pub const LANDING_DELAY: Bound = Bound {
    of: "median delay of a reported landing [s]",
    limit: 0.3e-3 + 1e-9,
    measured: 0.3e-3,
    reason: "Three control periods.",
};

/// 95th percentile of that delay.
pub const LANDING_DELAY_LONG: Bound = Bound {
    of: "95th percentile of the delay of a reported landing [s]",
    limit: 2e-3 + 1e-9,
    measured: 0.6e-3,
    reason: "Slow landings show late in any measured quantity.",
};

/// Load torque.
pub const LOAD_TORQUE: Bound = Bound {
    of: "error of the load torque, RMS over the motor's largest torque at the output",
    limit: 0.025,
    measured: 0.0125,
    reason: "Dry friction that turns round is followed with a lag of a few milliseconds.",
};

/// Load torque with the load's inertia wrong by 30 %.
pub const LOAD_TORQUE_WRONG_INERTIA: Bound = Bound {
    of: "error of the load torque with the link's inertia wrong by 30 %, RMS over the motor's largest torque at the output",
    limit: 0.025,
    measured: 0.015,
    reason: "Not known, it would cost 0.048: 30 % of the torques of this motion. It is learnt, so this is the bound of a known one.",
};

/// Learnt inertia of the link.
pub const LINK_INERTIA: Bound = Bound {
    of: "inertia of the link as learnt, relative",
    limit: 0.1,
    measured: 0.054,
    reason: "A torque constant wrong by 3 % is in it; six landings.",
};

/// Transmitted torque.
pub const MESH_TORQUE: Bound = Bound {
    of: "error of the transmitted torque, RMS over the motor's largest torque at the output",
    limit: 0.03,
    measured: 0.0105,
    reason: "A torque constant wrong by 3 % is in it.",
};

/// Width at the end.
pub const WIDTH: Bound = Bound {
    of: "half-backlash at the end, relative",
    limit: 0.02,
    measured: 5.1e-3,
    reason: "A guess wrong by half, corrected within the recording.",
};

/// Width after steps.
pub const WIDTH_IN_STEPS: Bound = Bound {
    of: "half-backlash after 8 s of steps between two places under the compensation, relative, root mean square of all",
    limit: 0.02,
    measured: 0.015,
    reason: "Each flank is met mostly at one of the places; near the middle, where teeth part and land, both are.",
};

/// The same in the worst of them.
pub const WIDTH_IN_STEPS_WORST: Bound = Bound {
    of: "half-backlash after 8 s of steps between two places under the compensation, relative, worst",
    limit: 0.04,
    measured: 0.028,
    reason: "What a record of steps says of the width scatters by that: half a micrometre of twenty.",
};

/// Width after two short touches.
pub const WIDTH_IN_PASSING: Bound = Bound {
    of: "half-backlash after a push that sends the link from flank to flank, relative",
    limit: 0.08,
    measured: 0.042,
    reason: "Two contacts of some 15 ms each; the width then counts as known.",
};

/// Time until the width is right to 5 % for good, counted from the first crossing's end.
pub const WIDTH_AFTER: Bound = Bound {
    of: "time from first contact on both flanks until the width is right to 5 % for good [s]",
    limit: 1.0,
    measured: 0.19,
    reason: "What commissioning may take.",
};

/// Gain from the error maps.
pub const WITHOUT_MAP: Bound = Bound {
    of: "error of the gap coordinate with the error maps over the one without",
    limit: 0.2,
    measured: 0.039,
    reason: "Five times better at least: harmonics of 0.1 degrees are 15 % of the gap.",
};

/// Harmonics beyond the map.
pub const FOURTH_HARMONIC: Bound = Bound {
    of: "error of the gap coordinate with 0.02 degrees four times a turn besides, RMS over the gap, more than without",
    limit: 0.01,
    measured: 7.8e-3,
    reason: "It is not in the map: 2.5 um of gap coordinate.",
};

/// Single against double precision.
pub const SINGLE_PRECISION: Bound = Bound {
    of: "gap coordinate in f32 less the one in f64, RMS over the gap, at the start and after 300 turns",
    limit: 1e-4,
    measured: 1.5e-7,
    reason: "Counts are whole numbers; only differences become floating point.",
};

/// Torque bias of 5 %.
pub const GAP_WITH_BIAS: Bound = Bound {
    of: "error of the gap coordinate with a torque bias of 5 % of the limit, RMS over the gap",
    limit: 0.03,
    measured: 7e-3,
    reason: "It is read inside the gap, where the meshes carry nothing.",
};

/// Finding a failed output encoder.
pub const FAILURE_FOUND: Bound = Bound {
    of: "time until a frozen output encoder is given up while the joint turns [s]",
    limit: 15e-3,
    measured: 9.4e-3,
    reason: "Four milliseconds are waited, so that no impact looks like a failure; before the width is known, the motor goes on by all that it may be first.",
};

/// Time until a frozen or jumping output encoder is given up at speed.
pub const FAILURE_FOUND_AT_SPEED: Bound = Bound {
    of: "time until an output encoder that freezes or jumps is given up while the link turns by 0.4 rad/s or more [s]",
    limit: 1e-3,
    measured: 0.4e-3,
    reason: "A link goes on for that long whatever it runs into; until then the law is driven by what is not.",
};

/// Finding an output encoder that loses few counts.
pub const LOST_COUNTS_FOUND: Bound = Bound {
    of: "time until an output encoder that loses 0.3 % of its counts to and fro is given up [s]",
    limit: 0.4,
    measured: 0.25,
    reason: "Half a swing at 1 Hz: then the gap seems narrower on one flank or the other, as no wear makes it.",
};

/// Honesty without an output encoder, in the motions that it was stated for.
pub const MOTOR_ONLY_HONESTY: Bound = Bound {
    of: "squared error of the gap over its variance, motor only, mean over the time that counts as valid",
    limit: 3.84,
    measured: 0.14,
    reason: "The 95 % point of one squared standard deviation: separations are few and each is one draw.",
};

/// The width probe.
pub const PROBED_WIDTH: Bound = Bound {
    of: "half-backlash from the probe, relative",
    limit: 0.1,
    measured: 0.021,
    reason: "Friction of the motor leaves some 4 N of wind-up open on each flank.",
};

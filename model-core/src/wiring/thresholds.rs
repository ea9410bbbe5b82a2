//! Thresholds of the wiring check, and the times and travels of its design.

use crate::numbers::thresholds;

thresholds! {
    /// Judgement of the wiring (`judge`, `line`). Checked by `model-core/tests/wiring.rs`.
    JUDGE: JudgeThresholds {
        /// Least travel that counts as motion [counts]; noise is smaller.
        min_motion: i64 = 8,
        /// Least travel of a shaft in a block from which a direction of motion is taken [counts].
        min_block_travel: i64 = 3,
        /// Largest change of an encoder's counts that noise causes while the shaft stands still [counts].
        flicker: i64 = 4,
        /// Largest error of the counts per turn that is recognised, as a power of two [bits].
        max_bits: usize = 5,
        /// Consecutive blocks with a torque of one sign before torque is compared with motion: after a change of sign
        /// the motor crosses the gap.
        same_sign_blocks: u8 = 3,
        /// Number of calls before the time stamps of the samples are judged.
        min_calls: u32 = 32,
        /// Number of points of a fitted line from which on the weight of older points decays, so that sums keep their
        /// precision.
        fading_points: u16 = 4096,
        /// Least number of points that determine a fitted line.
        min_points: u16 = 8,
    }
}

thresholds! {
    /// Motion of the wiring check (`check`). Checked by `model-core/tests/wiring.rs`.
    CHECK: CheckThresholds {
        /// Number of legs of a check; in a leg the motor pushes in one direction. Derived: two legs in each direction,
        /// to separate dry friction from torque and lost motion from ratio.
        legs: u8 = 4,
        /// Largest number of further brakings after a leg, each while a shaft still moves.
        brakings: u8 = 4,
        /// Largest change of an encoder's counts that noise causes during a pause [counts].
        rest_flicker: i64 = 4,
        /// Largest creep of a shaft that counts as standing during a pause, over the travel of a leg, as a negative
        /// power of two.
        creep_shift: u32 = 5,
        /// Speed at which braking ends, over the speed at which braking began, as a negative power of two.
        stopped_shift: u32 = 4,
        /// Motor travel that ends a leg or the check even if the output travels less than the ratio requires, over the
        /// limit of the motor travel [-].
        unmatched_travel_factor: u64 = 3,
    }
}

#[cfg(feature = "design")]
thresholds! {
    /// Design of the wiring check (`design`). Checked by `model-core/tests/wiring.rs`.
    WIRING_DESIGN: WiringDesign {
        /// Output travel of a leg over the slack between motor and output, equation (1) [-]: the ratio is measured
        /// within 4 %. Gears of neighbouring ratios are 7 % apart (5 and 14/3).
        travel: f64 = 25.0,
        /// Least travel of a leg [counts of the coarser encoder]: the travel is measured within 2 %.
        min_counts: f64 = 200.0,
        /// Least travel of the shaft that moves first [counts of this shaft's encoder, and counts by which the other
        /// shaft would have followed].
        lead_counts: f64 = 8.0,
        /// Largest output travel of a leg [rad]: 14 degrees.
        furthest: f64 = 0.25,
        /// Travel at which braking begins, over the travel of a leg [-].
        braked: f64 = 0.5,
        /// Travel of the output from the start at which the check ends, over the travel of a leg [-]: legs alternate,
        /// and friction of unequal size makes the legs drift. An encoder with four times too few counts doubles the
        /// travel; this limit is larger.
        limit: f64 = 2.5,
        /// Time in which the torque rises to its largest value [s]: long compared with a crossing of the gap, so that
        /// landings are soft.
        rise: f64 = 1.0,
        /// Torque that sets a joint in motion [torque uncertainties]: bias and dry friction of motor and link, two
        /// standard deviations.
        friction: f64 = 4.0,
        /// Change of the travel from one block to the next that the torque uncertainty causes [counts]; determines the
        /// length of a block.
        block_counts: f64 = 8.0,
        /// Shortest and longest block [s].
        block: [f64; 2] = [1e-3, 20e-3],
        /// Pause without torque before each leg [s].
        rest: f64 = 50e-3,
        /// Time over which the speed of a braked shaft is measured [s].
        window: f64 = 3e-3,
        /// Time after which a leg at full torque ends although the joint has not travelled far enough, and longest time
        /// of a braking [s].
        hold: f64 = 0.5,
        /// Time after which the check ends [s].
        longest: f64 = 20.0,
        /// Tolerance of the ratio, added to slack over travel [-]: backlash and compliance of the joint file are
        /// guesses.
        ratio_tolerance: f64 = 0.02,
        /// Tolerance of the torque as a factor [-]: between 1 and 2.5, the factor between units that are mistaken for
        /// one another, as `identify` limits the inertia.
        torque_factor: f64 = 1.6,
    }
}

#[cfg(feature = "sensitivity")]
pub(crate) fn list() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [JUDGE.list(), CHECK.list(), WIRING_DESIGN.list()].concat()
}

//! The profiles `any` and `real`. `any`: a motion that each seed draws, and in many of them a load on the link, both together within the
//! motor's torque. What is drawn depends on the seed and the true joint only, so that any one of ten thousand is run
//! again by its number. `real`: one of seven motions that joints of robots make, its size drawn likewise.

use std::f64::consts::TAU;

use joint_file::JointFile;
use reference::closed_loop::rivals::Knowledge;

use super::file::{MotionProfile, ProfileLoad, RealMotion, STEPS, Trajectory, Wave};
use super::random::{NumberOrRange, RandomStream};

/// Part of what the motor can give that motion and load may take together. The rest is the controllers', for their
/// feedback and for torque constants that are less than they say.
pub(super) const TAKEN: f64 = 0.8;
/// Least and most that a motion takes of that, and a load of what a motion leaves.
const SHARE: NumberOrRange = NumberOrRange::Between(0.1, 0.9);
/// From the slowest to the fastest motion [Hz].
const FREQUENCY: [f64; 2] = [0.1, 3.0];
/// From the slowest to the fastest load [Hz].
const LOAD_FREQUENCY: [f64; 2] = [0.3, 2.0];
/// Durations of a move [s], from steps to moves that are no shorter than those of an arm.
const MOVE: [f64; 2] = [0.04, 1.0];
/// Durations of a move of a real joint [s].
const REAL_MOVE: [f64; 2] = [0.1, 0.6];
/// Shortest rests between moves [s].
const REST: NumberOrRange = NumberOrRange::Between(0.2, 1.0);
/// A slow motion goes no farther than this [rad].
const FARTHEST: f64 = 0.6;
/// Most of a load to and fro, beyond what friction takes of it, over the rated torque [-]: it changes by 5 N m in 20 ms on Q1.
const HARDEST_LOAD: f64 = 2.5 / 12.0;
/// Part of the motions that go under a load; holds always do.
const LOADED: f64 = 0.4;
/// Largest acceleration of a least-jerk path, times its duration squared over its height: 10 / sqrt(3).
const LEAST_JERK: f64 = 5.773_502_691_896_258;
/// Largest acceleration of five sines over their standard deviation and the square of the highest's rate, all of them at
/// the upper ends of their fifths: sqrt(2/5) (1 + 4 + 9 + 16 + 25) / 25.
const FIVE_SINES: f64 = 1.391_402_175_4;

/// The motion and the load of a seed, for a joint as it truly is.
pub fn any_motion(joint: &Knowledge, truth: &JointFile, seed: u64) -> MotionProfile {
    let mut stream = RandomStream::new(seed, "any motion");
    let usual = MotionProfile::of_kind("any");
    let inertia = joint.total_inertia * joint.ratio * joint.ratio;
    let room = TAKEN * torque_left(joint, truth);
    let kind = stream.uniform();
    let share = SHARE.draw(&mut stream);
    // A weight that the motor can hardly hold leaves no motion but a slow one.
    let acceleration = (share * room).max(0.0) / inertia;
    let frequency = evenly_in_logarithm(FREQUENCY, &mut stream);
    let duration = evenly_in_logarithm(MOVE, &mut stream);
    let rest = REST.draw(&mut stream);
    let rate = TAU * frequency;
    let trajectory = match kind {
        ..0.3 => Trajectory::Sine((acceleration / (rate * rate)).min(FARTHEST), frequency),
        ..0.5 => Trajectory::Random((acceleration / (FIVE_SINES * rate * rate)).min(0.5 * FARTHEST), frequency),
        ..0.8 => Trajectory::Steps((acceleration * duration * duration / LEAST_JERK).min(FARTHEST), duration, rest),
        _ => Trajectory::Hold(0.0),
    };
    let holds = matches!(trajectory, Trajectory::Hold(_));
    let loaded = stream.uniform() < LOADED || holds;
    let left = if holds { room } else { (1.0 - share) * room };
    let most = (HARDEST_LOAD * truth.parameters.rated_output_torque).min(left.max(0.0));
    // A load that the link's friction holds moves nothing, and there is nothing to compare.
    let held = if holds { break_away(joint, truth) } else { 0.0 };
    let torque = held + SHARE.draw(&mut stream) * most;
    let wave = if stream.uniform() < 0.7 { Wave::Walk } else { Wave::Sine };
    let load = ProfileLoad::Wave(wave, Some(torque), evenly_in_logarithm(LOAD_FREQUENCY, &mut stream));
    MotionProfile { trajectory, load: if loaded { load } else { ProfileLoad::None }, ..usual }
}

/// One of the motions of real joints for a seed, at most as large as the motor can follow with the heaviest payload.
pub fn real_motion(motion: Option<RealMotion>, joint: &Knowledge, truth: &JointFile, seed: u64) -> MotionProfile {
    let mut stream = RandomStream::new(seed, "real motion");
    let room = (TAKEN * torque_left(joint, truth)).max(0.0);
    let heavier = truth.surroundings.payload_step.ratio.max(1.0) - 1.0;
    let inertia = joint.total_inertia * joint.ratio * joint.ratio + heavier * truth.parameters.link_inertia;
    let acceleration = SHARE.draw(&mut stream) * room / inertia;
    // Drawn for every motion, so that the draws of one do not depend on which one it is.
    let duration = evenly_in_logarithm(REAL_MOVE, &mut stream);
    let rest = REST.draw(&mut stream);
    let load = (SHARE.draw(&mut stream) * HARDEST_LOAD * truth.parameters.rated_output_torque).min(room);
    let of_sine = |frequency: f64, most: f64| (acceleration / (TAU * frequency).powi(2)).min(most);
    let (trajectory, load) = match motion.unwrap_or(RealMotion::of_seed(seed)) {
        RealMotion::Sine => (Trajectory::Sine(of_sine(1.0, FARTHEST), 1.0), ProfileLoad::None),
        RealMotion::SlowSine => (Trajectory::Sine(of_sine(0.15, FARTHEST), 0.15), ProfileLoad::None),
        RealMotion::Random => (Trajectory::Random(of_sine(2.0, 0.5 * FARTHEST) / FIVE_SINES, 2.0), ProfileLoad::None),
        RealMotion::Moves => {
            let height = (acceleration * duration * duration / LEAST_JERK).min(FARTHEST);
            (Trajectory::Steps(height, duration, rest), ProfileLoad::None)
        }
        RealMotion::DisturbedHold => {
            let wave = ProfileLoad::Wave(Wave::Walk, Some(break_away(joint, truth) + load), 1.0);
            (Trajectory::Hold(0.0), wave)
        }
        RealMotion::Walking => {
            // What the foot takes of the torque is not there for the swing; the largest acceleration is 2 of the first harmonic's.
            let left = 0.5 * (acceleration - load / inertia).max(0.1 * acceleration);
            let amplitude = (1.5 * left / (TAU * STEPS).powi(2)).min(FARTHEST);
            (Trajectory::Walking(amplitude, STEPS), ProfileLoad::Stance(Some(load), STEPS))
        }
        RealMotion::Rest => (Trajectory::Hold(0.0), ProfileLoad::None),
    };
    MotionProfile { trajectory, load, ..MotionProfile::of_kind("real") }
}

/// What is left of the motor's torque, at the link, for acceleration and load [N m].
pub(super) fn torque_left(joint: &Knowledge, truth: &JointFile) -> f64 {
    let around = &truth.surroundings;
    let errors = &around.torque_errors;
    let motor = around.torque_limit
        * (1.0 + around.torque_constant_error_ratio.min(0.0))
        * (1.0 - errors.saturation_ratio)
        * (1.0 - errors.ripple_ratio);
    let at_motor = motor - joint.motor_friction - around.cogging_torque;
    let weight = around.payload_step.ratio.max(1.0) * joint.gravity.abs();
    around.efficiency * joint.ratio * at_motor - weight - break_away(joint, truth)
}

/// Dry friction of the link at rest [N m].
pub(super) fn break_away(joint: &Knowledge, truth: &JointFile) -> f64 {
    (1.0 + truth.surroundings.load_friction.stribeck_rise_ratio) * joint.load_friction
}

fn evenly_in_logarithm([low, high]: [f64; 2], stream: &mut RandomStream) -> f64 {
    low * (high / low).powf(stream.uniform())
}

//! The profiles `any` and `real`. `any`: a random motion for each seed, often with a load on the link, both within the
//! motor's torque. The draws depend on the seed and the true joint only, so each of ten thousand seeds can be repeated
//! alone. `real`: one of seven motions of robot joints, of random size.

use std::f64::consts::TAU;

use joint_file::JointFile;
use reference::closed_loop::rivals::Knowledge;

use super::file::{MotionProfile, ProfileLoad, RealMotion, STEPS, Trajectory, Wave};
use super::random::{NumberOrRange, RandomStream};

/// Share of the motor's torque available to motion and load together [-]. The rest is for feedback and for torque
/// constants below their stated values.
pub(super) const TAKEN: f64 = 0.8;
/// Range of a motion's share of the available torque, and of a load's share of the remainder [-].
const SHARE: NumberOrRange = NumberOrRange::Between(0.1, 0.9);
/// Range of motion frequencies [Hz].
const FREQUENCY: [f64; 2] = [0.1, 3.0];
/// Range of load frequencies [Hz].
const LOAD_FREQUENCY: [f64; 2] = [0.3, 2.0];
/// Range of durations of a move [s], from steps to moves as fast as an arm's.
const MOVE: [f64; 2] = [0.04, 1.0];
/// Range of durations of a move of a real joint [s].
const REAL_MOVE: [f64; 2] = [0.1, 0.6];
/// Range of the shortest rest between moves [s].
const REST: NumberOrRange = NumberOrRange::Between(0.2, 1.0);
/// Largest amplitude of a slow motion [rad].
const FARTHEST: f64 = 0.6;
/// Largest alternating load beyond the friction, over the rated torque [-]: a change of 5 N m in 20 ms on Q1.
const HARDEST_LOAD: f64 = 2.5 / 12.0;
/// Share of the motions that run under a load; holds always do.
const LOADED: f64 = 0.4;
/// Largest acceleration of a least-jerk path, times its duration squared over its height: 10 / sqrt(3).
const LEAST_JERK: f64 = 5.773_502_691_896_258;
/// Largest acceleration of five sines over their standard deviation and the square of the highest angular frequency,
/// each sine at the upper end of its fifth: sqrt(2/5) (1 + 4 + 9 + 16 + 25) / 25.
const FIVE_SINES: f64 = 1.391_402_175_4;

/// Motion and load of a seed for the true joint.
pub fn any_motion(joint: &Knowledge, truth: &JointFile, seed: u64) -> MotionProfile {
    let mut stream = RandomStream::new(seed, "any motion");
    let usual = MotionProfile::of_kind("any");
    let inertia = joint.total_inertia * joint.ratio * joint.ratio;
    let room = TAKEN * torque_left(joint, truth);
    let kind = stream.uniform();
    let share = SHARE.draw(&mut stream);
    // If the motor can hardly hold the weight, only a slow motion is left.
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
    // A load below the link's friction would move nothing.
    let held = if holds { break_away(joint, truth) } else { 0.0 };
    let torque = held + SHARE.draw(&mut stream) * most;
    let wave = if stream.uniform() < 0.7 { Wave::Walk } else { Wave::Sine };
    let load = ProfileLoad::Wave(wave, Some(torque), evenly_in_logarithm(LOAD_FREQUENCY, &mut stream));
    MotionProfile { trajectory, load: if loaded { load } else { ProfileLoad::None }, ..usual }
}

/// Real motion of a seed, within the motor's torque even with the heaviest payload.
pub fn real_motion(motion: Option<RealMotion>, joint: &Knowledge, truth: &JointFile, seed: u64) -> MotionProfile {
    let mut stream = RandomStream::new(seed, "real motion");
    let room = (TAKEN * torque_left(joint, truth)).max(0.0);
    let heavier = truth.surroundings.payload_step.ratio.max(1.0) - 1.0;
    let inertia = joint.total_inertia * joint.ratio * joint.ratio + heavier * truth.parameters.link_inertia;
    let acceleration = SHARE.draw(&mut stream) * room / inertia;
    // Drawn for every kind of motion, so that the draws do not depend on the kind.
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
            // The foot's load reduces the torque for the swing; the largest acceleration is twice that of the first
            // harmonic.
            let left = 0.5 * (acceleration - load / inertia).max(0.1 * acceleration);
            let amplitude = (1.5 * left / (TAU * STEPS).powi(2)).min(FARTHEST);
            (Trajectory::Walking(amplitude, STEPS), ProfileLoad::Stance(Some(load), STEPS))
        }
        RealMotion::Rest => (Trajectory::Hold(0.0), ProfileLoad::None),
    };
    MotionProfile { trajectory, load, ..MotionProfile::of_kind("real") }
}

/// Motor torque left for acceleration and load, at the link [N m].
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

//! The profiles `any` and `real`. `any`: a random motion for each seed, often with a load on the link, both within the
//! motor's torque. The draws depend on the seed and the true joint only, so each of ten thousand seeds can be repeated
//! alone. `real`: one of seven motions of robot joints, of random size.

use std::f64::consts::TAU;

use joint_file::JointFile;
use reference::closed_loop::rivals::Knowledge;

use super::file::{MotionProfile, ProfileLoad, RealMotion, STEP_RATE, Trajectory, Wave};
use super::random::{NumberOrRange, RandomStream};

/// Share of the motor's torque available to motion and load together [-]. The rest is for feedback and for torque
/// constants below their stated values.
pub(super) const USABLE_TORQUE_SHARE: f64 = 0.8;
/// Range of a motion's share of the available torque, and of a load's share of the remainder [-].
const SHARE_RANGE: NumberOrRange = NumberOrRange::Between(0.1, 0.9);
/// Range of motion frequencies [Hz].
const FREQUENCY_RANGE: [f64; 2] = [0.1, 3.0];
/// Range of load frequencies [Hz].
const LOAD_FREQUENCY_RANGE: [f64; 2] = [0.3, 2.0];
/// Range of durations of a move [s], from steps to moves as fast as an arm's.
const MOVE_DURATION: [f64; 2] = [0.04, 1.0];
/// Range of durations of a move of a real joint [s].
const REAL_MOVE_DURATION: [f64; 2] = [0.1, 0.6];
/// Range of the shortest rest between moves [s].
const REST_DURATION: NumberOrRange = NumberOrRange::Between(0.2, 1.0);
/// Largest amplitude of a slow motion [rad].
const MAX_AMPLITUDE: f64 = 0.6;
/// Largest alternating load beyond the friction, over the rated torque [-]: a change of 5 N m in 20 ms on Q1.
const MAX_LOAD_RATIO: f64 = 2.5 / 12.0;
/// Share of the motions that run under a load; holds always do.
const LOADED_SHARE: f64 = 0.4;
/// Largest acceleration of a least-jerk path, times its duration squared over its height: 10 / sqrt(3).
const LEAST_JERK_ACCELERATION: f64 = 5.773_502_691_896_258;
/// Largest acceleration of five sines over their standard deviation and the square of the highest angular frequency,
/// each sine at the upper end of its fifth: sqrt(2/5) (1 + 4 + 9 + 16 + 25) / 25.
const FIVE_SINES_ACCELERATION: f64 = 1.391_402_175_4;

/// Motion and load of a seed for the true joint.
pub fn any_motion(joint: &Knowledge, truth: &JointFile, seed: u64) -> MotionProfile {
    let mut stream = RandomStream::new(seed, "any motion");
    let default = MotionProfile::default_of_kind("any");
    let inertia = joint.total_inertia * joint.ratio * joint.ratio;
    let room = USABLE_TORQUE_SHARE * available_torque(joint, truth);
    let kind = stream.uniform();
    let share = SHARE_RANGE.draw(&mut stream);
    // If the motor can hardly hold the weight, only a slow motion is left.
    let acceleration = (share * room).max(0.0) / inertia;
    let frequency = log_uniform(FREQUENCY_RANGE, &mut stream);
    let duration = log_uniform(MOVE_DURATION, &mut stream);
    let rest = REST_DURATION.draw(&mut stream);
    let rate = TAU * frequency;
    let trajectory = match kind {
        ..0.3 => Trajectory::Sine((acceleration / (rate * rate)).min(MAX_AMPLITUDE), frequency),
        ..0.5 => Trajectory::Random(
            (acceleration / (FIVE_SINES_ACCELERATION * rate * rate)).min(0.5 * MAX_AMPLITUDE),
            frequency,
        ),
        ..0.8 => Trajectory::Steps(
            (acceleration * duration * duration / LEAST_JERK_ACCELERATION).min(MAX_AMPLITUDE),
            duration,
            rest,
        ),
        _ => Trajectory::Hold(0.0),
    };
    let holds = matches!(trajectory, Trajectory::Hold(_));
    let loaded = stream.uniform() < LOADED_SHARE || holds;
    let left = if holds { room } else { (1.0 - share) * room };
    let most = (MAX_LOAD_RATIO * truth.parameters.rated_output_torque).min(left.max(0.0));
    // A load below the link's friction would move nothing.
    let held = if holds { breakaway_torque(joint, truth) } else { 0.0 };
    let torque = held + SHARE_RANGE.draw(&mut stream) * most;
    let wave = if stream.uniform() < 0.7 { Wave::Walk } else { Wave::Sine };
    let load = ProfileLoad::Wave(wave, Some(torque), log_uniform(LOAD_FREQUENCY_RANGE, &mut stream));
    MotionProfile { trajectory, load: if loaded { load } else { ProfileLoad::None }, ..default }
}

/// Real motion of a seed, within the motor's torque even with the heaviest payload.
pub fn real_motion(motion: Option<RealMotion>, joint: &Knowledge, truth: &JointFile, seed: u64) -> MotionProfile {
    let mut stream = RandomStream::new(seed, "real motion");
    let room = (USABLE_TORQUE_SHARE * available_torque(joint, truth)).max(0.0);
    let heavier = truth.surroundings.payload_step.ratio.max(1.0) - 1.0;
    let inertia = joint.total_inertia * joint.ratio * joint.ratio + heavier * truth.parameters.link_inertia;
    let acceleration = SHARE_RANGE.draw(&mut stream) * room / inertia;
    // Drawn for every kind of motion, so that the draws do not depend on the kind.
    let duration = log_uniform(REAL_MOVE_DURATION, &mut stream);
    let rest = REST_DURATION.draw(&mut stream);
    let load = (SHARE_RANGE.draw(&mut stream) * MAX_LOAD_RATIO * truth.parameters.rated_output_torque).min(room);
    let of_sine = |frequency: f64, most: f64| (acceleration / (TAU * frequency).powi(2)).min(most);
    let (trajectory, load) = match motion.unwrap_or(RealMotion::for_seed(seed)) {
        RealMotion::Sine => (Trajectory::Sine(of_sine(1.0, MAX_AMPLITUDE), 1.0), ProfileLoad::None),
        RealMotion::SlowSine => (Trajectory::Sine(of_sine(0.15, MAX_AMPLITUDE), 0.15), ProfileLoad::None),
        RealMotion::Random => {
            (Trajectory::Random(of_sine(2.0, 0.5 * MAX_AMPLITUDE) / FIVE_SINES_ACCELERATION, 2.0), ProfileLoad::None)
        }
        RealMotion::Moves => {
            let height = (acceleration * duration * duration / LEAST_JERK_ACCELERATION).min(MAX_AMPLITUDE);
            (Trajectory::Steps(height, duration, rest), ProfileLoad::None)
        }
        RealMotion::DisturbedHold => {
            let wave = ProfileLoad::Wave(Wave::Walk, Some(breakaway_torque(joint, truth) + load), 1.0);
            (Trajectory::Hold(0.0), wave)
        }
        RealMotion::Walking => {
            // The foot's load reduces the torque for the swing; the largest acceleration is twice that of the first
            // harmonic.
            let left = 0.5 * (acceleration - load / inertia).max(0.1 * acceleration);
            let amplitude = (1.5 * left / (TAU * STEP_RATE).powi(2)).min(MAX_AMPLITUDE);
            (Trajectory::Walking(amplitude, STEP_RATE), ProfileLoad::Stance(Some(load), STEP_RATE))
        }
        RealMotion::Rest => (Trajectory::Hold(0.0), ProfileLoad::None),
    };
    MotionProfile { trajectory, load, ..MotionProfile::default_of_kind("real") }
}

/// Motor torque left for acceleration and load, at the link [N m].
pub(super) fn available_torque(joint: &Knowledge, truth: &JointFile) -> f64 {
    let surroundings = &truth.surroundings;
    let errors = &surroundings.torque_errors;
    let motor = surroundings.torque_limit
        * (1.0 + surroundings.torque_constant_error_ratio.min(0.0))
        * (1.0 - errors.saturation_ratio)
        * (1.0 - errors.ripple_ratio);
    let at_motor = motor - joint.motor_friction - surroundings.cogging_torque;
    let weight = surroundings.payload_step.ratio.max(1.0) * joint.gravity.abs();
    surroundings.efficiency * joint.ratio * at_motor - weight - breakaway_torque(joint, truth)
}

/// Dry friction of the link at rest [N m].
pub(super) fn breakaway_torque(joint: &Knowledge, truth: &JointFile) -> f64 {
    (1.0 + truth.surroundings.load_friction.stribeck_rise_ratio) * joint.load_friction
}

fn log_uniform([low, high]: [f64; 2], stream: &mut RandomStream) -> f64 {
    low * (high / low).powf(stream.uniform())
}

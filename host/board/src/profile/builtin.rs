//! Built-in profile: torque steps of both signs through the gap on a turning joint. It is derived from the joint's
//! rated torque, ratio and inertia, so that it runs on any joint.

use std::f64::consts::TAU;

use joint_file::sheet;
use model_core::gears::Kinematics;
use parameters::JointParameters;

use super::torques::Torques;

/// Names of the built-in profiles.
pub const BUILTIN: [&str; 1] = ["reversals"];
/// Length of the built-in profile; longer runs repeat it [s].
pub const DURATION: f64 = 5.0;

/// Load levels as (start time [s], torque over rated torque); drive and load are balanced. Reversals cross the gap at
/// full torque: at a small torque the planets would rattle too long for any comparison afterwards.
const LEVELS: [(f64, f64); 11] = [
    (0.0, 1.0),
    (0.5, 0.5),
    (0.8, 1.0),
    (1.2, -1.0),
    (1.7, -0.5),
    (2.0, -1.0),
    (2.5, 1.0),
    (3.0, 0.3),
    (3.4, 1.0),
    (4.0, -1.0),
    (4.5, 1.0),
];
/// Slope of a torque step, in rated torques per second: 50 ms from full torque to the opposite one.
const SLEW: f64 = 40.0;
/// Speed of the link after the run-up: a quarter turn per second [rad/s].
const SPEED: f64 = TAU / 4.0;
/// Time in which the drive torque also accelerates the joint [s].
const RUN_UP: f64 = 0.3;

/// Torques at a time of the profile.
pub fn reversals(joint: &JointParameters, time: f64) -> Torques {
    let ratio = joint.geometry.ratio_by_radii();
    let load = joint.rated_output_torque * level(time);
    let acceleration = if time < RUN_UP { SPEED / RUN_UP } else { 0.0 };
    Torques { drive: (load + sheet::inertia_at_link(joint) * acceleration) / ratio, load }
}

/// Load over rated torque: steps with linear slopes.
fn level(time: f64) -> f64 {
    let time_in_period = time.rem_euclid(DURATION);
    let step = LEVELS.partition_point(|&(start, _)| start <= time_in_period).saturating_sub(1);
    let (start, to) = LEVELS[step];
    // The last level continues into the next period; the torque is zero before the first level of all.
    let from = match step {
        0 if time < DURATION => 0.0,
        0 => LEVELS[LEVELS.len() - 1].1,
        _ => LEVELS[step - 1].1,
    };
    let way = to - from;
    from + way.clamp(-SLEW * (time_in_period - start), SLEW * (time_in_period - start))
}

#[cfg(test)]
mod tests {
    use model_core::gears::Mechanics;

    use super::*;

    fn joints() -> impl Iterator<Item = JointParameters> {
        joint_file::PRESETS.iter().map(|name| {
            let text = joint_file::preset(name).expect("a preset");
            joint_file::read(text).expect("a good preset").parameters
        })
    }

    /// The load reverses at least four times and never exceeds the rated torque.
    #[test]
    fn load_reverses_within_rated_torque() {
        for joint in joints() {
            let rated = joint.rated_output_torque;
            let loads: Vec<f64> = (0..50_000).map(|k| reversals(&joint, 1e-4 * f64::from(k)).load).collect();
            let reversals = loads.windows(2).filter(|pair| pair[0] * pair[1] < 0.0 || pair[1] == 0.0).count();
            assert!(reversals >= 4, "{}: {reversals}", joint.name);
            assert!(loads.iter().all(|load| load.abs() <= rated * 1.000_001), "{}", joint.name);
        }
    }

    /// After the run-up drive and load torque balance.
    #[test]
    fn torques_balanced_after_run_up() {
        for joint in joints() {
            for time in [0.31, 1.22, 2.6, 7.3] {
                let torques = reversals(&joint, time);
                let balanced = joint.balanced_load_torque(torques.drive);
                assert!((torques.load - balanced).abs() <= 1e-12 * balanced.abs(), "{}", joint.name);
            }
        }
    }

    /// The load is continuous over the end of a period.
    #[test]
    fn repeated_profile_continuous() {
        let before = level(DURATION - 1e-9);
        assert!((level(DURATION + 1e-9) - before).abs() < 1e-6);
    }
}

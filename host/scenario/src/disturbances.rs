//! Disturbance torques on the link: of the profile, of the file, and of a recorded motion. Torques without a stated
//! value scale with the rated torque.

use reference::drive_train::Disturbance;

use super::file::{MotionProfile, ProfileLoad, TestFile, Wave};
use super::recorded::RecordedMotion;

/// Disturbance of a hold over the rated torque [-]: 1.5 N m for Q1.
const HOLD_TORQUE_RATIO: f64 = 0.125;
/// Torque of an impact over the rated torque [-].
const IMPACT_TORQUE_RATIO: f64 = 3.0;

/// Time from the pulse of a free hold to the start of the figures [s].
const PULSE_LEAD: f64 = 0.1;

/// Time in which a foot is set down or lifted [s].
const FOOT_RAMP: f64 = 0.02;

/// Load of a foot over the rated torque [-]: 3 N m for Q1. Assumed.
const STANCE_TORQUE_RATIO: f64 = 0.25;

/// Share of a step with the foot on the ground [-], as in human walking.
const STANCE_SHARE: f64 = 0.6;

/// Length of the touch-down pulse, of half the foot's load [s]. Assumed.
const TOUCH_DOWN_LENGTH: f64 = 0.01;

/// All torques on the link in a run of a file, with the load of its profile.
pub fn disturbances(
    file: &TestFile,
    profile: &MotionProfile,
    recorded: Option<&RecordedMotion>,
    rated: f64,
) -> Vec<Disturbance> {
    let mut list = Vec::new();
    match profile.load {
        ProfileLoad::None => {}
        ProfileLoad::Wave(Wave::Sine, torque, frequency) => {
            list.push(Disturbance::Sine { amplitude: torque.unwrap_or(HOLD_TORQUE_RATIO * rated), frequency });
        }
        ProfileLoad::Wave(wave @ (Wave::Square | Wave::Walk), torque, frequency) => {
            let torque = torque.unwrap_or(HOLD_TORQUE_RATIO * rated);
            let half = 0.5 / frequency;
            let turns = (file.duration / half) as usize;
            list.extend((0..=turns).map(|turn| {
                let start = turn as f64 * half;
                let sign = if turn % 2 == 1 { -2.0 } else { 2.0 };
                let torque = if turn == 0 { torque } else { sign * torque };
                match wave {
                    Wave::Walk => Disturbance::Ramp { start, duration: FOOT_RAMP, torque },
                    _ => Disturbance::Step { start, torque },
                }
            }));
        }
        ProfileLoad::Stance(torque, frequency) => {
            let torque = torque.unwrap_or(STANCE_TORQUE_RATIO * rated);
            let steps = (file.duration * frequency) as usize;
            list.extend((0..=steps).flat_map(|step| {
                let start = step as f64 / frequency;
                let end = start + STANCE_SHARE / frequency;
                [
                    Disturbance::Pulse { start, duration: TOUCH_DOWN_LENGTH, torque: 0.5 * torque },
                    Disturbance::Ramp { start, duration: FOOT_RAMP, torque },
                    Disturbance::Ramp { start: end, duration: FOOT_RAMP, torque: -torque },
                ]
            }));
        }
        ProfileLoad::Kick(torque, length) => {
            let torque = torque.unwrap_or(HOLD_TORQUE_RATIO * rated);
            list.push(Disturbance::Pulse { start: (file.settle - PULSE_LEAD).max(0.0), duration: length, torque });
        }
        ProfileLoad::Impacts(torque, length) => {
            let torque = torque.unwrap_or(IMPACT_TORQUE_RATIO * rated);
            let disturbances = (file.duration - file.settle).ceil() as usize;
            list.extend((0..disturbances).map(|push| {
                let sign = if push % 2 == 0 { 1.0 } else { -1.0 };
                Disturbance::Pulse { start: file.settle + push as f64 + 0.2, duration: length, torque: sign * torque }
            }));
        }
        ProfileLoad::Slow(torque, frequency) => {
            list.push(Disturbance::Sine { amplitude: torque.unwrap_or(rated), frequency });
        }
    }
    list.extend(file.disturbances.iter().map(|push| match push.kind {
        "step" => Disturbance::Step { start: push.start, torque: push.torque },
        "pulse" => Disturbance::Pulse { start: push.start, duration: push.length, torque: push.torque },
        _ => Disturbance::Sine { amplitude: push.torque, frequency: push.frequency },
    }));
    if let Some(recorded) = recorded {
        let mut before = 0.0;
        for row in recorded.rows() {
            if row.load != before {
                list.push(Disturbance::Step { start: row.time, torque: row.load - before });
                before = row.load;
            }
        }
    }
    list
}

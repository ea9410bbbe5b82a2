//! Motion in the form for a board that runs the whole loop: quintic polynomials between knots that match position,
//! speed and acceleration at both ends, or impedance set-points at their own rate, with the torque on the link.

use std::f64::consts::TAU;

use link::virtual_joint::Knot;
use model_core::controller::trajectory::{Segment, Trajectory};
use reference::closed_loop::{Motion, SetPoint};

use crate::case::{Case, Designed};
use crate::controller::ControllerName;
use crate::file::TestFile;
use crate::port::command;
use crate::set_point_source::SetPointSource;

/// Largest length of a polynomial [s]: its relative error for a motion of 20 Hz is one millionth.
const MAX_SEGMENT: f64 = 5e-3;

/// Returns the knots of a test's motion in the observer's link angle, which is `zero` [turns] when the link is at angle
/// zero of the joint.
pub fn knots(file: &TestFile, case: &Case, designed: &Designed, zero: f64) -> Vec<Knot> {
    let rate = f64::from(case.nominal_surroundings.control_rate);
    let periods = (file.duration * rate).round() as u32;
    let segment = file.gains.map_or(MAX_SEGMENT, |gains| 1.0 / gains.rate);
    let every = (segment * rate).round().max(1.0) as u32;
    let mut set_points = SetPointSource::new(file, case, file.controller, Some(designed));
    let lead = f64::from(designed.compensation.crossing.lead);
    let rests = |tick: u32| {
        let at = |time: f64| is_at_rest(case.motion.at(time));
        let time = f64::from(tick) / rate;
        [at(time), file.controller == ControllerName::Preview && at(time + lead)]
    };
    let (mut list, mut tick) = (Vec::new(), 0);
    while tick < periods {
        let next = if file.gains.is_some() { tick + every } else { end_of_segment(tick, every, rests) };
        let [start, end] = [tick, next].map(|tick| f64::from(tick) / rate);
        let demand = match set_points.at(start, tick.into()).1 {
            SetPoint::Position { ahead, .. } => {
                let on_scale = |time: f64| {
                    let motion = case.motion.at(time);
                    Motion { position: motion.position + TAU * zero, ..motion }
                };
                let between = |from: f64, to: f64| polynomial(on_scale(from), on_scale(to), end - start);
                let ahead = ahead.map(|_| between(start + lead, end + lead));
                Trajectory::Position { now: between(start, end), ahead }
            }
            impedance => match command(&impedance, zero) {
                model_core::compensation::Command::Impedance(point) => Trajectory::Impedance(point),
                model_core::compensation::Command::Position { .. } => Trajectory::HOLD,
            },
        };
        let middle = 0.5 * (start + end);
        let load_torque = case.disturbances.iter().map(|push| push.torque(middle)).sum::<f64>() as f32;
        list.push(Knot { tick, load_torque, trajectory: (&demand).into() });
        tick = next;
    }
    list
}

fn is_at_rest(motion: Motion) -> bool {
    motion.speed == 0.0 && motion.acceleration == 0.0
}

/// Tick that ends a segment: where a motion comes to rest or leaves rest, at the latest after `every` periods. A
/// polynomial across such a point would start in the wrong direction.
fn end_of_segment(tick: u32, every: u32, rests: impl Fn(u32) -> [bool; 2]) -> u32 {
    let mut current = rests(tick + 1);
    let mut before = rests(tick);
    for next in tick + 1..tick + every {
        let after = rests(next + 1);
        if (0..2).any(|motion| current[motion] && !(before[motion] && after[motion])) {
            return next;
        }
        (before, current) = (current, after);
    }
    tick + every
}

/// Quintic polynomial between two states of a motion.
fn polynomial(from: Motion, to: Motion, time: f64) -> Segment<f32> {
    let way = to.position - from.position - time * (from.speed + 0.5 * time * from.acceleration);
    let gain = (to.speed - from.speed - time * from.acceleration) * time;
    let bend = (to.acceleration - from.acceleration) * time * time;
    let turns = (from.position / TAU).floor();
    let powers = [
        from.position - TAU * turns,
        from.speed,
        0.5 * from.acceleration,
        (10.0 * way - 4.0 * gain + 0.5 * bend) / time.powi(3),
        (-15.0 * way + 7.0 * gain - bend) / time.powi(4),
        (6.0 * way - 3.0 * gain + 0.5 * bend) / time.powi(5),
    ];
    Segment { turns: turns as i32, powers: powers.map(|power| (power / TAU) as f32) }
}

#[cfg(test)]
mod tests {
    use reference::closed_loop::{MotionProfile, Profile};

    use super::*;

    #[test]
    fn polynomial_follows_motion_inside() {
        let at = |time: f64| {
            let (sine, cosine) = (TAU * 20.0 * time).sin_cos();
            let rate = TAU * 20.0;
            Motion { position: 0.1 * sine - 7.0, speed: 0.1 * rate * cosine, acceleration: -0.1 * rate * rate * sine }
        };
        for start in [0.0, 0.013, 0.021] {
            let segment = polynomial(at(start), at(start + MAX_SEGMENT), MAX_SEGMENT);
            for part in [0.0, 0.3, 0.5, 0.9] {
                let (motion, wanted) =
                    (segment.at((part * MAX_SEGMENT) as f32, TAU as f32), at(start + part * MAX_SEGMENT));
                let position = TAU * (f64::from(motion.position.turns) + f64::from(motion.position.fraction));
                assert!((position - wanted.position).abs() < 2e-6, "{position} {}", wanted.position);
                assert!((f64::from(motion.speed) - wanted.speed).abs() < 1e-3 * 0.1 * TAU * 20.0);
                let error = (f64::from(motion.acceleration) - wanted.acceleration).abs();
                assert!(error < 5e-3 * 0.1 * (TAU * 20.0).powi(2), "{error}");
            }
        }
    }

    #[test]
    fn motion_from_rest_starts_forward() {
        let (height, duration) = (0.05, 0.12);
        let rate = 10e3;
        for seed in 0..5 {
            let motion = Profile::Steps { height, duration, rest: 0.2137, seed };
            let at = |tick: u32| motion.at(f64::from(tick) / rate);
            let (mut tick, mut segments, largest) = (0, 0, 5.8 * height / duration.powi(2));
            while tick < 20_000 {
                let next = end_of_segment(tick, 50, |tick| [is_at_rest(at(tick)); 2]);
                let segment = polynomial(at(tick), at(next), f64::from(next - tick) / rate);
                for between in tick..next {
                    let planned = segment.at((f64::from(between - tick) / rate) as f32, TAU as f32);
                    let error = f64::from(planned.acceleration) - at(between).acceleration;
                    assert!(error.abs() < 0.02 * largest, "seed {seed}, tick {between}: {error}");
                    if is_at_rest(at(between)) && is_at_rest(at(between + 1)) {
                        assert_eq!([planned.speed, planned.acceleration], [0.0; 2], "seed {seed}, tick {between}");
                    }
                }
                (tick, segments) = (next, segments + 1);
            }
            // Only slightly more segments than without rests, since the line's capacity is limited.
            assert!(segments < 420, "{segments}");
        }
    }
}

//! Profile of the target: a trapezoid of the speed, under a largest speed and acceleration.
//!
//! Equations, with the distance d to the end, the speed v relative to the end and the acceleration a:
//!
//! - braking: the largest speed after this period from which the profile still stops at the end, the positive root v_b of
//!   T (v + v_b) / 2 + v_b^2 / (2 a) = d;
//! - speed: v <- v_b, limited to the largest speed, changed by at most a T in a period;
//! - angle: p <- p + T (v before + v after) / 2.
//!
//! Without a largest acceleration the speed changes at once; without both limits the target is the set-point itself.

use core::f32::consts::TAU;

use super::Feedback;
use super::target::{SetPoint, Target};
use crate::scale::limit;
use crate::turns::Turns;

/// Rounding of a distance [rad]: a few hundred steps of an angle, more than f32 loses in a period's motion.
const ROUNDING: f32 = 1e-6;

/// Target in motion.
#[derive(Debug, Clone, Default)]
pub struct Profile {
    position: Turns,
    /// Speed [rad/s].
    velocity: f32,
    is_done: bool,
}

impl Profile {
    /// Begins at an angle and a speed [rad/s].
    pub fn restart(&mut self, position: Turns, velocity: f32) {
        *self = Self { position, velocity, is_done: true };
    }

    /// Angle of the target.
    pub fn position(&self) -> Turns {
        self.position
    }

    /// Speed of the target [rad/s].
    pub fn velocity(&self) -> f32 {
        self.velocity
    }

    /// True at the end of the profile.
    pub fn is_done(&self) -> bool {
        self.is_done
    }

    /// Advances set-point and profile by a period [s]; returns the set-point of this period.
    pub fn advance(&mut self, set_point: &mut SetPoint, feedback: &Feedback, period: f32) -> SetPoint {
        match set_point {
            SetPoint::Position(target) => {
                advance_target(target, period);
                self.approach(target, period);
                let moving = Target { position: self.position, velocity: self.velocity, ..*target };
                SetPoint::Position(moving)
            }
            SetPoint::Velocity { velocity, torque, max_acceleration, max_torque } => {
                let step = max_acceleration.abs() * period;
                let before = self.velocity;
                self.velocity = limit_change(before, *velocity, step);
                self.is_done = self.velocity == *velocity;
                // The integral of the speed starts anew from the measured angle: it is a speed loop.
                self.position = feedback.position;
                SetPoint::Velocity {
                    velocity: self.velocity,
                    torque: *torque,
                    max_acceleration: *max_acceleration,
                    max_torque: *max_torque,
                }
            }
            _ => {
                self.restart(feedback.position, feedback.velocity);
                *set_point
            }
        }
    }

    /// Moves the profile toward a target.
    fn approach(&mut self, target: &Target, period: f32) {
        let limits = &target.limits;
        let end_velocity = if target.velocity.is_finite() { target.velocity } else { 0.0 };
        if limits.is_none() {
            (self.position, self.velocity, self.is_done) = (target.position, end_velocity, true);
            return;
        }
        let (max_velocity, acceleration) = (limits.velocity.abs(), limits.acceleration.abs());
        // The feed-forward speed of a target at rest is no speed of its end.
        let drift = if target.moves { end_velocity } else { 0.0 };
        // The end moves during this period as well: the distance is that of the period's begin.
        let distance = target.position.minus(self.position).to_rad() - drift * period;
        let relative = self.velocity - drift;
        let step = acceleration * period;
        // Without ramps the end counts as reached within the rounding.
        let reach = if step.is_finite() { (0.5 * step * period).max(ROUNDING) } else { ROUNDING };
        if distance.abs() <= reach && relative.abs() <= step {
            (self.position, self.velocity, self.is_done) = (target.position, drift, true);
            return;
        }
        self.is_done = false;
        if step.is_finite() {
            let wanted = drift + libm::copysignf(braking_speed(distance, relative, acceleration, period), distance);
            let before = self.velocity;
            self.velocity = limit_change(before, limit(wanted, max_velocity), step);
            self.position = self.position.plus(Turns::new(0.5 * (before + self.velocity) * period / TAU));
        } else {
            // The end within this period, or as fast as is permitted.
            let wanted = drift + distance / period.max(f32::MIN_POSITIVE);
            self.velocity = limit(wanted, max_velocity);
            self.position = if self.velocity == wanted {
                target.position
            } else {
                self.position.plus(Turns::new(self.velocity * period / TAU))
            };
        }
    }
}

/// Largest speed toward the end after this period from which the profile still stops at the end [rad/s].
fn braking_speed(distance: f32, velocity: f32, acceleration: f32, period: f32) -> f32 {
    let half_step = 0.5 * acceleration * period;
    let left = distance.abs() - 0.5 * velocity * libm::copysignf(period, distance);
    (libm::sqrtf(half_step * half_step + 2.0 * acceleration * left.max(0.0)) - half_step).max(0.0)
}

/// Moves the end of a moving target, up to its stop.
fn advance_target(target: &mut Target, period: f32) {
    if !target.moves || !target.velocity.is_finite() {
        return;
    }
    let before = target.position;
    target.position = before.plus(Turns::new(target.velocity * period / TAU));
    if let Some(stop) = target.stop
        && (before <= stop) == (target.position >= stop)
    {
        (target.position, target.velocity, target.moves) = (stop, 0.0, false);
    }
}

/// `wanted`, but at most `step` away from `before`.
fn limit_change(before: f32, wanted: f32, step: f32) -> f32 {
    // Without a number to go to, the speed stays.
    let change = wanted - before;
    if step.is_finite() {
        before + limit(change, step)
    } else if wanted.is_finite() {
        wanted
    } else {
        before
    }
}

#[cfg(test)]
mod tests {
    use super::super::target::ProfileLimits;
    use super::*;

    fn limits(velocity: f32, acceleration: f32) -> ProfileLimits {
        ProfileLimits { velocity, acceleration }
    }

    /// Runs a profile of 1 ms periods until it is done: time, largest speed, largest change of the speed in a period.
    fn run(target: Target, periods: usize) -> (usize, f32, f32, Turns) {
        let mut profile = Profile::default();
        profile.restart(Turns::ZERO, 0.0);
        let (mut fastest, mut steepest) = (0.0_f32, 0.0_f32);
        for period in 0..periods {
            let before = profile.velocity();
            profile.approach(&target, 1e-3);
            fastest = fastest.max(profile.velocity().abs());
            steepest = steepest.max((profile.velocity() - before).abs());
            if profile.is_done() {
                return (period, fastest, steepest, profile.position());
            }
        }
        (periods, fastest, steepest, profile.position())
    }

    #[test]
    fn trapezoid_keeps_both_limits_and_ends_in_time() {
        let target = Target { limits: limits(2.0, 10.0), ..Target::hold(Turns::from_rad(4.0)) };
        let (periods, fastest, steepest, end) = run(target, 10_000);
        // 4 rad at 2 rad/s and a ramp of 0.2 s: 2.2 s.
        assert!((2190..=2215).contains(&periods), "{periods}");
        assert!(fastest <= 2.0 && steepest <= 0.0101, "{fastest} {steepest}");
        assert_eq!(end, target.position);
    }

    #[test]
    fn triangle_below_the_largest_speed() {
        let target = Target { limits: limits(100.0, 10.0), ..Target::hold(Turns::from_rad(-0.4)) };
        let (periods, fastest, _, end) = run(target, 10_000);
        // 2 sqrt(d / a) = 0.4 s.
        assert!((395..=410).contains(&periods), "{periods}");
        assert!((fastest - 2.0).abs() < 0.03, "{fastest}");
        assert_eq!(end, target.position);
    }

    #[test]
    fn speed_limit_alone_needs_no_ramp() {
        let target = Target { limits: limits(1.0, f32::INFINITY), ..Target::hold(Turns::from_rad(0.5)) };
        let (periods, fastest, _, end) = run(target, 10_000);
        assert!((495..=505).contains(&periods), "{periods}");
        assert_eq!((fastest, end), (1.0, target.position));
    }

    #[test]
    fn moving_target_is_met_without_overshoot() {
        for limits in [limits(5.0, 10.0), limits(5.0, f32::INFINITY)] {
            let mut target = Target { velocity: 2.0, moves: true, limits, ..Target::hold(Turns::from_rad(1.0)) };
            let mut profile = Profile::default();
            profile.restart(Turns::ZERO, 0.0);
            for period in 0..3000 {
                advance_target(&mut target, 1e-3);
                profile.approach(&target, 1e-3);
                let away = target.position.minus(profile.position()).to_rad();
                assert!(away > -1e-3, "{period}: {away}");
                if period > 2000 {
                    assert!(profile.is_done() && away.abs() < 1e-5, "{period}: {away}");
                    assert!((profile.velocity() - 2.0).abs() < 0.02, "{period}: {}", profile.velocity());
                }
            }
        }
    }

    #[test]
    fn moving_target_stops_at_its_stop() {
        let mut target =
            Target { velocity: TAU, moves: true, stop: Some(Turns::new(0.01)), ..Target::hold(Turns::ZERO) };
        for _ in 0..9 {
            advance_target(&mut target, 1e-3);
        }
        assert!(target.moves);
        for _ in 0..3 {
            advance_target(&mut target, 1e-3);
        }
        assert_eq!((target.moves, target.position), (false, Turns::new(0.01)));
    }
}

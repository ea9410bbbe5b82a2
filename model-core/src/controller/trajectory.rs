//! Trajectories in time segments: a polynomial of fifth degree per motion, evaluated every control period, so that a
//! slow link can carry any smooth motion.

use crate::compensation::{Command, ImpedancePoint, Motion, Position};
use crate::numbers::Real;

/// Coefficients of a segment.
pub const POWERS: usize = 6;

/// Motion over a time segment.
///
/// ```
/// use model_core::controller::trajectory::Segment;
///
/// // From 2.25 turns on at half a turn a second, for a quarter of a second.
/// let segment = Segment { turns: 2, powers: [0.25, 0.5, 0.0, 0.0, 0.0, 0.0] };
/// let motion = segment.at(0.25, core::f32::consts::TAU);
/// assert_eq!((motion.position.turns, motion.position.fraction), (2, 0.375));
/// assert_eq!((motion.speed, motion.acceleration), (core::f32::consts::PI, 0.0));
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Segment<T: Real> {
    /// Whole turns, on the scale of the observer's link shaft.
    pub turns: i32,
    /// Remaining angle as coefficients of the powers of the time since the segment began [turns, turns/s, turns/s^2,
    /// ...].
    pub powers: [T; POWERS],
}

impl<T: Real> Segment<T> {
    /// Motion at the time `elapsed` after the segment began [s]; `turn` is a whole turn [rad].
    pub fn at(&self, elapsed: T, turn: T) -> Motion<T> {
        // Horner's scheme for value, derivative and half the second derivative at once.
        let (mut value, mut rate, mut half) = (T::ZERO, T::ZERO, T::ZERO);
        for power in self.powers.iter().rev() {
            half = half * elapsed + rate;
            rate = rate * elapsed + value;
            value = value * elapsed + *power;
        }
        Motion {
            position: Position { turns: self.turns, fraction: value },
            speed: turn * rate,
            acceleration: T::TWO * turn * half,
        }
    }
}

/// Set-points over a time segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trajectory<T: Real> {
    /// Follows a motion.
    Position {
        /// Motion at the present time.
        now: Segment<T>,
        /// Motion ahead by the compensation's lead, if known.
        ahead: Option<Segment<T>>,
    },
    /// Acts as a spring and damper.
    Impedance(ImpedancePoint<T>),
}

impl<T: Real> Trajectory<T> {
    /// Holds angle zero of the observer's link shaft.
    pub const HOLD: Self = Self::Position { now: Segment { turns: 0, powers: [T::ZERO; POWERS] }, ahead: None };

    /// Set-point at the time `elapsed` after the segment began [s].
    pub fn at(&self, elapsed: T, turn: T) -> Command<T> {
        match self {
            Self::Position { now, ahead } => Command::Position {
                now: now.at(elapsed, turn),
                ahead: ahead.as_ref().map(|ahead| ahead.at(elapsed, turn)),
            },
            Self::Impedance(point) => Command::Impedance(*point),
        }
    }
}

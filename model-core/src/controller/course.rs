//! Set-points over a stretch of time: a polynomial of fifth degree for each motion, evaluated every control period, so
//! that a slow line can carry any smooth motion.

use crate::compensation::{Command, ImpedancePoint, Motion, Position};
use crate::numbers::Real;

/// Coefficients of a stretch.
pub const POWERS: usize = 6;

/// A motion from a moment on.
///
/// ```
/// use model_core::controller::course::Stretch;
///
/// // From 2.25 turns on at half a turn a second, for a quarter of a second.
/// let stretch = Stretch { turns: 2, powers: [0.25, 0.5, 0.0, 0.0, 0.0, 0.0] };
/// let motion = stretch.at(0.25, core::f32::consts::TAU);
/// assert_eq!((motion.position.turns, motion.position.fraction), (2, 0.375));
/// assert_eq!((motion.speed, motion.acceleration), (core::f32::consts::PI, 0.0));
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stretch<T: Real> {
    /// Whole turns, on the scale of the observer's link shaft.
    pub turns: i32,
    /// The rest: by powers of the time since that moment [turns, turns/s, turns/s^2, ...].
    pub powers: [T; POWERS],
}

impl<T: Real> Stretch<T> {
    /// The motion so long after its moment [s]; `turn` is a whole turn [rad].
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

/// What is asked for over a stretch of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Demand<T: Real> {
    /// Follow a motion.
    Position {
        /// The motion.
        now: Stretch<T>,
        /// The same motion ahead by the compensation's lead, if it is known.
        ahead: Option<Stretch<T>>,
    },
    /// Be a spring and damper.
    Impedance(ImpedancePoint<T>),
}

impl<T: Real> Demand<T> {
    /// Hold angle zero of the observer's link shaft.
    pub const HOLD: Self = Self::Position { now: Stretch { turns: 0, powers: [T::ZERO; POWERS] }, ahead: None };

    /// The set-point so long after the demand began [s].
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

//! Disturbance torques on the link; positive torques brake, as the load torque of the joint does.

use std::f64::consts::TAU;

/// Disturbance torque; several disturbances add up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Disturbance {
    /// Step: on from a time on.
    Step {
        /// [s].
        start: f64,
        /// [N m].
        torque: f64,
    },
    /// Pulse of limited duration.
    Pulse {
        /// [s].
        start: f64,
        /// [s].
        duration: f64,
        /// [N m].
        torque: f64,
    },
    /// Ramp: rises linearly to its torque, which then stays.
    Ramp {
        /// [s].
        start: f64,
        /// [s].
        duration: f64,
        /// [N m].
        torque: f64,
    },
    /// Sine: amplitude times sin(2 pi frequency t).
    Sine {
        /// [N m].
        amplitude: f64,
        /// [Hz].
        frequency: f64,
    },
}

impl Disturbance {
    /// Returns the torque at a time [N m].
    pub fn torque(&self, time: f64) -> f64 {
        match *self {
            Self::Step { start, torque } => {
                if time >= start {
                    torque
                } else {
                    0.0
                }
            }
            Self::Pulse { start, duration, torque } => {
                if (start..start + duration).contains(&time) {
                    torque
                } else {
                    0.0
                }
            }
            Self::Ramp { start, duration, torque } => torque * ((time - start) / duration).clamp(0.0, 1.0),
            Self::Sine { amplitude, frequency } => amplitude * (TAU * frequency * time).sin(),
        }
    }
}

//! Set-points of a drive. All quantities are those of the output.

use crate::turns::Turns;

/// Limits of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileLimits {
    /// Largest speed [rad/s].
    pub velocity: f32,
    /// Largest acceleration [rad/s^2].
    pub acceleration: f32,
}

impl ProfileLimits {
    /// No limits.
    pub const NONE: Self = Self { velocity: f32::INFINITY, acceleration: f32::INFINITY };

    /// True without any limit.
    pub(super) fn is_none(&self) -> bool {
        self.velocity.is_infinite() && self.acceleration.is_infinite()
    }
}

/// Target of the position loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Angle.
    pub position: Turns,
    /// Speed [rad/s]: feed-forward, or the speed at which a moving target advances.
    pub velocity: f32,
    /// Feed-forward torque [N m].
    pub torque: f32,
    /// True if the angle advances with the speed from period to period.
    pub moves: bool,
    /// Angle at which a moving target stops.
    pub stop: Option<Turns>,
    /// Limits of the profile that leads to the target.
    pub limits: ProfileLimits,
    /// Factor on the gain of the angle [-].
    pub stiffness_scale: f32,
    /// Factor on the gain of the speed [-].
    pub damping_scale: f32,
    /// Factor on the limit of the integral [-].
    pub integral_scale: f32,
    /// Largest torque [N m].
    pub max_torque: f32,
}

impl Target {
    /// Target at rest, without a profile.
    pub fn hold(position: Turns) -> Self {
        Self {
            position,
            velocity: 0.0,
            torque: 0.0,
            moves: false,
            stop: None,
            limits: ProfileLimits::NONE,
            stiffness_scale: 1.0,
            damping_scale: 1.0,
            integral_scale: 1.0,
            max_torque: f32::INFINITY,
        }
    }
}

/// Set-point of an enabled drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SetPoint {
    /// Phases shorted: the winding brakes the rotor.
    Brake,
    /// Torque at the output [N m], with the largest speed [rad/s].
    Torque {
        /// Torque [N m].
        torque: f32,
        /// Speed above which the torque decays [rad/s].
        max_velocity: f32,
    },
    /// Speed at the output.
    Velocity {
        /// Speed [rad/s].
        velocity: f32,
        /// Feed-forward torque [N m].
        torque: f32,
        /// Largest acceleration [rad/s^2].
        max_acceleration: f32,
        /// Largest torque [N m].
        max_torque: f32,
    },
    /// Angle of the output by the drive's own gains.
    Position(Target),
    /// Torque = stiffness (position - angle) + damping (velocity - speed) + torque.
    Impedance {
        /// Angle at rest.
        position: Turns,
        /// Speed at rest [rad/s].
        velocity: f32,
        /// Stiffness [N m/rad].
        stiffness: f32,
        /// Damping [N m s/rad].
        damping: f32,
        /// Torque [N m].
        torque: f32,
    },
    /// Angle within two bounds: no torque inside, the position loop at a bound.
    Within {
        /// Lower bound; `None` without one.
        low: Option<Turns>,
        /// Upper bound; `None` without one.
        high: Option<Turns>,
        /// Gains, feed-forward torque and torque limit; the angle is not read.
        target: Target,
    },
}

impl SetPoint {
    /// Largest torque that the set-point permits [N m].
    pub fn max_torque(&self) -> f32 {
        let stated = match self {
            Self::Velocity { max_torque, .. } => *max_torque,
            Self::Position(target) | Self::Within { target, .. } => target.max_torque,
            _ => f32::INFINITY,
        };
        // A limit that is no number or negative permits nothing.
        stated.max(0.0)
    }
}

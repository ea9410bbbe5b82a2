//! Dry and viscous friction of one shaft over a short part of time, sticking included. Where the torque acts is left to
//! the drive train.

use super::parameters::FrictionParameters;

/// A shaft over one part of time, as friction sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shaft {
    /// [rad/s].
    pub speed: f64,
    /// All torques but friction [N m].
    pub driving_torque: f64,
    /// [kg m^2].
    pub inertia: f64,
    /// Length of the part [s].
    pub part: f64,
}

impl FrictionParameters {
    /// Torque against the motion [N m]. `extra` is dry friction on top, from the load on the teeth.
    ///
    /// Dry friction is at most what would stop the shaft within the part: it sticks instead of chattering about zero,
    /// and it never turns a shaft round.
    pub(super) fn torque(&self, shaft: Shaft, extra: f64) -> f64 {
        let rise = if self.stribeck_speed > 0.0 {
            self.stribeck_rise_ratio * (-shaft.speed.abs() / self.stribeck_speed).exp()
        } else {
            0.0
        };
        let dry = self.coulomb * (1.0 + rise) + extra;
        let viscous = self.viscous * shaft.speed;
        let to_stop = shaft.inertia * shaft.speed / shaft.part + shaft.driving_torque - viscous;
        viscous + to_stop.clamp(-dry, dry)
    }
}

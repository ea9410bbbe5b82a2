//! Dry and viscous friction of one shaft over a short part of time, sticking included.

use parameters::Friction;

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

impl Shaft {
    /// Torque against the motion [N m]. `extra` is dry friction on top, from the load on the teeth.
    ///
    /// Dry friction is at most what would stop the shaft within the part: it sticks instead of chattering about zero,
    /// and it never turns a shaft round.
    pub fn friction(&self, friction: &Friction, extra: f64) -> f64 {
        let dry = dry_friction(friction, self.speed) + extra;
        let viscous = friction.viscous * self.speed;
        let to_stop = self.inertia * self.speed / self.part + self.driving_torque - viscous;
        viscous + to_stop.clamp(-dry, dry)
    }
}

/// Dry friction at a speed, with its Stribeck rise [N m].
pub(super) fn dry_friction(friction: &Friction, speed: f64) -> f64 {
    let rise = if friction.stribeck_speed > 0.0 {
        friction.stribeck_rise_ratio * (-speed.abs() / friction.stribeck_speed).exp()
    } else {
        0.0
    };
    friction.coulomb * (1.0 + rise)
}

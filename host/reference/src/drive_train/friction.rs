//! Dry and viscous friction of one shaft over a short part of a period, with sticking.
//!
//! Equations: (R4) in docs/theory/real-joints.md.

use parameters::Friction;

/// Shaft during one part of a period.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shaft {
    /// Speed [rad/s].
    pub speed: f64,
    /// Sum of all torques without friction [N m].
    pub driving_torque: f64,
    /// Inertia [kg m^2].
    pub inertia: f64,
    /// Length of the part [s].
    pub part: f64,
}

impl Shaft {
    /// Returns the torque against the motion [N m]. `extra` is additional dry friction from the load on the teeth.
    ///
    /// Dry friction is limited to the torque that stops the shaft within the part: the shaft sticks instead of
    /// chattering about zero, and friction never reverses it.
    pub fn friction(&self, friction: &Friction, extra: f64) -> f64 {
        let dry = dry_friction(friction, self.speed) + extra;
        let viscous = friction.viscous * self.speed;
        let to_stop = self.inertia * self.speed / self.part + self.driving_torque - viscous;
        viscous + to_stop.clamp(-dry, dry)
    }
}

/// Dry friction at a speed, including the Stribeck rise [N m].
pub(super) fn dry_friction(friction: &Friction, speed: f64) -> f64 {
    let rise = if friction.stribeck_speed > 0.0 {
        friction.stribeck_rise_ratio * (-speed.abs() / friction.stribeck_speed).exp()
    } else {
        0.0
    };
    friction.coulomb * (1.0 + rise)
}

//! Form and gains of the control laws.

/// Form of the position loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// Angle, speed and integral in parallel.
    Parallel,
    /// Proportional angle loop over a proportional-integral speed loop.
    Cascade,
}

/// Gains at the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// Stiffness of the parallel law [N m/rad].
    pub stiffness: f32,
    /// Damping of the parallel law, and of a drive that timed out [N m s/rad].
    pub damping: f32,
    /// Integral gain of the parallel law [N m/(rad s)].
    pub integral: f32,
    /// Gain of the cascade's angle loop [1/s].
    pub position: f32,
    /// Gain of the speed loop [N m s/rad].
    pub velocity: f32,
    /// Integral gain of the speed loop [N m/rad].
    pub velocity_integral: f32,
}

impl Gains {
    /// Gains for an inertia at the output [kg m^2] and a bandwidth [rad/s]. Parallel law: critically damped, stiffness
    /// J w^2. Cascade: speed loop at the bandwidth, J w, its integral and the angle loop at a quarter of it.
    pub fn for_inertia(inertia: f32, bandwidth: f32) -> Self {
        let (damping, corner) = (inertia * bandwidth, 0.25 * bandwidth);
        Self {
            stiffness: damping * bandwidth,
            damping: 2.0 * damping,
            integral: 0.0,
            position: corner,
            velocity: damping,
            velocity_integral: damping * corner,
        }
    }
}

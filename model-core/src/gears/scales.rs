//! Units that make the equations dimensionless: length b_c, frequency omega_n (eq. 18) and the mean force K_m b_c.
//! The units of torques, masses and angles follow from these three.
//!
//! Equations: (P10) in docs/theory/paper.md.

use parameters::{JointParameters, MeshKind};

use crate::gears::mechanics::Mechanics;

/// SI value of one dimensionless unit of each quantity.
///
/// ```
/// use model_core::gears::Scales;
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap().parameters;
/// let scales = Scales::new(&q1);
/// // A sun of 0.02 kg against a planet of 0.03 kg on teeth of 1e8 N/m: they ring at 14.5 kHz.
/// assert!((scales.frequency / core::f64::consts::TAU - 14.5e3).abs() < 50.0);
/// // A deflection by b_c = 10 um presses with 1 kN.
/// assert!((scales.force() - 1e3).abs() < 1e-9);
/// // sqrt(K_m M) is the impedance of a mass on that spring; the dimensionless numbers keep that.
/// let mass = q1.bodies.sun_equivalent_mass;
/// assert!((scales.acceleration() * scales.mobility(mass) * mass - scales.force()).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Length b_c [m].
    pub length: f64,
    /// Frequency omega_n = sqrt(K_m (1/M_s + 1/M_p)), without rotor and link; for an equivalent gear the natural frequency
    /// of motor side against link in contact [rad/s]. Dimensionless time is omega_n t.
    pub frequency: f64,
    /// Stiffness K_m: mean stiffness of the sun-planet mesh [N/m].
    pub stiffness: f64,
}

impl Scales {
    /// Computes the scales of a joint.
    pub fn new(parameters: &JointParameters) -> Self {
        let stiffness = parameters.mesh(MeshKind::SunPlanet).mean_stiffness;
        let length = parameters.characteristic_length;
        if let Some(gear) = parameters.equivalent_gear() {
            return Self { length, frequency: libm::sqrt(gear.stiffness / parameters.inertia_in_series()), stiffness };
        }
        let bodies = &parameters.bodies;
        let inverse_mass = 1.0 / bodies.sun_equivalent_mass + 1.0 / bodies.planet_equivalent_mass;
        Self { length, frequency: libm::sqrt(stiffness * inverse_mass), stiffness }
    }

    /// Returns the unit of force, K_m b_c [N].
    pub fn force(&self) -> f64 {
        self.stiffness * self.length
    }

    /// Returns the unit of acceleration, b_c omega_n^2 [m/s^2].
    pub fn acceleration(&self) -> f64 {
        self.length * self.frequency * self.frequency
    }

    /// Returns the dimensionless acceleration of a mass under a unit force: K_m / (M omega_n^2) [-].
    pub fn mobility(&self, mass: f64) -> f64 {
        self.stiffness / (mass * self.frequency * self.frequency)
    }

    /// Returns the dimensionless damping C omega_n / K_m [-].
    pub fn damping(&self, coefficient: f64) -> f64 {
        coefficient * self.frequency / self.stiffness
    }
}

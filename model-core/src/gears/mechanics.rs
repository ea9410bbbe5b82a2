//! Inertia, damping and balance along the lines of action: equivalent masses, damping coefficients of the meshes, and the
//! load torque that balances a drive torque.
//!
//! Equations: (P5), (P10) in docs/theory/paper.md.

use parameters::{JointParameters, MeshKind};

use crate::gears::kinematics::Kinematics;

/// Equivalent masses, damping and balance of a joint.
pub trait Mechanics {
    /// Carrier equivalent mass M_c = (I_c/r_c^2 + n m_p) / cos^2(alpha), without the link (below eq. 19) [kg].
    fn carrier_equivalent_mass(&self) -> f64;

    /// Rotor inertia referred to the sun's line of action, J / r_bs^2 [kg].
    fn rotor_equivalent_mass(&self) -> f64;

    /// Link inertia referred to the carrier's line of action, J / (r_c cos(alpha))^2 [kg].
    fn link_equivalent_mass(&self) -> f64;

    /// Damping coefficient of one mesh (eq. 9 for sun-planet, eq. 10 for ring-planet), from the gears' own masses
    /// without rotor and link [N s/m].
    fn damping_coefficient(&self, kind: MeshKind) -> f64;

    /// Reduced inertia J_1 J_2 / (J_1 + J_2) of motor side (referred to the link) and link, which oscillates on the stiffness
    /// of an equivalent gear [kg m^2].
    fn inertia_in_series(&self) -> f64;

    /// Load torque at which the rigid body does not accelerate under `drive_torque` [N m].
    fn balanced_load_torque(&self, drive_torque: f64) -> f64;
}

impl Mechanics for JointParameters {
    fn carrier_equivalent_mass(&self) -> f64 {
        let cosine = libm::cos(self.geometry.working_pressure_angle);
        let planets = self.geometry.planets as f64;
        (self.bodies.carrier_inertia_over_radius_squared + planets * self.bodies.planet_mass) / (cosine * cosine)
    }

    fn rotor_equivalent_mass(&self) -> f64 {
        self.rotor_inertia / (self.geometry.sun_base_radius * self.geometry.sun_base_radius)
    }

    fn link_equivalent_mass(&self) -> f64 {
        let lever = self.geometry.carrier_base_radius();
        self.link_inertia / (lever * lever)
    }

    fn damping_coefficient(&self, kind: MeshKind) -> f64 {
        let mesh = self.mesh(kind);
        let planet = self.bodies.planet_equivalent_mass;
        if let Some(gear) = self.equivalent_gear() {
            // Both meshes in series are one spring of half their stiffness, on which motor side and link oscillate.
            let lever = self.geometry.carrier_base_radius();
            let coefficient = 2.0 * gear.damping_ratio * libm::sqrt(gear.stiffness * self.inertia_in_series());
            return coefficient / (2.0 * lever * lever);
        }
        let mass = match kind {
            MeshKind::SunPlanet => {
                let sun = self.bodies.sun_equivalent_mass;
                sun * planet / (sun + planet)
            }
            // Eq. 10 is eq. 9 with an infinitely heavy ring.
            MeshKind::RingPlanet => planet,
        };
        2.0 * mesh.damping_ratio * libm::sqrt(mesh.mean_stiffness * mass)
    }

    fn inertia_in_series(&self) -> f64 {
        let lever = self.geometry.carrier_base_radius();
        // The sun travels twice as far as the carrier on the line of action.
        let motor = 4.0 * (self.bodies.sun_equivalent_mass + self.rotor_equivalent_mass()) * lever * lever;
        motor * self.link_inertia / (motor + self.link_inertia)
    }

    fn balanced_load_torque(&self, drive_torque: f64) -> f64 {
        drive_torque * self.geometry.ratio_by_radii()
    }
}

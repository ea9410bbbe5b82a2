//! Inertias, stiffness and backlash of a joint, referred to the link, and Z of (K8).

use crate::gears::{Kinematics, Mechanics};
use parameters::{JointParameters, MeshKind};

/// Joint, referred to the link.
pub(super) struct JointBody {
    pub gear: f64,
    pub lever: f64,
    pub half_backlash: f64,
    /// Inertia that turns with the motor in the open gap, J_m [kg m^2].
    pub motor: f64,
    /// Remaining inertia, J_l [kg m^2].
    pub load: f64,
    /// Stiffness between motor and link [N m/rad].
    pub stiffness: f64,
    /// Torque of a blow on loose planets per speed, Z [N m s/rad].
    pub strike_impedance: f64,
}

impl JointBody {
    pub fn new(joint: &JointParameters) -> Self {
        let geometry = &joint.geometry;
        let (gear, lever) = (geometry.ratio_by_teeth(), geometry.carrier_base_radius());
        let planets = geometry.planets as f64;
        let sun = joint.bodies.sun_equivalent_mass * geometry.sun_base_radius * geometry.sun_base_radius;
        let stiffness = joint.mesh(MeshKind::SunPlanet).mean_stiffness;
        // Both meshes in series, all planets in parallel, along twice the travel of the carrier.
        let teeth = 4.0 * lever * lever * planets * 0.5 * stiffness;
        let twist = 1.0 / teeth + joint.compliance.map_or(0.0, |compliance| 1.0 / compliance.stiffness);
        let planet = joint.bodies.planet_equivalent_mass;
        // Motor and sun strike loose planets: two bodies, with the meshes of the sun in parallel between them.
        let striking = joint.bodies.sun_equivalent_mass + joint.rotor_inertia / geometry.sun_base_radius.powi(2);
        let struck = planets * planet;
        let reduced = striking * struck / (striking + struck);
        // An equivalent gear has no loose planets: the motor strikes the link.
        let strike_impedance = match joint.equivalent_gear() {
            Some(gear) => libm::sqrt(gear.stiffness * joint.inertia_in_series()),
            // The force of a blow is speed times sqrt(stiffness mass).
            None => libm::sqrt(planets * stiffness * reduced) * 4.0 * lever * lever,
        };
        Self {
            gear,
            lever,
            half_backlash: joint.sun_planet.half_backlash.iter().sum::<f64>() / planets,
            motor: gear * gear * (joint.rotor_inertia + sun),
            load: (planets * planet + joint.carrier_equivalent_mass()) * lever * lever + joint.link_inertia,
            stiffness: 1.0 / twist,
            strike_impedance,
        }
    }
}

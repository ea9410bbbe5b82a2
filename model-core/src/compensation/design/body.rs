//! Inertias, stiffness and backlash of a joint as the compensation feels them at the link.

use crate::gears::{Kinematics, Mechanics};
use parameters::{JointParameters, MeshKind};

/// The joint, referred to the link.
pub(super) struct Body {
    pub gear: f64,
    pub lever: f64,
    pub half_backlash: f64,
    /// What turns with the motor while the gap is open [kg m^2].
    pub motor: f64,
    /// The rest [kg m^2].
    pub load: f64,
    /// Between motor and link [N m/rad].
    pub stiffness: f64,
    /// Torque for each rad/s at which hanging planets are struck [N m s/rad].
    pub strike_impedance: f64,
}

impl Body {
    pub fn new(joint: &JointParameters) -> Self {
        let geometry = &joint.geometry;
        let (gear, lever) = (geometry.ratio_by_teeth(), geometry.carrier_base_radius());
        let planets = geometry.planets as f64;
        let sun = joint.bodies.sun_equivalent_mass * geometry.sun_base_radius * geometry.sun_base_radius;
        let stiffness = joint.mesh(MeshKind::SunPlanet).mean_stiffness;
        // Both meshes in series, all planets in parallel, along twice the carrier's way.
        let teeth = 4.0 * lever * lever * planets * 0.5 * stiffness;
        let twist = 1.0 / teeth + joint.compliance.map_or(0.0, |compliance| 1.0 / compliance.stiffness);
        let planet = joint.bodies.planet_equivalent_mass;
        // Motor and sun strike planets that hang loose: two bodies, with the sun's meshes in parallel between them.
        let striking = joint.bodies.sun_equivalent_mass + joint.rotor_inertia / geometry.sun_base_radius.powi(2);
        let struck = planets * planet;
        let reduced = striking * struck / (striking + struck);
        // An equivalent gear has nothing that hangs loose: what is struck is the link.
        let strike_impedance = match joint.equivalent_gear() {
            Some(gear) => libm::sqrt(gear.stiffness * joint.inertia_in_series()),
            // Bodies that meet at a speed press with that speed times sqrt(stiffness mass).
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

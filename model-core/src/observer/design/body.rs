//! Parameters of a joint, referred to the line of action.

use crate::gears::{Kinematics, Mechanics};
use parameters::{JointParameters, MeshKind};

/// Parameters of the joint, referred to the line of action.
pub(crate) struct Body {
    pub sun_lever: f64,
    /// Ratio by teeth times the sun's base radius.
    pub output_lever: f64,
    pub ratio: f64,
    pub motor_inertia: f64,
    pub load_inertia: f64,
    pub half_backlash: f64,
    /// Compliance from sun to link: meshes and wind-up.
    pub compliance: f64,
    pub mesh_compliance: f64,
    /// Largest amplitude of the transmission error from sun to carrier.
    pub transmission_error: f64,
}

impl Body {
    pub fn new(joint: &JointParameters) -> Self {
        let geometry = &joint.geometry;
        let planets = geometry.planets as f64;
        let sun_lever = geometry.sun_base_radius;
        let ratio = geometry.ratio_by_teeth();
        let output_lever = ratio * sun_lever;
        let carrier_lever = geometry.carrier_base_radius();
        let [sun_planet, ring_planet] = [MeshKind::SunPlanet, MeshKind::RingPlanet].map(|kind| joint.mesh(kind));
        let mesh_compliance = (1.0 / sun_planet.mean_stiffness + 1.0 / ring_planet.mean_stiffness) / planets;
        let wind_up = joint.compliance.map_or(0.0, |compliance| output_lever * output_lever / compliance.stiffness);
        let smallest = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, |most: f64, value| most.max(value.abs()));
        Self {
            sun_lever,
            output_lever,
            ratio,
            motor_inertia: joint.rotor_inertia + joint.bodies.sun_equivalent_mass * sun_lever * sun_lever,
            load_inertia: joint.link_inertia
                + (joint.carrier_equivalent_mass() + planets * joint.bodies.planet_equivalent_mass)
                    * carrier_lever
                    * carrier_lever,
            // The planet with the least backlash carries the force.
            half_backlash: 0.5 * (smallest(&sun_planet.half_backlash) + smallest(&ring_planet.half_backlash)),
            compliance: mesh_compliance + wind_up,
            mesh_compliance,
            transmission_error: largest(&sun_planet.transmission_error) + largest(&ring_planet.transmission_error),
        }
    }

    /// Lost motion at the motor [rad].
    pub fn gap_at_motor(&self) -> f64 {
        4.0 * self.half_backlash / self.sun_lever
    }

    /// Frequency of both inertias against the compliance [rad/s].
    pub fn contact_frequency(&self) -> f64 {
        let motor = self.motor_inertia / (self.sun_lever * self.sun_lever);
        let load = self.load_inertia / (self.output_lever * self.output_lever);
        libm::sqrt((1.0 / motor + 1.0 / load) / self.compliance)
    }
}

//! Conversion between data sheets and parameters: lost motion and backlash, stiffness at the output and of the teeth.
//! `joint check` shows the values by the formulae of the reader.

use std::f64::consts::PI;

use model_core::gears::Kinematics;
use parameters::{Bodies, Geometry, JointParameters, PerPlanet};

/// One minute of arc [rad].
pub const ARCMIN: f64 = PI / (180.0 * 60.0);

/// Free range of u_s - 2 u_c of the tightest planet: twice the sum of its half-backlashes [m].
pub fn gap(joint: &JointParameters) -> f64 {
    let of_planet = |sun: &PerPlanet, ring: &PerPlanet| {
        2.0 * sun.iter().zip(ring).map(|(sun, ring)| sun + ring).fold(f64::INFINITY, f64::min)
    };
    of_planet(&joint.sun_planet.half_backlash, &joint.ring_planet.half_backlash)
}

/// Free motion of the link with the sun held: the gap over twice the carrier's lever [rad].
pub fn lost_motion(joint: &JointParameters) -> f64 {
    gap(joint) / (2.0 * joint.geometry.carrier_base_radius())
}

/// Half-backlash b of all meshes for a lost motion at the output: b = lost motion x r_c cos(alpha) / 2 [m].
pub fn half_backlash(lost_motion: f64, geometry: &Geometry) -> f64 {
    0.5 * lost_motion * geometry.carrier_base_radius()
}

/// Force of one mesh per N m at the link: each planet hands 2 F to the carrier [1/m].
pub fn force_per_torque(geometry: &Geometry) -> f64 {
    1.0 / (2.0 * geometry.planets as f64 * geometry.carrier_base_radius())
}

/// Compliance of the teeth at the link for their mean stiffnesses [rad/(N m)]: (1/K_sp + 1/K_rp) / (4 n (r_c
/// cos(alpha))^2).
pub fn teeth_compliance(geometry: &Geometry, mean_stiffness: [f64; 2]) -> f64 {
    let give: f64 = mean_stiffness.iter().map(|stiffness| force_per_torque(geometry) / stiffness).sum();
    give / (2.0 * geometry.carrier_base_radius())
}

/// Stiffness of the shafts from the stiffness at the output and the compliance of the teeth: 1 / (1/K - c) [N m/rad];
/// `None` if the teeth alone are softer.
pub fn shaft_stiffness(total: f64, teeth_compliance: f64) -> Option<f64> {
    let left = 1.0 / total - teeth_compliance;
    (left > 0.0).then(|| 1.0 / left)
}

/// Masses of gears and carrier for an inertia at the input, J = r_bs^2 (M_s + (n M_p + M_c) / 4), as solid discs of one
/// thickness and material: sun and planets with their pitch radii, the carrier with r_c. With the mass per area sigma,
/// I = pi sigma r^4 / 2 for each and m_p = pi sigma r_p^2, so that J is proportional to sigma.
pub fn bodies(inertia_at_input: f64, geometry: &Geometry) -> Bodies {
    let of = |sigma: f64| discs(geometry, [sigma; 3]);
    let sigma = inertia_at_input / self::inertia_at_input(&of(1.0), geometry);
    of(sigma)
}

/// Masses of sun, planets and carrier as solid discs, each with its own mass per area [kg/m^2].
pub fn discs(geometry: &Geometry, sigma: [f64; 3]) -> Bodies {
    let cosine = geometry.working_pressure_angle.cos();
    let disc = |sigma: f64, radius: f64| 0.5 * PI * sigma * radius.powi(4);
    let [sun, planet] = [geometry.sun_base_radius, geometry.planet_base_radius];
    Bodies {
        sun_equivalent_mass: disc(sigma[0], sun / cosine) / (sun * sun),
        planet_equivalent_mass: disc(sigma[1], planet / cosine) / (planet * planet),
        planet_mass: PI * sigma[1] * (planet / cosine).powi(2),
        carrier_inertia_over_radius_squared: disc(sigma[2], geometry.carrier_radius) / geometry.carrier_radius.powi(2),
    }
}

/// Inertia of sun, planets and carrier at the input, without the rotor [kg m^2].
pub fn inertia_at_input(bodies: &Bodies, geometry: &Geometry) -> f64 {
    let planets = geometry.planets as f64;
    let cosine = geometry.working_pressure_angle.cos();
    let carrier = (bodies.carrier_inertia_over_radius_squared + planets * bodies.planet_mass) / (cosine * cosine);
    let behind = planets * bodies.planet_equivalent_mass + carrier;
    geometry.sun_base_radius.powi(2) * (bodies.sun_equivalent_mass + 0.25 * behind)
}

/// Inertia of the whole joint at its link: i^2 (J + J_rotor) + J_link, with J of the gears at the input [kg m^2].
pub fn inertia_at_link(joint: &JointParameters) -> f64 {
    let at_input = inertia_at_input(&joint.bodies, &joint.geometry) + joint.rotor_inertia;
    at_input * joint.geometry.ratio_by_teeth().powi(2) + joint.link_inertia
}

/// Dry friction of the motor's side from a no-load torque at the input, T_0 = T_m + T_l / (i eta), with the load's dry
/// friction in motion T_l [N m]; `None` if the load's part exceeds it.
pub fn motor_friction(no_load: f64, load_friction: f64, ratio: f64, efficiency: f64) -> Option<f64> {
    let left = no_load - load_friction / (ratio * efficiency);
    (left >= 0.0).then_some(left)
}

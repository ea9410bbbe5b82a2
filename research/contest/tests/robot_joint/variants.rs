//! Case R's joint and others like it. No bound is stated here.

use parameters::{JointParameters, Mesh};
use reference::scenarios::{case_r, same};

/// Case R's own joint.
pub fn joint() -> JointParameters {
    case_r::case_r().joint
}

/// With both kinds of mesh changed.
pub fn with_meshes(change: impl Fn(&mut Mesh)) -> JointParameters {
    let mut joint = joint();
    change(&mut joint.sun_planet);
    change(&mut joint.ring_planet);
    joint
}

/// With other teeth of the same module, and so many planets.
pub fn with_teeth(planets: usize, sun: u32, planet: u32, ring: u32) -> JointParameters {
    let mut joint = with_meshes(|mesh| {
        mesh.half_backlash = same(planets, mesh.half_backlash[0]);
        mesh.transmission_error = same(planets, mesh.transmission_error[0]);
    });
    let geometry = &mut joint.geometry;
    let per_tooth = geometry.sun_base_radius / f64::from(geometry.sun_teeth);
    (geometry.planets, geometry.sun_teeth, geometry.planet_teeth, geometry.ring_teeth) = (planets, sun, planet, ring);
    geometry.sun_base_radius = per_tooth * f64::from(sun);
    geometry.planet_base_radius = per_tooth * f64::from(planet);
    geometry.carrier_radius = per_tooth * f64::from(sun + planet) / geometry.working_pressure_angle.cos();
    joint
}

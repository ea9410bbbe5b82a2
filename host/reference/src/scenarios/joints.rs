//! Joints of the scenarios, built in code, independent of joint files and their mistakes.

use parameters::{
    Bodies, Coherence, Compliance, DampingLaw, DeadZone, Excitation, Geometry, JointParameters, Mesh, MeshPhases,
    PerPlanet, StiffnessWave,
};

/// b_c of the paper's joint [m].
pub const PAPER_LENGTH: f64 = 10e-6;

/// List of equal values, one per planet.
pub fn same(planets: usize, value: f64) -> PerPlanet {
    (0..planets).map(|_| value).collect()
}

/// Mesh with equal backlash and error for all planets and phases of zero.
fn mesh(planets: usize, damping_ratio: f64, stiffness_ratio: f64, half_backlash: f64, transmission_error: f64) -> Mesh {
    Mesh {
        mean_stiffness: 1e8,
        stiffness_wave: StiffnessWave::Harmonic { stiffness_ratio },
        damping_ratio,
        half_backlash: same(planets, half_backlash),
        transmission_error: same(planets, transmission_error),
        phases: MeshPhases::Given { stiffness: same(planets, 0.0), error: same(planets, 0.0) },
    }
}

/// The paper's joint with the carrier and ring columns of Table 1 put back, damping ratio 0.05, law `paper`, no rotor and
/// no link; stiffness ripple K_a/K_m, error amplitude [m], half-backlash [m] and Omega = omega/omega_n as given.
pub fn paper_joint(stiffness_ratio: f64, transmission_error: f64, half_backlash: f64, omega: f64) -> JointParameters {
    let sun_equivalent_mass: f64 = 0.39;
    let planet_equivalent_mass: f64 = 0.61;
    JointParameters {
        name: "paper".try_into().expect("a short name"),
        geometry: Geometry {
            planets: 3,
            sun_teeth: 27,
            planet_teeth: 35,
            ring_teeth: 99,
            working_pressure_angle: 24.6_f64.to_radians(),
            sun_base_radius: 36.8241e-3,
            planet_base_radius: 47.7349e-3,
            carrier_radius: 93.0e-3,
            coherence: Coherence::Warned,
        },
        bodies: Bodies {
            sun_equivalent_mass,
            planet_equivalent_mass,
            planet_mass: 0.66,
            carrier_inertia_over_radius_squared: 6.29,
        },
        rotor_inertia: 0.0,
        link_inertia: 0.0,
        compliance: None,
        sun_planet: mesh(3, 0.05, stiffness_ratio, half_backlash, transmission_error),
        ring_planet: mesh(3, 0.05, stiffness_ratio, half_backlash, transmission_error),
        damping_law: DampingLaw::Paper,
        dead_zone: DeadZone::Sharp,
        excitation: Excitation::Time { mesh_frequency: omega * paper_natural_frequency() },
        characteristic_length: PAPER_LENGTH,
        rated_output_torque: 367.4,
    }
}

/// Returns the joint with another number of planets and other teeth of its module on sun, planets and ring; every mesh
/// is like the first of its kind.
pub fn with_teeth(mut joint: JointParameters, planets: usize, [sun, planet, ring]: [u32; 3]) -> JointParameters {
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.half_backlash = same(planets, mesh.half_backlash[0]);
        mesh.transmission_error = same(planets, mesh.transmission_error[0]);
    }
    let geometry = &mut joint.geometry;
    let per_tooth = geometry.sun_base_radius / f64::from(geometry.sun_teeth);
    (geometry.planets, geometry.sun_teeth, geometry.planet_teeth, geometry.ring_teeth) = (planets, sun, planet, ring);
    geometry.sun_base_radius = per_tooth * f64::from(sun);
    geometry.planet_base_radius = per_tooth * f64::from(planet);
    geometry.carrier_radius = per_tooth * f64::from(sun + planet) / geometry.working_pressure_angle.cos();
    joint
}

/// omega_n of the paper's joint, eq. 18 [rad/s].
pub fn paper_natural_frequency() -> f64 {
    (1e8 * (1.0 / 0.39 + 1.0 / 0.61_f64)).sqrt()
}

/// Q1, a quasi-direct-drive joint: 15/30/75 teeth of module 1 mm, law `contact`, excited by its own angle, no ripple and
/// no error of its own.
pub fn q1() -> JointParameters {
    let pressure_angle = 20.0_f64.to_radians();
    let module = 1e-3;
    let cosine = pressure_angle.cos();
    let carrier_radius: f64 = 0.5 * module * f64::from(15 + 30);
    let carrier_equivalent_mass = 0.15;
    let planet_mass = 0.05;
    JointParameters {
        name: "q1".try_into().expect("a short name"),
        geometry: Geometry {
            planets: 3,
            sun_teeth: 15,
            planet_teeth: 30,
            ring_teeth: 75,
            working_pressure_angle: pressure_angle,
            sun_base_radius: 0.5 * module * 15.0 * cosine,
            planet_base_radius: 0.5 * module * 30.0 * cosine,
            carrier_radius,
            coherence: Coherence::Required,
        },
        bodies: Bodies {
            sun_equivalent_mass: 0.02,
            planet_equivalent_mass: 0.03,
            planet_mass,
            // Q1 states the carrier over (r_c cos alpha)^2, without its planets.
            carrier_inertia_over_radius_squared: carrier_equivalent_mass * cosine * cosine,
        },
        rotor_inertia: 2.5e-4,
        link_inertia: 0.15,
        compliance: Some(Compliance { stiffness: 3.0 / (1.0_f64 / 60.0).to_radians(), damping_ratio: 0.02 }),
        sun_planet: mesh(3, 0.05, 0.0, 40e-6, 0.0),
        ring_planet: mesh(3, 0.05, 0.0, 40e-6, 0.0),
        damping_law: DampingLaw::Contact,
        dead_zone: DeadZone::Sharp,
        excitation: Excitation::Angle,
        characteristic_length: PAPER_LENGTH,
        rated_output_torque: 15.0,
    }
}

/// L1, a large stiff joint near the paper's with coherent geometry: 27/36/99 teeth, the paper's masses, a rotor of 2.0e-3
/// and a link of 0.60 kg m^2 without compliance, b = 60 um, law `contact`, excited by its own angle, no ripple and no
/// error of its own.
pub fn l1() -> JointParameters {
    let pressure_angle = 24.6_f64.to_radians();
    JointParameters {
        name: "l1".try_into().expect("a short name"),
        geometry: Geometry {
            planets: 3,
            sun_teeth: 27,
            planet_teeth: 36,
            ring_teeth: 99,
            working_pressure_angle: pressure_angle,
            sun_base_radius: 38.7e-3,
            planet_base_radius: 51.6e-3,
            carrier_radius: 90.3e-3 / pressure_angle.cos(),
            coherence: Coherence::Required,
        },
        rotor_inertia: 2.0e-3,
        link_inertia: 0.60,
        sun_planet: mesh(3, 0.05, 0.0, 60e-6, 0.0),
        ring_planet: mesh(3, 0.05, 0.0, 60e-6, 0.0),
        damping_law: DampingLaw::Contact,
        excitation: Excitation::Angle,
        ..paper_joint(0.0, 0.0, 0.0, 0.0)
    }
}

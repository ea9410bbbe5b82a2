//! Conversion of `JointParameters` into masses, springs and phases of `JointEquations`. All are derived from the paper
//! again, without the core. No state and no time.

use std::f64::consts::TAU;

use heapless::Vec;
use parameters::{DampingLaw, EquivalentGear, JointParameters, MAX_PLANETS, Mesh, MeshPhases, StiffnessWave};

use super::ReferenceError;
use super::equations::JointEquations;
use super::mesh_law::{MeshConstants, Zone};
use super::validity::check;

impl JointEquations {
    /// Equations of a joint, without torques.
    pub fn new(joint: &JointParameters) -> Result<Self, ReferenceError> {
        check(joint)?;
        if let Some(gear) = joint.equivalent_gear() {
            return Ok(Self::of_equivalent_gear(joint, &gear));
        }
        let geometry = &joint.geometry;
        let cosine = geometry.working_pressure_angle.cos();
        let carrier_lever = geometry.carrier_radius * cosine;
        let sun_own = joint.bodies.sun_equivalent_mass;
        let planet = joint.bodies.planet_equivalent_mass;
        let sun = sun_own + joint.rotor_inertia / geometry.sun_base_radius.powi(2);
        let carrier = (joint.bodies.carrier_inertia_over_radius_squared
            + geometry.planets as f64 * joint.bodies.planet_mass)
            / cosine.powi(2);
        let link = joint.link_inertia / carrier_lever.powi(2);

        let mut masses = Vec::new();
        let mut add = |mass| masses.push(mass).unwrap_or_else(|_| unreachable!("room for the most planets"));
        add(sun);
        (0..geometry.planets).for_each(|_| add(planet));
        let compliance = match joint.compliance {
            None => {
                add(carrier + link);
                None
            }
            Some(given) => {
                add(carrier);
                add(link);
                let stiffness = given.stiffness / carrier_lever.powi(2);
                // The sun moves twice as fast along the line of action, so its mass counts four times.
                let geared = 4.0 * sun + geometry.planets as f64 * planet + carrier;
                let reduced = geared * link / (geared + link);
                Some((stiffness, 2.0 * given.damping_ratio * (stiffness * reduced).sqrt()))
            }
        };

        // Eqs 9 and 10: the gears' own masses, the ring infinitely heavy.
        let sun_reduced = sun_own * planet / (sun_own + planet);
        let meshes = [
            constants(joint, &joint.sun_planet, sun_reduced, i64::from(geometry.sun_teeth)),
            constants(joint, &joint.ring_planet, planet, -i64::from(geometry.ring_teeth)),
        ];
        let carried =
            geometry.planets as f64 * (peak_stiffness(&joint.sun_planet) + peak_stiffness(&joint.ring_planet));
        let highest_frequency = highest_frequency(joint, &masses, compliance.map_or(0.0, |(stiffness, _)| stiffness));
        Ok(Self {
            planets: geometry.planets,
            equivalent: false,
            sun_lever: geometry.sun_base_radius,
            carrier_lever,
            ring_teeth: f64::from(geometry.ring_teeth),
            length: joint.characteristic_length,
            masses,
            link_mass: link,
            link_stiffness: compliance.map_or(carried, |(stiffness, _)| stiffness),
            compliance,
            hysteresis: None,
            meshes,
            zones: [[Zone::Free; MAX_PLANETS]; 2],
            excitation: joint.excitation,
            highest_frequency,
            harmonics: harmonics(&joint.sun_planet).max(harmonics(&joint.ring_planet)),
            phase_rate: 0.0,
            drive_force: 0.0,
            load_force: 0.0,
        })
    }

    /// Equations of an equivalent gear: motor and link on one spring with a gap. At the link's lever each of the two
    /// meshes takes half of the angle difference delta = theta_m / ratio - theta_l and half of the force: together they
    /// store K delta^2 / 2.
    fn of_equivalent_gear(joint: &JointParameters, gear: &EquivalentGear) -> Self {
        let ratio = f64::from(gear.ratio[0]) / f64::from(gear.ratio[1]);
        let lever = joint.geometry.carrier_radius;
        let (sun_lever, arm) = (2.0 * lever / ratio, lever * lever);
        let motor_inertia = joint.rotor_inertia + gear.inertia_at_input;
        let at_link = ratio * ratio * motor_inertia;
        let reduced = 1.0 / (1.0 / at_link + 1.0 / joint.link_inertia);
        let damping = 2.0 * gear.damping_ratio * (gear.stiffness * reduced).sqrt();
        let mesh = || {
            let constants = MeshConstants {
                mean_stiffness: 0.5 * gear.stiffness / arm,
                wave: StiffnessWave::Harmonic { stiffness_ratio: 0.0 },
                stiffness_phase: 0.0,
                damping: 0.5 * damping / arm,
                law: DampingLaw::Contact,
                half_backlash: 0.5 * gear.lost_motion * lever,
                nominal_half_backlash: 0.5 * gear.lost_motion * lever,
                error_amplitude: 0.0,
                error_phase: 0.0,
            };
            Vec::from_iter([constants])
        };
        Self {
            planets: 1,
            equivalent: true,
            sun_lever,
            carrier_lever: lever,
            ring_teeth: DEFAULT_TURN_DIVISION,
            length: joint.characteristic_length,
            masses: Vec::from_iter([motor_inertia / (sun_lever * sun_lever), joint.link_inertia / arm]),
            link_mass: joint.link_inertia / arm,
            link_stiffness: gear.stiffness / arm,
            compliance: None,
            hysteresis: None,
            meshes: [mesh(), mesh()],
            zones: [[Zone::Free; MAX_PLANETS]; 2],
            excitation: joint.excitation,
            highest_frequency: (gear.stiffness / reduced).sqrt(),
            harmonics: 1.0,
            phase_rate: 0.0,
            drive_force: 0.0,
            load_force: 0.0,
        }
    }
}

/// Substitute for the number of ring teeth in a joint without teeth: whole parts of a turn are taken off the
/// coordinates; any number works that keeps them small.
const DEFAULT_TURN_DIVISION: f64 = 16384.0;

fn constants(
    joint: &JointParameters,
    mesh: &Mesh,
    reduced_mass: f64,
    signed_teeth: i64,
) -> Vec<MeshConstants, MAX_PLANETS> {
    let planets = joint.geometry.planets as i64;
    // Planet i is at angle 2 pi i / n; only the resulting fraction of a tooth matters.
    let by_teeth = |planet: usize| TAU * (signed_teeth * planet as i64).rem_euclid(planets) as f64 / planets as f64;
    let phases = |planet: usize| match &mesh.phases {
        MeshPhases::Given { stiffness, error } => (stiffness[planet], error[planet]),
        MeshPhases::FromTeeth { stiffness, error } => (stiffness + by_teeth(planet), error + by_teeth(planet)),
    };
    (0..joint.geometry.planets)
        .map(|planet| MeshConstants {
            mean_stiffness: mesh.mean_stiffness,
            wave: mesh.stiffness_wave,
            stiffness_phase: phases(planet).0,
            damping: 2.0 * mesh.damping_ratio * (mesh.mean_stiffness * reduced_mass).sqrt(),
            law: joint.damping_law,
            half_backlash: mesh.half_backlash[planet],
            nominal_half_backlash: mesh.half_backlash[planet],
            error_amplitude: mesh.transmission_error[planet],
            error_phase: phases(planet).1,
        })
        .collect()
}

/// Highest harmonic of a stiffness wave.
fn harmonics(mesh: &Mesh) -> f64 {
    match mesh.stiffness_wave {
        StiffnessWave::Harmonic { .. } => 1.0,
        StiffnessWave::Rectangular { order, .. } => order.max(1) as f64,
    }
}

/// Stiffness of a mesh at the crest of its wave [N/m].
fn peak_stiffness(mesh: &Mesh) -> f64 {
    let ratio = match mesh.stiffness_wave {
        StiffnessWave::Harmonic { stiffness_ratio } => stiffness_ratio,
        StiffnessWave::Rectangular { stiffness_ratio, .. } => 2.0 * stiffness_ratio,
    };
    mesh.mean_stiffness * (1.0 + ratio.abs())
}

/// Upper bound of the highest natural frequency (Gershgorin, row by row) at crest stiffness [rad/s].
fn highest_frequency(joint: &JointParameters, masses: &[f64], compliance: f64) -> f64 {
    let planets = joint.geometry.planets as f64;
    let (sun_planet, ring_planet) = (peak_stiffness(&joint.sun_planet), peak_stiffness(&joint.ring_planet));
    let carrier = joint.geometry.planets + 1;
    let rows = masses.iter().enumerate().map(|(body, mass)| {
        let row = match body {
            0 => 3.0 * planets * sun_planet,
            _ if body < carrier => 3.0 * sun_planet + 2.0 * ring_planet,
            _ if body == carrier => planets * (3.0 * sun_planet + 2.0 * ring_planet) + 2.0 * compliance,
            _ => 2.0 * compliance,
        };
        row / mass
    });
    rows.fold(0.0, f64::max).sqrt()
}

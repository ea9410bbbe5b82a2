//! Realistic random joints by seed: 3 to 5 planets that can be assembled, sizes between Q1 and L1, planets both light
//! and heavy compared with the inertia at the motor. Tests of properties of all joints use them.

use std::f64::consts::TAU;

use parameters::{Compliance, DampingLaw, EquivalentGear, JointParameters, MeshPhases, PerPlanet, StiffnessWave};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::joints::{l1, q1, with_teeth};

/// Reciprocal of the share of joints without teeth.
const EQUIVALENT_GEAR_EVERY: u32 = 8;

struct RandomNumbers(ChaCha8Rng);

impl RandomNumbers {
    fn part(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }

    /// Returns a log-uniform number.
    fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.part())
    }

    fn whole_number(&mut self, low: u32, high: u32) -> u32 {
        low + (self.part() * f64::from(high - low + 1)) as u32
    }

    fn one_in(&mut self, many: u32) -> bool {
        self.whole_number(1, many) == 1
    }
}

/// Returns the joint of a seed: one in eight is an equivalent gear.
pub fn random_joint(seed: u64) -> JointParameters {
    let mut random = RandomNumbers(ChaCha8Rng::seed_from_u64(seed));
    if random.one_in(EQUIVALENT_GEAR_EVERY) {
        without_teeth(&mut random, seed)
    } else {
        with_planets(&mut random, seed)
    }
}

fn without_teeth(random: &mut RandomNumbers, seed: u64) -> JointParameters {
    let ratio = [random.whole_number(20, 400), 4];
    let rated = random.log_uniform(5.0, 200.0);
    let stiffness = rated / random.log_uniform(3e-4, 3e-3);
    let link_inertia = rated / random.log_uniform(20.0, 200.0);
    let over = f64::from(ratio[0]) / f64::from(ratio[1]);
    // Between a tenth of the link's inertia and ten times it.
    let rotor_inertia = link_inertia * random.log_uniform(0.1, 10.0) / (over * over);
    let gear = EquivalentGear {
        ratio,
        lost_motion: random.log_uniform(1e-4, 3e-3),
        stiffness,
        damping_ratio: random.log_uniform(0.02, 0.15),
        inertia_at_input: rotor_inertia * random.log_uniform(0.05, 0.5),
    };
    let name = format!("random {seed}");
    gear.joint(name.as_str().try_into().unwrap_or_default(), rotor_inertia, link_inertia, rated)
}

fn with_planets(random: &mut RandomNumbers, seed: u64) -> JointParameters {
    let planets = random.whole_number(3, 5);
    let light = random.one_in(2);
    let mut joint = with_teeth(if light { q1() } else { l1() }, planets as usize, teeth(random, planets));
    let name = format!("random {seed}");
    joint.name = name.as_str().try_into().unwrap_or_default();
    joint.bodies.sun_equivalent_mass *= random.log_uniform(0.5, 2.0);
    let planet = random.log_uniform(0.3, 3.0);
    joint.bodies.planet_equivalent_mass *= planet;
    joint.bodies.planet_mass *= planet;
    joint.bodies.carrier_inertia_over_radius_squared *= random.log_uniform(0.5, 2.0);
    joint.rotor_inertia *= random.log_uniform(0.5, 2.0);
    joint.link_inertia *= random.log_uniform(0.5, 4.0);
    joint.rated_output_torque *= random.log_uniform(0.5, 1.5);
    joint.damping_law = if random.one_in(4) { DampingLaw::Paper } else { DampingLaw::Contact };
    joint.compliance = (!random.one_in(3)).then(|| Compliance {
        stiffness: joint.rated_output_torque / random.log_uniform(5e-4, 3e-3),
        damping_ratio: random.log_uniform(0.01, 0.1),
    });
    let half_backlash = random.log_uniform(5e-6, 80e-6);
    let (stiffness, damping) = (random.log_uniform(0.5, 2.0), random.log_uniform(0.03, 0.12));
    let (ripple, error) = (random.uniform(0.02, 0.25), random.uniform(0.0, 5e-6));
    let phases = [random.uniform(0.0, TAU), random.uniform(0.0, TAU)];
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.mean_stiffness *= stiffness;
        mesh.damping_ratio = damping;
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: ripple };
        mesh.phases = MeshPhases::FromTeeth { stiffness: phases[0], error: phases[1] };
        let mut each = |value: f64| -> PerPlanet { (0..planets).map(|_| value * random.uniform(0.8, 1.0)).collect() };
        (mesh.half_backlash, mesh.transmission_error) = (each(half_backlash), each(error));
    }
    joint
}

/// Returns teeth of sun, planets and ring that allow this number of evenly spaced planets.
fn teeth(random: &mut RandomNumbers, planets: u32) -> [u32; 3] {
    let sun = random.whole_number(15, 36);
    // For assembly, the sum of sun and ring teeth, 2 (sun + planet), is a multiple of the number of planets.
    let planet = (sun.max(18)..).find(|planet| (2 * (sun + planet)).is_multiple_of(planets)).unwrap_or(sun);
    let planet = planet + random.whole_number(0, 4) * if planets == 4 { 2 } else { planets };
    [sun, planet, sun + 2 * planet]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_seed_gives_a_sound_joint() {
        let joints: Vec<JointParameters> = (0..200).map(random_joint).collect();
        for joint in &joints {
            assert_eq!(joint.validate(), Ok(()), "{}", joint.name);
            let geometry = &joint.geometry;
            assert!((geometry.sun_teeth + geometry.ring_teeth).is_multiple_of(geometry.planets as u32));
        }
        for planets in [1, 3, 4, 5] {
            assert!(joints.iter().filter(|joint| joint.geometry.planets == planets).count() >= 10, "{planets}");
        }
        assert_eq!(random_joint(7), joints[7]);
    }
}

//! Random joints and motions, far apart in everything that a joint file can say: planets, masses, stiffness, damping,
//! backlash, ripple, errors, excitation, torques that hold contact or reverse.

use std::f64::consts::TAU;

use model_core::gears::design::{Effort, Substeps};
use model_core::gears::{Mechanics, Scales};
use parameters::{Compliance, DampingLaw, Excitation, JointParameters, Mesh, MeshPhases, PerPlanet, StiffnessWave};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use reference::scenarios::l1;

/// Chance that repeats itself.
pub struct Chance(ChaCha8Rng);

/// A joint and the torques that act on it.
pub struct Case {
    pub joint: JointParameters,
    /// Drive torque at first and from a third of the motion on [N m]; the load balances the first.
    pub drive: [f64; 2],
    pub load: [f64; 2],
    /// Where the meshes begin: mean deflection beyond half the backlash [m].
    pub deflection: f64,
    /// Speed of the carrier at first [rad/s].
    pub speed: f64,
    /// Phase of the fastest mode in a part, about, and parts of a tick.
    pub phase: f64,
    pub parts: Substeps,
}

impl Case {
    /// What makes a tick of these parts.
    pub fn effort(&self) -> Effort {
        match self.parts {
            Substeps::Corrected(substeps) => Effort::Substeps(substeps),
            Substeps::Verlet(substeps) => Effort::Verlet(substeps),
        }
    }
}

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn part(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }

    /// Evenly over orders of magnitude.
    fn scaled(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.part())
    }

    fn heads(&mut self) -> bool {
        self.part() < 0.5
    }

    fn whole(&mut self, low: u32, high: u32) -> u32 {
        low + (self.part() * f64::from(high - low + 1)) as u32
    }

    fn mesh(&mut self, planets: usize, [half_backlash, ripple]: [f64; 2]) -> Mesh {
        let unequal = self.heads();
        let phases = if self.heads() {
            let mut list = || -> PerPlanet { (0..planets).map(|_| self.between(0.0, TAU)).collect() };
            MeshPhases::Given { stiffness: list(), error: list() }
        } else {
            MeshPhases::FromTeeth { stiffness: self.between(0.0, TAU), error: self.between(0.0, TAU) }
        };
        let error = if self.heads() { self.between(0.0, 15e-6) } else { 0.0 };
        let stiffness_wave = if self.part() < 0.8 {
            StiffnessWave::Harmonic { stiffness_ratio: ripple }
        } else {
            let (contact_ratio, order) = (self.between(1.2, 1.9), self.whole(2, 5) as usize);
            StiffnessWave::Rectangular { stiffness_ratio: 0.5 * ripple, contact_ratio, order }
        };
        let mut spread = |value: f64| -> PerPlanet {
            (0..planets).map(|_| if unequal { value * self.between(0.5, 1.0) } else { value }).collect()
        };
        let (half_backlash, transmission_error) = (spread(half_backlash), spread(error));
        Mesh {
            mean_stiffness: self.scaled(3e7, 3e8),
            stiffness_wave,
            damping_ratio: self.scaled(0.02, 0.2),
            half_backlash,
            transmission_error,
            phases,
        }
    }

    /// The next case.
    pub fn case(&mut self) -> Case {
        let mut joint = l1();
        let planets = self.whole(3, 5) as usize;
        joint.geometry.planets = planets;
        joint.geometry.sun_teeth = self.whole(20, 40);
        joint.geometry.ring_teeth = 3 * joint.geometry.sun_teeth + self.whole(0, 6);
        joint.bodies.sun_equivalent_mass = self.scaled(0.2, 1.0);
        joint.bodies.planet_equivalent_mass = self.scaled(0.1, 1.5);
        joint.bodies.carrier_inertia_over_radius_squared = self.scaled(2.0, 20.0);
        joint.rotor_inertia = self.scaled(1e-4, 1e-2);
        joint.link_inertia = self.scaled(0.1, 3.0);
        joint.compliance = self
            .heads()
            .then(|| Compliance { stiffness: self.scaled(1e4, 1e5), damping_ratio: self.scaled(0.01, 0.1) });
        joint.damping_law = if self.heads() { DampingLaw::Contact } else { DampingLaw::Paper };
        let (half_backlash, ripple) = (self.scaled(3e-6, 120e-6), self.between(0.0, 0.35));
        joint.sun_planet = self.mesh(planets, [half_backlash, ripple]);
        joint.ring_planet = self.mesh(planets, [half_backlash, ripple]);
        let mut speed = self.scaled(0.1, 30.0);
        let mesh_frequency = self.scaled(0.02, 2.0) * Scales::new(&joint).frequency;
        joint.excitation = if self.heads() {
            speed = 0.0;
            Excitation::Time { mesh_frequency }
        } else {
            Excitation::Angle
        };
        let deflection = self.scaled(2e-6, 40e-6);
        let drive = planets as f64 * joint.sun_planet.mean_stiffness * deflection * joint.geometry.sun_base_radius;
        let later = match self.whole(0, 3) {
            0 => -self.scaled(0.1, 1.0),
            1 => self.scaled(0.1, 1.0),
            _ => 1.0,
        };
        let load = joint.balanced_load_torque(drive);
        Case {
            drive: [drive, later * drive],
            load: [load, later * load],
            deflection,
            speed,
            phase: self.scaled(0.08, 2.2),
            parts: Substeps::Corrected(self.whole(1, 6)),
            joint,
        }
    }

    /// The next case with planets so light that Verlet sub-steps are taken.
    pub fn light_case(&mut self) -> Case {
        let mut case = self.case();
        case.joint.bodies.planet_equivalent_mass = self.scaled(0.005, 0.05);
        case.phase = self.between(0.5, 1.1);
        case.parts = Substeps::Verlet(self.whole(2, 10));
        case
    }
}

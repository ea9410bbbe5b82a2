//! The reduced model (n + 1 relative coordinates) against the full model (n + 2 bodies, one more of each with a compliance): flow of the
//! reduced model against the full flow in relative coordinates. Linear: contact is closed throughout.

use host_tests::tolerance::REDUCED;
use model_core::gears::Scales;
use model_core::gears::design::dynamics::Dynamics;
use model_core::gears::design::exponential::exponential_minus_identity;
use model_core::gears::design::hamiltonian;
use nalgebra::{DMatrix, DVector};
use parameters::JointParameters;
use reference::scenarios::{paper_joint, q1};

/// Bodies in the order sun, planets, carrier, link: mass matrix, damping and stiffness of eqs 1-6 by hand, and the relative coordinates of
/// eqs 16 and 17.
struct Full {
    masses: DVector<f64>,
    damping: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    relative: DMatrix<f64>,
    /// Rigid-body motion: the sun moves twice as far as all others.
    rigid: DVector<f64>,
}

impl Full {
    fn new(joint: &JointParameters) -> Self {
        let n = joint.geometry.planets;
        let cosine = joint.geometry.working_pressure_angle.cos();
        let lever = joint.geometry.carrier_radius * cosine;
        let (own_sun, planet) = (joint.bodies.sun_equivalent_mass, joint.bodies.planet_equivalent_mass);
        let sun = own_sun + joint.rotor_inertia / joint.geometry.sun_base_radius.powi(2);
        let carrier =
            (joint.bodies.carrier_inertia_over_radius_squared + n as f64 * joint.bodies.planet_mass) / cosine.powi(2);
        let link = joint.link_inertia / lever.powi(2);
        let mut masses = vec![planet; n + 2];
        (masses[0], masses[n + 1]) = (sun, carrier);
        match joint.compliance {
            Some(_) => masses.push(link),
            None => masses[n + 1] += link,
        }
        let size = masses.len();
        let (mut damping, mut stiffness) = (DMatrix::zeros(size, size), DMatrix::zeros(size, size));
        let mut relative = DMatrix::zeros(size - 1, size);
        let mut spring = |across: &DVector<f64>, constant: f64, damper: f64| {
            stiffness += constant * across * across.transpose();
            damping += damper * across * across.transpose();
        };
        let across = |parts: &[(usize, f64)]| {
            let mut across = DVector::zeros(size);
            parts.iter().for_each(|(body, share)| across[*body] = *share);
            across
        };
        let (sun_planet, ring_planet) = (&joint.sun_planet, &joint.ring_planet);
        let damper = |ratio: f64, constant: f64, mass: f64| 2.0 * ratio * (constant * mass).sqrt();
        for i in 0..n {
            let sun_mesh = across(&[(0, 1.0), (1 + i, -1.0), (n + 1, -1.0)]);
            let (k, mass) = (sun_planet.mean_stiffness, own_sun * planet / (own_sun + planet));
            spring(&sun_mesh, k, damper(sun_planet.damping_ratio, k, mass));
            let k = ring_planet.mean_stiffness;
            spring(&across(&[(1 + i, 1.0), (n + 1, -1.0)]), k, damper(ring_planet.damping_ratio, k, planet));
            relative.set_row(i, &sun_mesh.transpose());
        }
        relative.set_row(n, &across(&[(0, 1.0), (n + 1, -2.0)]).transpose());
        if let Some(compliance) = joint.compliance {
            let wind_up = across(&[(n + 1, 1.0), (n + 2, -1.0)]);
            let k = compliance.stiffness / lever.powi(2);
            let geared = 4.0 * sun + n as f64 * planet + carrier;
            spring(&wind_up, k, damper(compliance.damping_ratio, k, geared * link / (geared + link)));
            relative.set_row(n + 1, &wind_up.transpose());
        }
        let mut rigid = DVector::from_element(size, 1.0);
        rigid[0] = 2.0;
        Self { masses: DVector::from_vec(masses), damping, stiffness, relative, rigid }
    }

    /// exp - I of positions and speeds over a dimensionless step, in units of omega_n.
    fn flow(&self, frequency: f64, step: f64) -> DMatrix<f64> {
        let size = self.masses.len();
        let inverse = DMatrix::from_diagonal(&self.masses.map(|mass| 1.0 / mass));
        let mut matrix = DMatrix::zeros(2 * size, 2 * size);
        matrix.view_mut((0, size), (size, size)).fill_with_identity();
        matrix.view_mut((size, 0), (size, size)).copy_from(&(&inverse * &self.stiffness / -frequency.powi(2)));
        matrix.view_mut((size, size), (size, size)).copy_from(&(&inverse * &self.damping / -frequency));
        exponential_minus_identity(&matrix, step)
    }
}

/// Block matrix that applies a matrix to positions and to rates.
fn block_diagonal(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::<f64>::identity(2, 2).kronecker(matrix)
}

/// The reduced flow equals the full flow in relative coordinates, with 3 to 5 planets.
#[test]
fn reduced_flow_equals_full_flow() {
    for planets in 3..=5 {
        for mut joint in [paper_joint(0.0, 0.0, 0.0, 1.0), q1()] {
            joint.geometry.planets = planets;
            joint.ring_planet.mean_stiffness = 1.3e8;
            let full = Full::new(&joint);
            let scales = Scales::new(&joint);
            let dynamics = Dynamics::new(&joint, &scales);
            let (forward, backward) = hamiltonian::from_rates(&dynamics);
            let relative = block_diagonal(&full.relative);
            for step in [0.01, 1.025, 20.5] {
                let reduced = &backward * exponential_minus_identity(&hamiltonian::matrix(&dynamics), step) * &forward;
                let difference = &relative * full.flow(scales.frequency, step) - reduced * &relative;
                print!("{}, {planets} planets, step {step}: ", joint.name);
                REDUCED.check(difference.amax());
            }
        }
    }
}

/// The reduction leaves out the rigid body, which coasts.
#[test]
fn full_model_adds_a_coasting_mode() {
    for planets in 3..=5 {
        for mut joint in [paper_joint(0.0, 0.0, 0.0, 1.0), q1()] {
            joint.geometry.planets = planets;
            let full = Full::new(&joint);
            let size = full.masses.len();
            REDUCED.check((&full.relative * &full.rigid).amax());
            let mut coasting = DVector::zeros(2 * size);
            coasting.rows_mut(size, size).copy_from(&full.rigid);
            let mut moved = DVector::zeros(2 * size);
            moved.rows_mut(0, size).copy_from(&(20.5 * &full.rigid));
            REDUCED.check((full.flow(Scales::new(&joint).frequency, 20.5) * coasting - moved).amax());
        }
    }
}

//! Matrices of eq. 19 in dimensionless relative coordinates, derived from eqs 1-4 rather than copied from the paper. They
//! describe the joint with all meshes closed at mean stiffness, without excitation and backlash.
//!
//! Bodies u = (sun, planets.., carrier[, link]) with M u'' = Q - D^T f, deflections d = D u, f = k d + c d'. Relative
//! coordinates x = T u (planets.., gap[, wind-up]) satisfy D = E T, so x'' = -G (k E x + c E x') + T M^-1 Q with
//! G = T M^-1 D^T. With unit mass matrix, K = G k E and C = G c E.
//!
//! Equations: (P11) in docs/theory/paper.md.
//! Equations: (S4) in docs/theory/step.md.

use nalgebra::{DMatrix, DVector};

use crate::gears::kinematics::Kinematics;
use crate::gears::mechanics::Mechanics;
use crate::gears::scales::Scales;
use crate::gears::stiffness_series::StiffnessSeries;
use parameters::{JointParameters, MESH_KINDS, MeshKind};

/// Matrices of x'' + C x' + K x = forces, all dimensionless.
#[derive(Debug, Clone, PartialEq)]
pub struct Dynamics {
    /// Number of planets n.
    pub planets: usize,
    /// C, by coordinates (n + 1, or n + 2 with compliance).
    pub damping: DMatrix<f64>,
    /// K, by coordinates.
    pub stiffness: DMatrix<f64>,
    /// G: deceleration by unit mesh forces; one column per mesh, sun-planet of every planet, then ring-planet.
    pub mesh_gain: DMatrix<f64>,
    /// Acceleration of the coordinates by unit accelerations of sun, carrier and link; the last column is zero without
    /// compliance.
    pub torque_gain: DMatrix<f64>,
    /// Dimensionless mobilities of the bodies, in the order of u.
    pub mobilities: DVector<f64>,
    /// Largest damping over smallest stiffness of a mesh: the time within which damping can cancel a contact force.
    pub longest_relaxation: f64,
    /// Dimensionless stiffness and damping between carrier and link, if compliant.
    pub wind_up: Option<(f64, f64)>,
}

/// Equivalent masses of the moving bodies: with rotor on the sun, and with the link on the carrier unless compliant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingMasses {
    /// Sun with rotor [kg].
    pub sun: f64,
    /// One planet [kg].
    pub planet: f64,
    /// Carrier with planets, and with the link in a joint without compliance [kg].
    pub carrier: f64,
    /// Link, in a joint with compliance [kg].
    pub link: Option<f64>,
}

impl MovingMasses {
    /// Masses of a joint.
    pub fn new(parameters: &JointParameters) -> Self {
        let compliant = parameters.compliance.is_some();
        let link = parameters.link_equivalent_mass();
        Self {
            sun: parameters.bodies.sun_equivalent_mass + parameters.rotor_equivalent_mass(),
            planet: parameters.bodies.planet_equivalent_mass,
            carrier: parameters.carrier_equivalent_mass() + if compliant { 0.0 } else { link },
            link: compliant.then_some(link),
        }
    }

    /// phi^T M phi of the rigid motion phi = (2, 1.., 1[, 1]), the mass that the torques accelerate [kg].
    pub fn rigid(&self, planets: usize) -> f64 {
        4.0 * self.sun + planets as f64 * self.planet + self.carrier + self.link.unwrap_or(0.0)
    }
}

impl Dynamics {
    /// Matrices of a joint.
    pub fn new(parameters: &JointParameters, scales: &Scales) -> Self {
        let planets = parameters.geometry.planets;
        let masses = MovingMasses::new(parameters);
        let wind_up = parameters.compliance.as_ref().map(|compliance| {
            let lever = parameters.geometry.carrier_base_radius();
            let stiffness = compliance.stiffness / (lever * lever);
            // The link oscillates against all bodies geared to the carrier; the rotor dominates.
            let link = parameters.link_equivalent_mass();
            let geared = masses.rigid(planets) - link;
            let reduced = geared * link / (geared + link);
            let damping = 2.0 * compliance.damping_ratio * libm::sqrt(stiffness * reduced);
            (stiffness / scales.stiffness, scales.damping(damping))
        });
        let coordinates = planets + 1 + usize::from(wind_up.is_some());
        let bodies = coordinates + 1;
        let (sun, carrier, link) = (0, planets + 1, planets + 2);

        let mut mobilities = DVector::from_element(bodies, scales.mobility(masses.planet));
        mobilities[sun] = scales.mobility(masses.sun);
        mobilities[carrier] = scales.mobility(masses.carrier);
        if let Some(mass) = masses.link {
            mobilities[link] = scales.mobility(mass);
        }

        // x = T u: eqs 16 and 17 without imposed errors.
        let mut relative = DMatrix::zeros(coordinates, bodies);
        for i in 0..planets {
            relative[(i, sun)] = 1.0;
            relative[(i, 1 + i)] = -1.0;
            relative[(i, carrier)] = -1.0;
        }
        relative[(planets, sun)] = 1.0;
        relative[(planets, carrier)] = -2.0;
        if wind_up.is_some() {
            relative[(planets + 1, carrier)] = 1.0;
            relative[(planets + 1, link)] = -1.0;
        }

        // d = E x: p_i for a sun mesh, g - p_i for a ring mesh (argument of eq. 19). The wind-up spring adds a row.
        let springs = 2 * planets + usize::from(wind_up.is_some());
        let mut elongation = DMatrix::zeros(springs, coordinates);
        let mut stiffness = DVector::zeros(springs);
        let mut damping = DVector::zeros(springs);
        for (family, kind) in MESH_KINDS.into_iter().enumerate() {
            for i in 0..planets {
                let row = family * planets + i;
                match kind {
                    MeshKind::SunPlanet => elongation[(row, i)] = 1.0,
                    MeshKind::RingPlanet => {
                        elongation[(row, planets)] = 1.0;
                        elongation[(row, i)] = -1.0;
                    }
                }
                stiffness[row] = parameters.mesh(kind).mean_stiffness / scales.stiffness;
                damping[row] = scales.damping(parameters.damping_coefficient(kind));
            }
        }
        if let Some((spring, damper)) = wind_up {
            elongation[(2 * planets, planets + 1)] = 1.0;
            stiffness[2 * planets] = spring;
            damping[2 * planets] = damper;
        }

        let longest_relaxation = MESH_KINDS
            .into_iter()
            .enumerate()
            .map(|(family, kind)| {
                damping[family * planets]
                    / (stiffness[family * planets] * (1.0 - parameters.mesh(kind).stiffness_wave.swing()))
            })
            .fold(0.0, f64::max);
        let inverse_mass = DMatrix::from_diagonal(&mobilities);
        let gain = &relative * inverse_mass * (&elongation * &relative).transpose();
        let mut torque_gain = DMatrix::zeros(coordinates, 3);
        torque_gain.set_column(0, &relative.column(sun));
        torque_gain.set_column(1, &relative.column(carrier));
        if wind_up.is_some() {
            torque_gain.set_column(2, &relative.column(link));
        }
        Self {
            planets,
            damping: &gain * DMatrix::from_diagonal(&damping) * &elongation,
            stiffness: &gain * DMatrix::from_diagonal(&stiffness) * &elongation,
            mesh_gain: gain.columns(0, 2 * planets).into_owned(),
            torque_gain,
            mobilities,
            longest_relaxation,
            wind_up,
        }
    }

    /// Number of relative coordinates.
    pub fn coordinates(&self) -> usize {
        self.stiffness.nrows()
    }
}

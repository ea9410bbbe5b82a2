//! Closed forms of the joint: dimensionless masses and springs, the planet modes, and the two-by-two system of in-phase planet motion (eq.
//! 19 with all X_sp equal). Nothing here comes from the core.

use nalgebra::{Complex, Matrix2, Vector2};
use parameters::{JointParameters, MeshPhases};
use reference::scenarios::{PAPER_LENGTH, paper_joint, same};

/// K_rp over K_sp, different from 1 so that mixing them up shows.
const RING_STIFFNESS: f64 = 1.3;

/// Masses of the paper's joint with n planets.
#[derive(Clone, Copy)]
pub struct ClosedForm {
    pub planets: f64,
    /// Masses of sun, planet, carrier times omega_n^2 / K_m.
    pub sun: f64,
    pub planet: f64,
    pub carrier: f64,
    /// K_sp and K_rp over K_m.
    pub stiffness: [f64; 2],
    /// Damping of both families, dimensionless.
    pub damping: [f64; 2],
}

/// Parameters of the same joint for the core: no ripple, errors of 30 um in phase, half-backlash [m], Omega.
pub fn joint(planets: usize, damping_ratio: f64, half_backlash: f64, omega: f64) -> JointParameters {
    let mut joint = paper_joint(0.0, 30e-6, half_backlash, omega);
    joint.geometry.planets = planets;
    joint.ring_planet.mean_stiffness *= RING_STIFFNESS;
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.damping_ratio = damping_ratio;
        mesh.half_backlash = same(planets, half_backlash);
        mesh.transmission_error = same(planets, 30e-6);
        mesh.phases = MeshPhases::Given { stiffness: same(planets, 0.0), error: same(planets, 0.0) };
    }
    joint
}

impl ClosedForm {
    /// Closed form with the ring stiffness of [`joint`].
    pub fn new(planets: usize, damping_ratio: f64) -> Self {
        Self::with_ring(planets, damping_ratio, RING_STIFFNESS)
    }

    /// Closed form with a given ring stiffness.
    pub fn with_ring(planets: usize, damping_ratio: f64, ring: f64) -> Self {
        let planets = planets as f64;
        let (sun, planet) = (0.39_f64, 0.61_f64);
        let square = 1.0 / sun + 1.0 / planet;
        let carrier = (6.29 + planets * 0.66) / 24.6_f64.to_radians().cos().powi(2);
        let damping = |stiffness: f64, mass: f64| 2.0 * damping_ratio * (stiffness * mass * square).sqrt();
        Self {
            planets,
            sun: sun * square,
            planet: planet * square,
            carrier: carrier * square,
            stiffness: [1.0, ring],
            damping: [damping(1.0, sun * planet / (sun + planet)), damping(ring, planet)],
        }
    }

    /// Oracle 1: frequencies of the planet mode and of the two overall modes, over omega_n.
    pub fn frequencies(&self) -> [f64; 3] {
        let (n, [sp, rp]) = (self.planets, self.stiffness);
        let (sun, planet, carrier) = (self.sun, self.planet, self.carrier);
        let l1 = sun * planet * carrier;
        let l2 = -(n * sp * planet * carrier + (sp + rp) * carrier * sun + n * (sp + rp) * planet * sun);
        let l3 = n * sp * rp * (n * planet + carrier + 4.0 * sun);
        let root = (l2 * l2 - 4.0 * l1 * l3).sqrt();
        [(sp + rp) / planet, (-l2 - root) / (2.0 * l1), (-l2 + root) / (2.0 * l1)].map(f64::sqrt)
    }

    /// Deceleration of (X_sp, X_sc) by a unit force in every sun mesh, and in every ring mesh.
    fn gains(&self) -> [Vector2<f64>; 2] {
        let (n, sun, planet, carrier) = (self.planets, self.sun, self.planet, self.carrier);
        [
            Vector2::new(n / sun + n / carrier + 1.0 / planet, n / sun + 2.0 * n / carrier),
            Vector2::new(n / carrier - 1.0 / planet, 2.0 * n / carrier),
        ]
    }

    /// K or C of the in-phase motion, from the springs or the dampers of the two families.
    pub fn in_phase(&self, [sun_planet, ring_planet]: [f64; 2]) -> Matrix2<f64> {
        let [sun, ring] = self.gains();
        sun_planet * sun * Vector2::new(1.0, 0.0).transpose() + ring_planet * ring * Vector2::new(-1.0, 1.0).transpose()
    }

    /// Oracle 3: complex amplitudes of the deflections X_sp and X_rp under an equal error in every mesh, over b_c.
    pub fn ellipse(&self, omega: f64, error: f64) -> [Complex<f64>; 2] {
        let complex = |matrix: Matrix2<f64>| matrix.map(|value| Complex::new(value, 0.0));
        let turn = Complex::new(0.0, omega);
        let matrix = complex(self.in_phase(self.stiffness))
            + complex(self.in_phase(self.damping)) * turn
            + Matrix2::identity() * (turn * turn);
        let [sun, ring] = self.gains().map(|gain| gain.map(|value| Complex::new(value * error, 0.0)));
        let impedance = [0, 1].map(|kind| Complex::new(self.stiffness[kind], 0.0) + turn * self.damping[kind]);
        let forcing = sun * impedance[0] + ring * impedance[1];
        let solved = matrix.lu().solve(&forcing).expect("damped, so never singular");
        [solved[0] - error, solved[1] - solved[0] - error]
    }

    /// Oracle 4: static mesh deflections and gap coordinate for a drive torque [N m], over b_c.
    pub fn at_rest(&self, drive: f64, half_backlash: f64) -> [f64; 3] {
        let force = drive / (self.planets * 36.8241e-3) / (1e8 * PAPER_LENGTH);
        let [sun, ring] = self.stiffness.map(|stiffness| force.signum() * half_backlash + force / stiffness);
        [sun, ring, sun + ring]
    }
}

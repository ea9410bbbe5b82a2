//! Planar planetary gear with three degrees of freedom a body (Lin and Parker 1999, source of the paper's Table 1), built here from its
//! springs alone: with the columns of Table 1 corrected it has the published frequencies. The project's model is its torsional part:
//! extracted from the same matrices, it has the model's frequencies.

use std::f64::consts::TAU;

use host_tests::tolerance::{PUBLISHED_FREQUENCY, TORSIONAL_PART};
use model_core::gears::design::modes::natural_frequencies;
use nalgebra::{DMatrix, DVector};
use reference::scenarios::{paper_joint, same};

/// Pressure angle [rad].
fn alpha() -> f64 {
    24.6_f64.to_radians()
}

/// Mass and I / r^2 [kg] of carrier, ring, sun and a planet: Table 1 with carrier and ring exchanged.
const BODIES: [[f64; 2]; 4] = [[5.43, 6.29], [2.35, 3.00], [0.4, 0.39], [0.66, 0.61]];
const CARRIER: usize = 0;
const RING: usize = 1;
const SUN: usize = 2;
const PLANET: usize = 3;

/// Springs [N/m]: meshes, bearings of carrier, ring, sun and planets, and the torsional support of the ring.
const MESH: f64 = 5e8;
const BEARING: f64 = 1e8;
const RING_TORSION: f64 = 1e9;

/// Mass and stiffness over x, y, u of carrier, ring and sun, then radial, tangential, u of every planet.
struct Gear {
    masses: DVector<f64>,
    stiffness: DMatrix<f64>,
}

impl Gear {
    fn new(planets: usize, bodies: [[f64; 2]; 4], torsion_of_the_ring: f64) -> Self {
        let size = 3 * (3 + planets);
        let masses = DVector::from_fn(size, |row, _| bodies[(row / 3).min(PLANET)][usize::from(row % 3 == 2)]);
        let mut gear = Self { masses, stiffness: DMatrix::zeros(size, size) };
        let [x, y, u] = [0, 1, 2];
        for body in [CARRIER, RING, SUN] {
            gear.spring(BEARING, &[(3 * body + x, 1.0)]);
            gear.spring(BEARING, &[(3 * body + y, 1.0)]);
        }
        gear.spring(torsion_of_the_ring, &[(3 * RING + u, 1.0)]);
        for i in 0..planets {
            let planet = 3 * (PLANET + i);
            let angle = TAU * i as f64 / planets as f64;
            let (sine, cosine) = alpha().sin_cos();
            // Lines of action of the external and the internal mesh.
            let (sun_line, ring_line) = ((angle - alpha()).sin_cos(), (angle + alpha()).sin_cos());
            gear.spring(
                MESH,
                &[
                    (3 * SUN + x, -sun_line.0),
                    (3 * SUN + y, sun_line.1),
                    (3 * SUN + u, 1.0),
                    (planet + x, -sine),
                    (planet + y, -cosine),
                    (planet + u, 1.0),
                ],
            );
            gear.spring(
                MESH,
                &[
                    (3 * RING + x, -ring_line.0),
                    (3 * RING + y, ring_line.1),
                    (3 * RING + u, 1.0),
                    (planet + x, sine),
                    (planet + y, -cosine),
                    (planet + u, -1.0),
                ],
            );
            // Bearing of the planet in the carrier, radial and tangential.
            let (radial, tangential) = (angle.cos(), angle.sin());
            gear.spring(BEARING, &[(3 * CARRIER + x, radial), (3 * CARRIER + y, tangential), (planet + x, -1.0)]);
            gear.spring(
                BEARING,
                &[
                    (3 * CARRIER + x, -tangential),
                    (3 * CARRIER + y, radial),
                    (3 * CARRIER + u, 1.0),
                    (planet + y, -1.0),
                ],
            );
        }
        gear
    }

    fn spring(&mut self, constant: f64, across: &[(usize, f64)]) {
        for (row, left) in across {
            for (column, right) in across {
                self.stiffness[(*row, *column)] += constant * left * right;
            }
        }
    }

    /// Natural frequencies in rising order [Hz].
    fn frequencies(&self) -> Vec<f64> {
        let roots = DMatrix::from_diagonal(&self.masses.map(|mass| 1.0 / mass.sqrt()));
        let squares = (&roots * &self.stiffness * &roots).symmetric_eigenvalues();
        let mut frequencies: Vec<f64> = squares.iter().map(|square| square.max(0.0).sqrt() / TAU).collect();
        frequencies.sort_by(f64::total_cmp);
        frequencies
    }

    /// Pure rotations: sun, planets, and the carrier with the planets' axes. The axes move along the tangent by u_c, of which a mesh
    /// deflects by the cosine; the planets' masses ride with the carrier.
    fn torsional_part(&self, planets: usize) -> Self {
        let mut shapes = DMatrix::zeros(self.masses.len(), planets + 2);
        shapes[(3 * SUN + 2, 0)] = 1.0;
        shapes[(3 * CARRIER + 2, planets + 1)] = 1.0;
        for i in 0..planets {
            shapes[(3 * (PLANET + i) + 2, 1 + i)] = 1.0;
            shapes[(3 * (PLANET + i) + 1, planets + 1)] = 1.0;
        }
        let masses = (shapes.transpose() * DMatrix::from_diagonal(&self.masses) * &shapes).diagonal();
        Self { masses, stiffness: shapes.transpose() * &self.stiffness * &shapes }
    }
}

/// Frequencies published for three planets [Hz]: six rotational modes, and six translational modes in pairs.
const ROTATIONAL: [f64; 6] = [0.0, 1475.7, 1930.3, 2658.3, 7462.8, 11775.3];
const TRANSLATIONAL: [f64; 6] = [743.2, 1102.4, 1896.0, 2276.4, 6986.3, 9647.9];
/// Planet modes with four and more planets [Hz].
const PLANET_MODES: [f64; 3] = [1808.2, 5963.8, 6981.7];

/// With Table 1 corrected the gear has the published frequencies.
#[test]
fn corrected_table_1_has_the_frequencies() {
    let mut published: Vec<f64> = ROTATIONAL.into_iter().chain(TRANSLATIONAL).chain(TRANSLATIONAL).collect();
    published.sort_by(f64::total_cmp);
    let found = Gear::new(3, BODIES, RING_TORSION).frequencies();
    assert_eq!(found.len(), published.len());
    for (found, published) in found.into_iter().zip(published) {
        PUBLISHED_FREQUENCY.check((found - published) / published.max(700.0));
    }
}

/// Carrier and ring as printed belong to another gear.
#[test]
fn printed_table_1_misses_the_frequencies() {
    let [carrier, ring, sun, planet] = BODIES;
    let lowest = Gear::new(3, [ring, carrier, sun, planet], RING_TORSION).frequencies()[1];
    assert!((lowest / 743.2 - 1.0).abs() > 0.02, "{lowest} Hz");
}

/// Four and five planets add one and two of each planet mode.
#[test]
fn more_planets_add_planet_modes() {
    for planets in [4, 5] {
        let found = Gear::new(planets, BODIES, RING_TORSION).frequencies();
        for published in PLANET_MODES {
            let near = found.iter().filter(|found| (**found / published - 1.0).abs() < PUBLISHED_FREQUENCY.limit);
            assert_eq!(near.count(), planets - 3, "{published} Hz with {planets} planets: {found:?}");
        }
    }
}

/// The project's model is this gear with stiff bearings and a fixed ring. Its carrier moves by u_c cos(alpha) along a mesh, which appears
/// as a mass over the square of the cosine.
#[test]
fn model_is_the_torsional_part() {
    for planets in 3..=5 {
        let found = Gear::new(planets, BODIES, 0.0).torsional_part(planets).frequencies();
        let mut joint = paper_joint(0.0, 0.0, 0.0, 0.0);
        joint.geometry.planets = planets;
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.mean_stiffness = MESH;
            mesh.half_backlash = same(planets, 0.0);
            mesh.transmission_error = same(planets, 0.0);
        }
        let expected = natural_frequencies(&joint);
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            TORSIONAL_PART.check((found - expected / TAU) / 1000.0);
        }
    }
}

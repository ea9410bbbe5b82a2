//! Matrices of the design against the paper's equations written out by hand, with the misprints corrected, and against eigenvalues from
//! closed forms.

use host_tests::tolerance;
use model_core::gears::Scales;
use model_core::gears::design::dynamics::Dynamics;
use model_core::gears::design::exponential::exponential_minus_identity;
use model_core::gears::design::hamiltonian;
use nalgebra::DMatrix;
use parameters::JointParameters;
use reference::scenarios;

/// The paper's joint with other masses, stiffnesses and number of planets; radii do not enter the relative equations.
fn joint(planets: usize) -> JointParameters {
    let mut joint = scenarios::paper_joint(0.0, 0.0, 0.0, 1.0);
    joint.geometry.planets = planets;
    joint.sun_planet.mean_stiffness = 0.7e8;
    joint.ring_planet.mean_stiffness = 1.3e8;
    joint.sun_planet.damping_ratio = 0.03;
    joint.ring_planet.damping_ratio = 0.11;
    joint.rotor_inertia = 3e-4;
    joint.link_inertia = 0.02;
    joint
}

/// Coefficients of K (or C) in eq. 19 for constant stiffness and no backlash, row by row as printed, with the sum over planets that is
/// missing in the second row's K_rp term.
fn printed(joint: &JointParameters, sun_planet: f64, ring_planet: f64) -> DMatrix<f64> {
    let planets = joint.geometry.planets;
    let sun = joint.bodies.sun_equivalent_mass + joint.rotor_inertia / joint.geometry.sun_base_radius.powi(2);
    let planet = joint.bodies.planet_equivalent_mass;
    let cosine = joint.geometry.working_pressure_angle.cos();
    let carrier = (joint.bodies.carrier_inertia_over_radius_squared + planets as f64 * joint.bodies.planet_mass)
        / cosine.powi(2)
        + joint.link_inertia / (joint.geometry.carrier_radius * cosine).powi(2);
    let mut matrix = DMatrix::zeros(planets + 1, planets + 1);
    for row in 0..planets {
        for column in 0..planets {
            // (1/Ms + 1/Mc) sum K_sp X_sp, and K_rp / Mc sum (X_sc - X_sp).
            matrix[(row, column)] += (1.0 / sun + 1.0 / carrier) * sun_planet - ring_planet / carrier;
            matrix[(row, planets)] += ring_planet / carrier;
        }
        // K_sp X_spi / Mp - K_rp (X_sc - X_spi) / Mp.
        matrix[(row, row)] += (sun_planet + ring_planet) / planet;
        matrix[(row, planets)] -= ring_planet / planet;
    }
    for column in 0..planets {
        matrix[(planets, column)] += (1.0 / sun + 2.0 / carrier) * sun_planet - 2.0 * ring_planet / carrier;
        matrix[(planets, planets)] += 2.0 * ring_planet / carrier;
    }
    matrix
}

fn largest(matrix: &DMatrix<f64>) -> f64 {
    matrix.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// Stiffness and damping matrices equal eq. 19 with its misprint corrected.
#[test]
fn matrices_equal_corrected_equation_19() {
    for planets in 3..=5 {
        let joint = joint(planets);
        let scales = Scales::new(&joint);
        let dynamics = Dynamics::new(&joint, &scales);
        let square = scales.frequency.powi(2);
        let stiffness = printed(&joint, 0.7e8 / square, 1.3e8 / square);
        let own_sun = joint.bodies.sun_equivalent_mass;
        let planet = joint.bodies.planet_equivalent_mass;
        let reduced = 1.0 / (1.0 / own_sun + 1.0 / planet);
        let sun_planet = 2.0 * 0.03 * (0.7e8_f64 * reduced).sqrt();
        let ring_planet = 2.0 * 0.11 * (1.3e8_f64 * planet).sqrt();
        let damping = printed(&joint, sun_planet / scales.frequency, ring_planet / scales.frequency);
        tolerance::DERIVATION.check(largest(&(&dynamics.stiffness - stiffness)));
        tolerance::DERIVATION.check(largest(&(&dynamics.damping - damping)));
    }
}

/// The printed second row would couple the rigid body: the derivation has a sum over planets there.
#[test]
fn printed_row_couples_the_rigid_body() {
    // The printed row two takes K_rp of one planet: for three planets a third of the derived value.
    let joint = joint(3);
    let dynamics = Dynamics::new(&joint, &Scales::new(&joint));
    let one_planet = dynamics.stiffness[(3, 3)] / 3.0;
    assert!((dynamics.stiffness[(3, 3)] - one_planet).abs() > 0.1 * one_planet);
}

/// The Hamiltonian form has the same flow as positions and rates.
#[test]
fn hamiltonian_flow_equals_direct_flow() {
    let joint = joint(3);
    let dynamics = Dynamics::new(&joint, &Scales::new(&joint));
    let size = dynamics.coordinates();
    let mut direct = DMatrix::zeros(2 * size, 2 * size);
    direct.view_mut((0, size), (size, size)).copy_from(&DMatrix::identity(size, size));
    direct.view_mut((size, 0), (size, size)).copy_from(&-&dynamics.stiffness);
    direct.view_mut((size, size), (size, size)).copy_from(&-&dynamics.damping);
    let (forward, backward) = hamiltonian::from_rates(&dynamics);
    let hamiltonian = exponential_minus_identity(&hamiltonian::matrix(&dynamics), 1.3);
    let back = &backward * hamiltonian * &forward;
    // nalgebra's exponential is an independent method.
    let expected = (direct * 1.3).exp() - DMatrix::identity(2 * size, 2 * size);
    tolerance::FLOW.check(largest(&(back - expected)));
}

/// Oracle 2: damped eigenvalues of the paper's joint without backlash and ripple.
#[test]
fn paper_joint_has_known_eigenvalues() {
    let joint = scenarios::paper_joint(0.0, 0.0, 0.0, 1.0);
    let dynamics = Dynamics::new(&joint, &Scales::new(&joint));
    let mut found: Vec<(f64, f64)> = hamiltonian::matrix(&dynamics)
        .complex_eigenvalues()
        .iter()
        .filter(|value| value.im > 0.0)
        .map(|value| (value.re, value.im))
        .collect();
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    let known = [(-0.032282, 0.637513), (-0.050725, 0.881718), (-0.050725, 0.881718), (-0.119223, 1.526734)];
    assert_eq!(found.len(), known.len());
    for (found, known) in found.iter().zip(known) {
        tolerance::PRINTED_EIGENVALUE.check((found.0 - known.0).hypot(found.1 - known.1));
    }
}

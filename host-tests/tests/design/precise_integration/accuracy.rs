//! Errors against 50 digits: |E found - E| / max(1, |E|) in units of u max(1, |A h|), u = 2^-53, where norms are largest column sums. Speed
//! is not tested.

use host_tests::tolerance::{DERIVATION, NALGEBRA_EXPONENTIAL, PRECISE_INTEGRALS, PRECISE_INTEGRATION};
use model_core::gears::Scales;
use model_core::gears::design::dynamics::Dynamics;
use model_core::gears::design::exponential::{exponential_minus_identity, flow, norm};
use model_core::gears::design::hamiltonian;
use nalgebra::DMatrix;
use reference::scenarios::{paper_joint, q1, same};

use super::fixtures::{Expected, Fixture, models, others};

/// Unit roundoff u of an f64.
const UNIT: f64 = 1.0 / 9_007_199_254_740_992.0;

/// |E found - E| / max(1, |E|), over u max(1, |A h|).
fn units(found: &DMatrix<f64>, fixture: &Fixture, expected: &Expected) -> f64 {
    let error = norm(&(found - &expected.transition)) / norm(&expected.transition).max(1.0);
    error / (UNIT * (norm(&fixture.matrix) * expected.step).max(1.0))
}

fn for_each_step(fixtures: Vec<Fixture>, check: impl Fn(&Fixture, &Expected)) {
    for fixture in &fixtures {
        for expected in &fixture.steps {
            check(fixture, expected);
        }
    }
}

fn all() -> Vec<Fixture> {
    models().into_iter().chain(others()).collect()
}

/// Increments are accurate to 50 digits' fixtures, in units of rounding.
#[test]
fn increments_match_fifty_digits() {
    for_each_step(all(), |fixture, expected| {
        let found = exponential_minus_identity(&fixture.matrix, expected.step);
        print!("{} at {}: ", fixture.name, expected.step);
        PRECISE_INTEGRATION.check(units(&found, fixture, expected));
    });
}

/// The flow has the same increment, and input integrals accurate to the fixtures.
#[test]
fn flow_matches_fifty_digits() {
    for_each_step(all(), |fixture, expected| {
        let found = flow(&fixture.matrix, &fixture.inputs, expected.step, 3);
        print!("{} at {}: ", fixture.name, expected.step);
        PRECISE_INTEGRATION.check(units(&found.transition, fixture, expected));
        let reach = (norm(&fixture.matrix) * expected.step).max(1.0);
        for (power, (found, exact)) in found.input_integrals.iter().zip(&expected.integrals).enumerate() {
            // Integrals have a scale of their own: h |B| for a matrix of zeros.
            let size = norm(exact).max(expected.step * norm(&fixture.inputs));
            print!("  power {power}: ");
            PRECISE_INTEGRALS.check(norm(&(found - exact)) / size / (UNIT * reach));
        }
    });
}

/// nalgebra's exponential is an independent method: the distance between both is at most nalgebra's own error plus the bound.
#[test]
fn nalgebra_differs_by_its_own_error() {
    for_each_step(all(), |fixture, expected| {
        let theirs = (&fixture.matrix * expected.step).exp();
        let theirs = &theirs - DMatrix::identity(theirs.nrows(), theirs.ncols());
        let ours = exponential_minus_identity(&fixture.matrix, expected.step);
        let their_error = units(&theirs, fixture, expected);
        print!("{} at {}: nalgebra's own error {their_error:.2}: ", fixture.name, expected.step);
        let apart = units(&(&ours - &theirs + &expected.transition), fixture, expected);
        NALGEBRA_EXPONENTIAL.check(apart - their_error);
    });
}

/// The fixtures' matrices are the model's, so that they test the model.
#[test]
fn fixtures_hold_matrices_of_equation_20() {
    let paper = paper_joint(0.0, 0.0, 0.0, 1.0);
    let of_both = [paper, q1()];
    let joints = of_both.iter().flat_map(|joint| (3..=5).map(move |planets| (joint.clone(), planets)));
    let fixtures = models();
    assert_eq!(fixtures.len(), 6);
    for (fixture, (mut joint, planets)) in fixtures.iter().zip(joints) {
        joint.geometry.planets = planets;
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.half_backlash = same(planets, 0.0);
            mesh.transmission_error = same(planets, 0.0);
        }
        let dynamics = Dynamics::new(&joint, &Scales::new(&joint));
        let size = dynamics.coordinates();
        DERIVATION.check(norm(&(hamiltonian::matrix(&dynamics) - &fixture.matrix)));
        DERIVATION.check((fixture.inputs.view((size, 0), (size, 1)) - dynamics.mesh_gain.column(0)).norm());
        let sun = fixture.inputs.view((size, 1), (size, 1)).into_owned();
        DERIVATION.check((sun - dynamics.torque_gain.column(0) * dynamics.mobilities[0]).norm());
    }
}

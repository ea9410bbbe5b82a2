//! Libraries solve the joint's own equations: their Jacobian is the derivative of the right-hand side, and each converges to the
//! reference's motion with its tolerance. Times are not tested.
#![cfg(feature = "libraries")]

use comparison::catalogue::cases;
use comparison::curve::PhaseEnvelope;
use comparison::libraries::{Equations, Library};
use model_core::gears::Scales;

fn envelope(key: &str) -> PhaseEnvelope {
    let case = cases().into_iter().find(|case| case.key == key).expect("a case of the catalogue");
    PhaseEnvelope::new(case, 1).expect("the reference follows")
}

/// The Jacobian equals the numerical derivative of the rates.
#[test]
fn jacobian_is_derivative_of_rates() {
    let envelope = envelope("A");
    let equations: Equations<3, 8> = Equations::new(&envelope.case).expect("a case that libraries can take");
    let state = [6.5, 5.0, 7.5, 13.0, 0.3, -0.2, 0.1, 0.4];
    let (time, small) = (1.7, 1e-6);
    for entry in 0..8 {
        let (mut above, mut below, mut direction) = (state, state, [0.0; 8]);
        above[entry] += small;
        below[entry] -= small;
        direction[entry] = 1.0;
        let [mut high, mut low, mut product] = [[0.0; 8]; 3];
        equations.rates(time, &above, &mut high);
        equations.rates(time, &below, &mut low);
        equations.jacobian_times(time, &state, &direction, &mut product);
        for row in 0..8 {
            let difference = (high[row] - low[row]) / (2.0 * small);
            assert!((difference - product[row]).abs() < 1e-8, "entry {entry}, row {row}");
        }
    }
}

/// Every library converges to the reference's motion.
#[test]
fn libraries_converge_to_the_reference() {
    let envelope = envelope("A");
    let case = &envelope.case;
    let equations: Equations<3, 8> = Equations::new(case).expect("a case that libraries can take");
    let frequency = Scales::new(&case.joint).frequency;
    let times: Vec<f64> = (0..envelope.trajectory().samples().len())
        .map(|k| k as f64 / f64::from(case.sample_rate) * frequency)
        .collect();
    for &library in Library::ALL {
        let error = |tolerance: f64| {
            let states = library.solve(&equations, &times, tolerance).expect("a solution");
            let readings = states.iter().zip(&times).map(|(state, time)| equations.read(*time, state));
            envelope.trajectory().errors(&readings.enumerate().collect::<Vec<_>>()).deflections
        };
        let (loose, tight) = (error(1e-3), error(1e-6));
        assert!(tight < 1e-3 && tight < 0.1 * loose, "{}: {loose:.1e}, {tight:.1e}", library.name());
    }
}

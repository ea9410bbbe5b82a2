//! Tests of the noise of a rest, estimated from innovations (O13).

use crate::gears::Flank;
use crate::observer::identification::least_squares::LeastSquares;
use crate::observer::identification::regressors::MAPPED;
use crate::observer::identification::uncertainty::Uncertainty;
use crate::observer::test_tables::q1;

fn uncertainty() -> Uncertainty<f64> {
    let tables = q1();
    let (mut least_squares, mut uncertainty) = (LeastSquares::<_, MAPPED>::UNINITIALIZED, Uncertainty::uninitialized());
    least_squares.reset(&tables.learner);
    uncertainty.reset(&tables, &least_squares);
    uncertainty
}

/// Takes rests on alternate flanks with a deflection error of `deviations` standard deviations of the encoder noise.
/// The sign changes after every `period` rests.
fn add_dwells(uncertainty: &mut Uncertainty<f64>, rests: usize, deviations: f64, period: usize) {
    for rest in 0..rests {
        let flank = if rest.is_multiple_of(2) { Flank::Drive } else { Flank::Back };
        let sign = if (rest / period).is_multiple_of(2) { 1.0 } else { -1.0 };
        uncertainty.adapt_dwell_noise(sign * deviations / uncertainty.dwell_deviation, 1.0, flank);
    }
}

#[test]
fn dwell_noise_stays_while_dwells_fit() {
    let mut uncertainty = uncertainty();
    add_dwells(&mut uncertainty, 1000, 0.9, 2);
    assert_eq!(uncertainty.dwell_deviation, 1.0);
}

#[test]
fn dwell_noise_follows_innovations() {
    let mut uncertainty = uncertainty();
    add_dwells(&mut uncertainty, 200, 4.0, 2);
    assert!((uncertainty.dwell_deviation - 4.0).abs() < 0.2, "{}", uncertainty.dwell_deviation);
    add_dwells(&mut uncertainty, 200, 1.0, 2);
    assert!(uncertainty.dwell_deviation < 1.05, "{}", uncertainty.dwell_deviation);
}

#[test]
fn half_gap_change_needs_both_flanks() {
    let mut wider = uncertainty();
    add_dwells(&mut wider, 40, 4.0, 1);
    assert!(wider.detect_half_gap_change());
    assert!(!wider.detect_half_gap_change(), "it has begun anew");
    // Innovations of one sign on both flanks show another offset.
    let mut offset = uncertainty();
    add_dwells(&mut offset, 40, 4.0, 40);
    assert!(!offset.detect_half_gap_change());
}

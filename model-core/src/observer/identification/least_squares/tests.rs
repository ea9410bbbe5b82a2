//! Limits of the estimated parameters, and variances after a reset.

use super::super::regressors::{COMPLIANCE, HALF_GAP, OFFSET, PLAIN};
use super::{Innovation, LeastSquares};
use crate::observer::test_tables::{learner as table, observer};

#[test]
fn parameters_but_offset_are_limited() {
    let table = table();
    // 16 initial deviations of 1e-3.
    let furthest = 16e-3;
    for parameter in 0..PLAIN {
        let mut least_squares = LeastSquares::<f32, PLAIN>::UNINITIALIZED;
        least_squares.reset(&table);
        let mut regressors = [0.0; PLAIN];
        regressors[parameter] = 1.0;
        let innovation = least_squares.innovation(&table, &regressors, 1.0, table.weight);
        least_squares.update(&table, &innovation);
        let value = least_squares.value(parameter);
        if parameter == OFFSET {
            assert!((value - 1.0).abs() < 1e-3, "an offset may be any: {value}");
        } else {
            assert!((value - furthest).abs() < 1e-6 * furthest, "parameter {parameter}: {value}");
        }
    }
}

#[test]
fn parameter_within_limit_is_accepted() {
    let table = table();
    let mut least_squares = LeastSquares::<f32, PLAIN>::UNINITIALIZED;
    least_squares.reset(&table);
    let mut regressors = [0.0; PLAIN];
    regressors[COMPLIANCE] = 2.0;
    let innovation = least_squares.innovation(&table, &regressors, 8e-3, table.weight);
    least_squares.update(&table, &innovation);
    assert!((least_squares.value(COMPLIANCE) - 4e-3).abs() < 1e-6);
}

#[test]
fn half_gap_keeps_variance_without_positions() {
    // A single flank shows the sum of half-gap and offset: half of either variance remains.
    let table = table();
    let mut least_squares = LeastSquares::<f32, PLAIN>::UNINITIALIZED;
    least_squares.reset(&table);
    let mut regressors = [0.0; PLAIN];
    (regressors[HALF_GAP], regressors[OFFSET]) = (1.0, 1.0);
    let innovation = least_squares.innovation(&table, &regressors, 0.0, table.weight);
    least_squares.update(&table, &innovation);
    least_squares.reset_position_variances();
    let [half_gap, offset] = [HALF_GAP, OFFSET].map(|parameter| least_squares.relative_variance(parameter));
    assert!((half_gap - 0.5).abs() < 1e-3, "{half_gap}");
    assert_eq!(offset, 1.0);
}

/// Least squares after an exact measurement of one parameter.
fn measured(parameter: usize, value: f32) -> LeastSquares<f32, PLAIN> {
    let table = table();
    let mut least_squares = LeastSquares::UNINITIALIZED;
    least_squares.reset(&table);
    let mut regressors = [0.0; PLAIN];
    regressors[parameter] = 1.0;
    let innovation = least_squares.innovation(&table, &regressors, value, table.weight);
    least_squares.update(&table, &innovation);
    least_squares
}

#[test]
fn negative_half_gap_is_limited_to_zero() {
    assert_eq!(measured(HALF_GAP, -1e-3).value(HALF_GAP), 0.0);
}

#[test]
fn update_reduces_variance_of_measured_parameter() {
    let least_squares = measured(COMPLIANCE, 1e-3);
    assert!(least_squares.relative_variance(COMPLIANCE) < 1e-5);
    assert_eq!(least_squares.relative_variance(HALF_GAP), 1.0);
}

#[test]
fn inflation_ends_at_initial_variance() {
    let mut least_squares = measured(COMPLIANCE, 1e-3);
    let before = least_squares.relative_variance(COMPLIANCE);
    least_squares.inflate(0.5);
    assert!((least_squares.relative_variance(COMPLIANCE) / before - 1.5).abs() < 1e-5);
    (0..100).for_each(|_| least_squares.inflate(0.5));
    assert_eq!(least_squares.relative_variance(COMPLIANCE), 1.0);
}

#[test]
fn inflated_half_gap_ends_at_initial_variance() {
    let table = table();
    let mut least_squares = measured(HALF_GAP, 2e-3);
    least_squares.inflate_half_gap(&table, 0.125);
    let variance = least_squares.relative_variance(HALF_GAP);
    assert!((variance - 0.0625).abs() < 1e-3, "(0.125 x 2 deviations)^2: {variance}");
    least_squares.inflate_half_gap(&table, 0.6);
    assert_eq!(least_squares.relative_variance(HALF_GAP), 1.0);
}

#[test]
fn reset_of_half_gap_keeps_other_variances() {
    let mut least_squares = measured(COMPLIANCE, 1e-3);
    let compliance = least_squares.relative_variance(COMPLIANCE);
    least_squares.set_relative_variance(HALF_GAP, 0.1);
    least_squares.reset_half_gap_variance();
    assert_eq!(least_squares.relative_variance(HALF_GAP), 1.0);
    assert_eq!(least_squares.relative_variance(COMPLIANCE), compliance);
}

#[test]
fn motor_slip_keeps_half_gap_variance() {
    let table = table();
    let mut least_squares = LeastSquares::<f32, PLAIN>::UNINITIALIZED;
    least_squares.reset(&table);
    let mut regressors = [0.0; PLAIN];
    (regressors[HALF_GAP], regressors[OFFSET]) = (1.0, 1.0);
    let innovation = least_squares.innovation(&table, &regressors, 0.0, table.weight);
    least_squares.update(&table, &innovation);
    let before = least_squares.relative_variance(HALF_GAP);
    least_squares.reset_motor_variances();
    assert!((least_squares.relative_variance(HALF_GAP) - before).abs() < 1e-6);
    assert_eq!(least_squares.relative_variance(OFFSET), 1.0);
}

#[test]
fn innovation_is_compared_with_its_deviation() {
    let innovation = Innovation::<f32, PLAIN> { projected: [0.0; PLAIN], value: 9.9, variance: 4.0 };
    assert!(innovation.is_within(5));
    assert!(!Innovation { value: -10.1, ..innovation }.is_within(5));
    assert!(!Innovation { value: f32::NAN, ..innovation }.is_within(5));
}

#[test]
fn factor_of_1000_is_in_range() {
    let tables = observer();
    let is_in_range = |factor| {
        let mut least_squares = LeastSquares::<f32, PLAIN>::UNINITIALIZED;
        least_squares.reset(&tables.learner);
        least_squares.factors[OFFSET][HALF_GAP] = factor;
        least_squares.is_in_range(&tables)
    };
    assert!(is_in_range(999.0) && is_in_range(-999.0));
    assert!(!is_in_range(1001.0) && !is_in_range(-1001.0) && !is_in_range(f32::NAN));
}

//! Limits of the estimated parameters, and variances after a reset.

use super::super::regressors::{COMPLIANCE, HALF_GAP, OFFSET, PLAIN};
use super::super::thresholds::LEAST_SQUARES;
use super::LeastSquares;
use crate::observer::tables::{LearnerTable, MOST_PARAMETERS};

const DEVIATION: f32 = 1e-3;

fn table() -> LearnerTable<f32> {
    LearnerTable {
        periods: 10,
        per_periods: 0.1,
        middle: 5,
        block: 8,
        per_block: 0.125,
        span: 1e-3,
        mean: [0.0; MOST_PARAMETERS],
        deviation: [DEVIATION; MOST_PARAMETERS],
        weight: 1e6,
        noise: 1e-6,
        force_noise: 1.0,
        force_lag: 0.0,
        forgetting: 0.0,
        mesh_compliance: 0.0,
    }
}

#[test]
fn nothing_but_an_offset_is_believed_beyond_what_can_be() {
    let table = table();
    let furthest = LEAST_SQUARES.max_deviation as f32 * DEVIATION;
    for parameter in 0..PLAIN {
        let mut least_squares = LeastSquares::<f32, PLAIN>::uninitialized();
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
fn what_can_be_is_believed() {
    let table = table();
    let mut least_squares = LeastSquares::<f32, PLAIN>::uninitialized();
    least_squares.reset(&table);
    let mut regressors = [0.0; PLAIN];
    regressors[COMPLIANCE] = 2.0;
    let innovation = least_squares.innovation(&table, &regressors, 8e-3, table.weight);
    least_squares.update(&table, &innovation);
    assert!((least_squares.value(COMPLIANCE) - 4e-3).abs() < 1e-6);
}

#[test]
fn half_gap_keeps_its_variance_without_places() {
    // A single flank shows the sum of half-gap and offset: half of either variance remains.
    let table = table();
    let mut least_squares = LeastSquares::<f32, PLAIN>::uninitialized();
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

//! Precise integration against closed forms that share nothing with it.

use model_core::gears::design::exponential::{REMAINDER, ScalingPlan, exponential_minus_identity, flow};
use nalgebra::DMatrix;

fn square(rows: &[f64]) -> DMatrix<f64> {
    let size = rows.len().isqrt();
    DMatrix::from_row_slice(size, size, rows)
}

fn largest(matrix: &DMatrix<f64>) -> f64 {
    matrix.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

#[test]
fn a_rotation_comes_out_at_any_step() {
    for angle in [1e-9, 1e-3, 0.1, 1.0, 20.5, 300.0_f64] {
        let increment = exponential_minus_identity(&square(&[0.0, 1.0, -1.0, 0.0]), angle);
        // cos(a) - 1 without cancellation.
        let shrink = -2.0 * (0.5 * angle).sin().powi(2);
        let exact = square(&[shrink, angle.sin(), -angle.sin(), shrink]);
        let error = largest(&(&increment - &exact));
        assert!(error < 20.0 * 1.2e-16 * angle.max(1.0), "off by {error:e} at {angle}");
    }
}

#[test]
fn small_increments_keep_all_their_digits() {
    let step = 1e-9;
    let increment = exponential_minus_identity(&square(&[0.0, 1.0, -1.0, 0.0]), step);
    let exact = -0.5 * step * step;
    assert!(((increment[(0, 0)] - exact) / exact).abs() < 1e-15);
    // What squaring I + E would have left of it: nothing.
    assert_eq!(1.0 + exact, 1.0);
}

#[test]
fn a_defective_matrix_comes_out() {
    let rate = -0.7_f64;
    let step = 3.0;
    let increment = exponential_minus_identity(&square(&[rate, 1.0, 0.0, rate]), step);
    let decay = (rate * step).exp();
    let exact = square(&[decay - 1.0, step * decay, 0.0, decay - 1.0]);
    assert!(largest(&(increment - exact)) < 1e-15);
}

#[test]
fn input_integrals_are_those_of_powers_of_time() {
    // v' = a v + (s/h)^k with a = 0 gives h / (k + 1); with a != 0 the k = 0 integral is (e^(a h) - 1) / a.
    let still = flow(&square(&[0.0]), &square(&[1.0]), 2.5, 3);
    for (power, integral) in still.input_integrals.iter().enumerate() {
        assert!((integral[(0, 0)] - 2.5 / (power as f64 + 1.0)).abs() < 1e-15);
    }
    let (rate, step) = (-1.3_f64, 0.8);
    let decaying = flow(&square(&[rate]), &square(&[1.0]), step, 2);
    let grown = (rate * step).exp_m1();
    assert!((decaying.input_integrals[0][(0, 0)] - grown / rate).abs() < 1e-15);
    // Integral of e^(a (h - s)) s / h by parts: ((e^(a h) - 1) / a - h) / (a h).
    let exact = (grown / rate - step) / (rate * step);
    assert!((decaying.input_integrals[1][(0, 0)] - exact).abs() < 1e-15);
}

#[test]
fn the_plan_neither_over_nor_undershoots() {
    for norm in [0.0, 1e-6, 0.125, 0.1251, 1.0, 7.9, 1e3] {
        let plan = ScalingPlan::new(norm);
        let start = norm / f64::from(2_u32.pow(plan.doublings));
        assert!(start <= 0.125, "series starts at {start}");
        assert!(plan.doublings == 0 || start > 0.0625, "{} doublings for {norm}", plan.doublings);
        // First term left out, relative to the leading one.
        let left_out = (2..=plan.terms + 1).fold(1.0, |term, k| term * start / f64::from(k));
        assert!(left_out <= REMAINDER, "leaves {left_out:e} at norm {norm}");
        let one_less = (2..=plan.terms).fold(1.0, |term, k| term * start / f64::from(k));
        assert!(plan.terms == 1 || one_less > 0.9 * REMAINDER, "one term too many at norm {norm}");
    }
}

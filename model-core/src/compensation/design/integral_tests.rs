//! Tests of the integral under the motor's limit.

use crate::compensation::integral::Integral;
use crate::compensation::tables::CompensationTables;
use crate::compensation::test_bench::q1 as tables;

/// Returns an integral whose torque has swung from limit to limit.
fn swinging(tables: &CompensationTables<f32>) -> Integral<f32> {
    let mut integral = Integral::new();
    integral.detect_swing(tables, tables.limits.motor, 1.0);
    integral.detect_swing(tables, -tables.limits.motor, 1.0);
    assert!(integral.swings());
    integral
}

#[test]
fn swinging_integral_is_held_under_the_limit() {
    let tables = tables();
    let mut integral = swinging(&tables);
    for cut in [-1.0, 1.0] {
        integral.integrate(&tables, 1e-3, cut);
        assert_eq!(integral.torque(), 0.0);
    }
    integral.integrate(&tables, 1e-3, 0.0);
    assert!(integral.torque() < 0.0, "{}", integral.torque());
}

#[test]
fn steady_integral_gives_back_the_cut_torque() {
    let tables = tables();
    let mut integral = Integral::new();
    integral.integrate(&tables, 0.0, -1.0);
    assert!(integral.torque() < 0.0, "{}", integral.torque());
}

//! Tests of the demand estimated from the torque of a joint whose data sheet states the friction.

use crate::compensation::demand_estimator::DemandEstimator;
use crate::compensation::set_point::Motion;
use crate::compensation::tables::CompensationTables;
use crate::compensation::test_bench::q1 as tables;

/// Returns tables with a dry friction of motor and link on the data sheet [N m at the link].
fn with_friction(motor: f32, link: f32) -> CompensationTables<f32> {
    let mut tables = tables();
    tables.load.frictions = [motor, link];
    tables
}

/// Returns the demand over the pressing torque after 2 s of motion in positive direction, as the motion continues and
/// as it reverses; the torque moves a joint with a friction and a load.
fn pressing(tables: &CompensationTables<f32>, friction: f32, load: f32) -> [f32; 2] {
    let mut demand = DemandEstimator::new(tables);
    let at = |speed: f32| Motion { speed, ..Motion::default() };
    let periods = 2.0 * tables.clock.rate / 3.0;
    for _ in 0..periods as u32 {
        demand.plan(tables, &at(0.2)).expect("a number");
        demand.estimate(tables, friction + load);
    }
    [0.2, -0.2].map(|speed| demand.plan(tables, &at(speed)).expect("a number"))
}

#[test]
fn friction_seen_one_way_reverses_with_the_motion() {
    // The real friction is a third above the data sheet.
    let [on, back] = pressing(&with_friction(0.3, 1.0), 1.7, 0.2);
    assert!(on > 1.0 && back < 0.0, "{on} on the way, {back} after it");
}

#[test]
fn weight_beyond_the_friction_keeps_its_flank() {
    let [on, back] = pressing(&with_friction(0.3, 1.0), 1.3, 4.0);
    assert!(on > 1.0 && back > 0.0, "{on} on the way, {back} after it");
}

#[test]
fn load_that_may_be_friction_presses_no_flank() {
    // The data sheet states no friction.
    let [on, back] = pressing(&with_friction(0.0, 0.0), 0.2, 0.2);
    assert!(on > 1.0 && back.abs() < 1.0, "{on} on the way, {back} after it");
}

#[test]
fn torque_of_the_motor_alone_is_not_transmitted() {
    let tables = with_friction(0.0, 0.0);
    let now = Motion { acceleration: 20.0, ..Motion::default() };
    let [alone, both] = [0.0, tables.body.load_inertia].map(|load| {
        let mut demand = DemandEstimator::new(&tables);
        for _ in 0..3000 {
            demand.plan(&tables, &now).expect("a number");
            demand.estimate(&tables, (tables.body.motor_inertia + load) * now.acceleration);
        }
        // The inertia is estimated as well: a fresh instance gives the demand of the designed inertia.
        let mut fresh = DemandEstimator::new(&tables);
        fresh.plan(&tables, &now).expect("a number");
        (demand.is_transmitted(), fresh.torque())
    });
    assert!(!alone.0, "a motor in the open gap counts as pressing {} N m", alone.1);
    assert!(both.0, "teeth that pass {} N m count as open", both.1);
}

//! Tests of the detector of a swinging load, with designed tables.

use core::f32::consts::TAU;

use crate::compensation::payload_swing::PayloadSwing;
use crate::compensation::test_bench::q1 as tables;

/// Returns true if a load, a function of time and of the uncertainty of measured torques, swings or may swing after 3
/// s.
fn may_swing(load: impl Fn(f32, f32) -> f32) -> bool {
    let tables = tables();
    let mut swing = PayloadSwing::new();
    for period in 0..(3.0 * tables.clock.rate) as u32 {
        let time = period as f32 * tables.clock.period;
        swing.update(&tables, Some(load(time, tables.switching.measured)));
    }
    // Within that time it is certain whether the load swings.
    assert_eq!(swing.may_swing(), swing.swings());
    swing.may_swing()
}

#[test]
fn payload_on_a_flexible_arm_swings() {
    for frequency in [8.0, 12.0, 25.0] {
        assert!(may_swing(|time, uncertain| 4.0 * uncertain * (TAU * frequency * time).sin()), "{frequency} Hz");
    }
}

#[test]
fn motion_and_steady_load_do_not_swing() {
    assert!(!may_swing(|_, uncertain| 10.0 * uncertain));
    assert!(!may_swing(|time, uncertain| 20.0 * uncertain * (TAU * 2.0 * time).sin()), "2 Hz");
}

#[test]
fn push_each_half_second_does_not_swing() {
    assert!(!may_swing(|time, uncertain| if time % 0.5 < 0.1 { 20.0 * uncertain } else { 0.0 }));
}

#[test]
fn load_within_the_uncertainty_does_not_swing() {
    assert!(!may_swing(|time, uncertain| 0.8 * uncertain * (TAU * 12.0 * time).sin()));
}

#[test]
fn unknown_load_may_swing_until_it_is_measured() {
    let tables = tables();
    let mut swing = PayloadSwing::new();
    (0..100_000).for_each(|_| swing.update(&tables, None));
    assert!(swing.may_swing() && !swing.swings());
    swing.update(&tables, Some(f32::NAN));
    (0..20_000).for_each(|_| swing.update(&tables, Some(0.0)));
    assert!(!swing.may_swing());
}

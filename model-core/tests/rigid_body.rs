//! The rigid body in whole numbers: exact over any number of turns, in both directions.

use model_core::gears::RigidBody;
use model_core::gears::tables::Rigid;

const TURN: f32 = 18_446_744_073_709_551_616.0;

fn table() -> Rigid<f32> {
    // An eighth of a turn a tick, each tick, for a unit of drive torque; half of that for a unit of load torque.
    Rigid { drive: TURN / 8.0, load: TURN / 16.0 }
}

fn turns(body: &RigidBody) -> f64 {
    f64::from(body.turns) + body.fraction as f64 / f64::from(TURN)
}

#[test]
fn constant_torque_gives_a_parabola_and_back() {
    let mut body = RigidBody::REST;
    body.advance(&table(), 1.0, 0.0);
    body.advance(&table(), 1.0, 0.0);
    assert_eq!(turns(&body), 0.25);
    body.advance(&table(), 0.0, 4.0);
    body.advance(&table(), 0.0, 0.0);
    assert_eq!(body.speed, 0);
    assert_eq!(turns(&body), 0.375);
}

#[test]
fn turns_are_counted_both_ways_and_wrap_exactly() {
    let mut body = RigidBody { turns: 0, fraction: 0, speed: -(1 << 61) };
    for tick in 1..=1_000_000_i64 {
        body.advance(&table(), 0.0, 0.0);
        if tick % 8 == 0 {
            assert_eq!((i64::from(body.turns), body.fraction), (-tick / 8, 0));
        }
    }
    body.speed = 1 << 61;
    for _ in 0..1_000_000 {
        body.advance(&table(), 0.0, 0.0);
    }
    assert_eq!((body.turns, body.fraction), (0, 0));
}

#[test]
fn absurd_torques_saturate_instead_of_wrapping() {
    let mut body = RigidBody::REST;
    for torque in [f32::MAX, f32::INFINITY] {
        for _ in 0..10 {
            body.advance(&table(), torque, 0.0);
        }
        assert_eq!(body.speed, i64::MAX);
    }
    body.advance(&table(), f32::NAN, 0.0);
    assert_eq!(body.speed, i64::MAX);
}

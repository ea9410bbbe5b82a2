//! Every method converges to the reference with its own order, as a fair rival must. Bounds follow from the methods' theory.

use comparison::case::Case;
use comparison::catalogue::cases;
use comparison::curve::{PhaseEnvelope, Scalar};
use comparison::method::Method;
use comparison::trajectory::Errors;
use parameters::StiffnessWave;
use reference::joint::Start;

fn named(key: &str) -> Case {
    cases().into_iter().find(|case| case.key == key).expect("a case of the catalogue")
}

fn envelope(key: &str) -> PhaseEnvelope {
    PhaseEnvelope::new(named(key), 1).expect("the reference follows")
}

fn error(envelope: &PhaseEnvelope, method: Method, rate: u32) -> f64 {
    envelope.point(method, Scalar::Double, rate, 1).expect("a sound joint").errors.deflections
}

/// Slope of log error over log step between two rates.
fn order(envelope: &PhaseEnvelope, method: Method, rates: [u32; 2]) -> f64 {
    let [coarse, fine] = rates.map(|rate| error(envelope, method, rate));
    (coarse / fine).ln() / (f64::from(rates[1]) / f64::from(rates[0])).ln()
}

/// Runge-Kutta is of fourth order in contact.
#[test]
fn runge_kutta_is_of_fourth_order() {
    let order = order(&envelope("Q"), Method::RungeKutta4, [40_000, 160_000]);
    assert!((order - 4.0).abs() < 0.3, "{order}");
}

/// The trapezoid is of second order and Euler of first in contact.
#[test]
fn trapezoid_and_euler_have_their_orders() {
    let envelope = envelope("Q");
    let trapezoid = order(&envelope, Method::Trapezoid, [80_000, 320_000]);
    let euler = order(&envelope, Method::Euler, [80_000, 320_000]);
    assert!((trapezoid - 2.0).abs() < 0.2, "{trapezoid}");
    assert!((euler - 1.0).abs() < 0.2, "{euler}");
}

/// The paper's scheme is of first order, and exact where nothing varies.
#[test]
fn paper_scheme_is_of_first_order() {
    let varying = order(&envelope("Q"), Method::PaperEtd1, [80_000, 320_000]);
    assert!((varying - 1.0).abs() < 0.1, "{varying}");
    let mut still = named("Q");
    for mesh in [&mut still.joint.sun_planet, &mut still.joint.ring_planet] {
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.0 };
        mesh.transmission_error.iter_mut().for_each(|error| *error = 0.0);
    }
    // A displaced start, so that there is a motion to follow.
    let Start::Relative(start) = &mut still.start else { panic!("a case states its start") };
    start.gap *= 0.97;
    still.counts_from = 0.0;
    let error = error(&PhaseEnvelope::new(still, 1).unwrap(), Method::PaperEtd1, 20_000);
    assert!(error < 1e-9, "{error:.1e}");
}

/// All methods with meshes converge to the reference's motion through kinks.
#[test]
fn methods_converge_through_kinks() {
    for key in ["A", "B", "F", "L"] {
        let envelope = envelope(key);
        for (method, greatest) in [
            (Method::Realtime, 1e-3),
            (Method::RungeKutta4, 1e-2),
            (Method::RungeKutta4Tanh, 2e-2),
            (Method::Trapezoid, 2e-2),
            (Method::Euler, 5e-2),
            (Method::PaperEtd1, 0.1),
        ] {
            let error = error(&envelope, method, 320_000);
            assert!(error < greatest, "case {key}, {}: {error:.1e}", method.name());
        }
    }
}

/// Single precision adds at most a few millionths to the error.
#[test]
fn single_precision_adds_millionths() {
    let envelope = envelope("A");
    for method in [Method::RungeKutta4, Method::Trapezoid, Method::Euler] {
        let single = envelope.point(method, Scalar::Single, 200_000, 1).unwrap().errors.deflections;
        let double = error(&envelope, method, 200_000);
        assert!((single - double).abs() < 2e-5, "{}: {single:.2e} against {double:.2e}", method.name());
    }
}

/// The two-mass models settle at the link angle of the whole joint.
#[test]
fn two_mass_models_settle_at_the_link_angle() {
    let envelope = envelope("L");
    for method in [Method::TwoMassSpring, Method::TwoMassRestitution] {
        let errors = envelope.point(method, Scalar::Double, 160_000, 1).unwrap().errors;
        assert!(errors.link_rms < 0.1, "{}: {:.1e}", method.name(), errors.link_rms);
    }
}

/// A phase shift by a whole period changes nothing.
#[test]
fn whole_period_shift_changes_nothing() {
    let case = named("A");
    let envelope = PhaseEnvelope::new(case.shifted(1.0), 1).unwrap();
    let samples: Vec<_> = envelope.trajectory().samples().iter().cloned().enumerate().collect();
    let Errors { deflections, .. } = PhaseEnvelope::new(case, 1).unwrap().trajectory().errors(&samples);
    assert!(deflections < 1e-6, "{deflections:.1e}");
}

/// A phase shift by half a period changes the motion.
#[test]
fn half_period_shift_changes_the_motion() {
    let case = named("A");
    let envelope = PhaseEnvelope::new(case.shifted(0.5), 1).unwrap();
    let samples: Vec<_> = envelope.trajectory().samples().iter().cloned().enumerate().collect();
    let Errors { deflections, .. } = PhaseEnvelope::new(case, 1).unwrap().trajectory().errors(&samples);
    assert!(deflections > 0.5, "{deflections:.1e}");
}

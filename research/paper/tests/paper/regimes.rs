//! The four regimes of set P in both readings of Table 1, and exponents known from elsewhere.

use paper::numerics::attractor;
use paper::numerics::attractor::{Class, Effort, by_two_trajectories, find};
use paper::numerics::integrator::EventIntegrator;
use paper::numerics::signal::Signal;
use paper::numerics::system::System;
use parameters::StiffnessWave;

use super::{SHORT, from_rest, plan, subject};

/// Tolerance of known Poincare points, over b_c.
const POINT: f64 = 1e-3;
/// Tolerance of known exponents of periodic motion.
const PERIODIC: f64 = 0.002;
/// Tolerance of known exponents of chaos.
const CHAOTIC: f64 = 0.01;

/// Largest distance of two methods on one stretch of motion.
const METHODS: f64 = 1e-3;

/// Effort for exponents of chaos to about 0.0014 (one standard deviation).
const LONG: Effort = Effort { chaotic_periods: 9000, ..SHORT };

fn distance(one: &[f64; 4], other: &[f64; 4]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Set P has four regimes with known points and exponents.
#[test]
fn set_p_has_four_known_regimes() {
    let paper = subject("paper", None);
    let known: [(f64, usize, f64, &[[f64; 4]]); 3] = [
        (0.0, 1, -0.0324, &[[-0.0678, 0.8675, -11.5051, -5.0495]]),
        (10.0, 1, -0.0324, &[[0.3748, 1.4129, -9.0687, -2.7137]]),
        (
            60.0,
            3,
            -0.0319,
            &[
                [0.7489, 6.1283, -13.9408, -6.2729],
                [-6.2003, 0.6379, -4.3947, 0.8576],
                [6.5018, 10.4328, -2.1416, 3.4190],
            ],
        ),
    ];
    for (half_backlash, period, exponent, points) in known {
        let found = from_rest(&paper, half_backlash, &SHORT);
        assert_eq!(found.class, Class::Periodic(period), "b = {half_backlash}");
        assert!((found.exponent - exponent).abs() < PERIODIC, "b = {half_backlash}: {}", found.exponent);
        for point in points {
            let nearest = found.cycle().iter().map(|other| distance(point, other)).fold(f64::INFINITY, f64::min);
            assert!(nearest < POINT, "b = {half_backlash}: {nearest} from {point:?}");
        }
    }
    let chaos = from_rest(&paper, 120.0, &LONG);
    assert_eq!(chaos.class, Class::Chaotic);
    assert!((chaos.exponent - 0.1402).abs() < CHAOTIC, "{}", chaos.exponent);
}

/// The carrier as printed has the same regimes with other exponents.
#[test]
fn printed_carrier_has_the_same_regimes() {
    let printed = subject("paper_printed", None);
    for (half_backlash, period, exponent) in [(0.0, 1, -0.0374), (10.0, 1, -0.0374), (60.0, 3, -0.0371)] {
        let found = from_rest(&printed, half_backlash, &SHORT);
        assert_eq!(found.class, Class::Periodic(period), "b = {half_backlash}");
        assert!((found.exponent - exponent).abs() < PERIODIC, "b = {half_backlash}: {}", found.exponent);
    }
    let chaos = from_rest(&printed, 120.0, &LONG);
    assert_eq!(chaos.class, Class::Chaotic);
    assert!((chaos.exponent - 0.1410).abs() < CHAOTIC, "{}", chaos.exponent);
}

/// The exponent of a linear joint is the real part of its slowest eigenvalue.
#[test]
fn linear_exponent_is_slowest_eigenvalue() {
    let mut linear = subject("paper", None);
    for mesh in [&mut linear.parameters.sun_planet, &mut linear.parameters.ring_planet] {
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.0 };
    }
    let found = from_rest(&linear, 0.0, &Effort { points: 600, ..SHORT });
    // Real part of -0.032282 +- 0.637513i: the mean decay of a turning vector.
    assert!((found.exponent + 0.032282).abs() < 2e-5, "{}", found.exponent);
}

/// The motion of a linear joint is the known ellipse.
#[test]
fn linear_motion_is_the_known_ellipse() {
    let mut linear = subject("paper", None);
    for mesh in [&mut linear.parameters.sun_planet, &mut linear.parameters.ring_planet] {
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.0 };
    }
    let system = linear.system(0.0).expect("it can be studied");
    let mut motion = EventIntegrator::from_rest(&system);
    find(&mut motion, &SHORT).expect("it runs");
    let signal = Signal::record(&mut motion, 1).expect("it runs");
    // Twice |X_sp| of the complex solve; samples miss the crests slightly.
    assert!((signal.peak_to_peak() - 2.0 * 5.658641).abs() < 2e-3, "{}", signal.peak_to_peak());
    assert!(signal.non_fundamental_ratio() < 1e-8, "{}", signal.non_fundamental_ratio());
}

/// Content outside the mesh frequency shows the period of three.
#[test]
fn period_three_shows_outside_harmonics() {
    let paper = subject("paper", None);
    for (half_backlash, periods, ratio, peak_to_peak) in [(10.0, 3, 0.005, 8.961), (60.0, 3, 2.66, 20.021)] {
        let system = paper.system(half_backlash / 1e6).expect("it can be studied");
        let mut motion = EventIntegrator::from_rest(&system);
        find(&mut motion, &SHORT).expect("it runs");
        let signal = Signal::record(&mut motion, periods).expect("it runs");
        assert!((signal.non_fundamental_ratio() - ratio).abs() < 0.005, "{}", signal.non_fundamental_ratio());
        assert!((signal.peak_to_peak() - peak_to_peak).abs() < POINT, "{}", signal.peak_to_peak());
    }
}

/// Exponent by a tangent vector and by two trajectories, from rest.
fn both(system: &System, effort: &Effort) -> (f64, f64) {
    let found = find(&mut EventIntegrator::from_rest(system), effort).expect("it runs");
    (found.exponent, by_two_trajectories(system, &found, effort).expect("it runs"))
}

/// Both methods agree for periodic motion and for chaos.
#[test]
fn both_methods_give_one_exponent() {
    let paper = subject("paper", None);
    for half_backlash in [60e-6, 120e-6] {
        let (tangent, two) = both(&paper.system(half_backlash).expect("it can be studied"), &SHORT);
        assert!((tangent - two).abs() < METHODS, "{tangent} and {two}");
    }
}

/// Both methods agree with the law `contact`, where tangent vectors jump.
#[test]
fn contact_law_exponents_agree() {
    // Joint l1 has the damping law `contact`: its force jumps by C d' when teeth meet.
    let l1 = subject("l1", Some("0.8"));
    let (tangent, two) = both(&l1.system(60e-6).expect("it can be studied"), &SHORT);
    assert!((tangent - two).abs() < METHODS, "{tangent} and {two}");
    let q1 = subject("q1", Some("0.3"));
    let (tangent, two) =
        both(&q1.system(40e-6).expect("it can be studied"), &Effort { chaotic_periods: 1000, ..SHORT });
    assert!(tangent > 0.03, "chaos: {tangent}");
    assert!((tangent - two).abs() < METHODS, "{tangent} and {two}");
}

/// Disturbances between planets in phase decay, even in chaos.
#[test]
fn planets_stay_in_phase_in_chaos() {
    let paper = subject("paper", None);
    let system = paper.system(120e-6).expect("it can be studied");
    let mut motion = EventIntegrator::from_rest(&system);
    find(&mut motion, &SHORT).expect("it runs");
    let exponent = attractor::between_planets(&motion, &SHORT).expect("it runs").expect("planets in phase");
    assert!((-0.055..-0.03).contains(&exponent), "{exponent}");
    let mut unequal = paper.clone();
    unequal.parameters.sun_planet.transmission_error[1] *= 0.9;
    let system = unequal.system(120e-6).expect("it can be studied");
    assert_eq!(attractor::between_planets(&EventIntegrator::from_rest(&system), &SHORT), Ok(None));
}

/// A slowly settling motion is found by Newton's method.
#[test]
fn slow_motion_is_found_by_newton() {
    // The link of q1 swings on its compliance for tens of thousands of mesh periods.
    let q1 = subject("q1", Some("2.1"));
    let found = from_rest(&q1, 40.0, &SHORT);
    assert_eq!(found.class, Class::Periodic(1), "exponent {}", found.exponent);
}

/// The independent integrator finds the same motion.
#[test]
fn independent_integrator_agrees() {
    for words in [
        &["paper", "--b", "0,60,120", "--grid", "0:0:1"][..],
        &["l1", "--b", "0,60", "--grid", "0:0:1", "--omega", "0.8"],
    ] {
        let plan = plan(words).expect("a good plan");
        let record = paper::study(&plan, &report::progress::Progress::new()).expect("it runs");
        for found in &record.readings[0].attractors {
            let distance = found.reference_distance.expect("the reference takes this joint");
            assert!(distance < 1e-8, "{words:?}, b = {}: {distance}", found.half_backlash_m);
        }
    }
}

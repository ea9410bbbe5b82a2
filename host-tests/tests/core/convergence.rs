//! Order of convergence of each scheme of the core in f64: slope of its error against the reference over the step, on a motion that keeps
//! contact and on one in which meshes part and hit.

use std::ops::RangeInclusive;

use host_tests::tolerance::core::{ORDER, ORDER_AT_KINKS, ORDER_OF_EULER, ORDER_OF_RUNGE_KUTTA_AT_KINKS};
use model_core::gears::design::{Effort, design_scheme};
use model_core::gears::{Scheme, Tables};
use reference::scenarios::{CASE_A_OMEGA, CASE_Q_OMEGA, Scenario, case, regime, run_at};

use super::comparison::rms_error;

/// Tick rate of the coarsest run [Hz]; samples are taken at its ticks.
const COARSEST_RATE: u32 = 5_000;

/// Step of the core, dimensionless, and its RMS error over all mesh deflections, over b_c.
type Point = (f64, f64);

/// Errors at tick rates of COARSEST times 2^k for k in the given range; `step` returns the scheme's own step.
fn errors(
    scenario: &Scenario,
    scheme: Scheme,
    doublings: RangeInclusive<u32>,
    step: fn(&Tables<f64, 3>) -> f64,
) -> Vec<Point> {
    let samples = scenario.duration() * f64::from(COARSEST_RATE);
    let times: Vec<f64> = (1..=samples as u32).map(|sample| f64::from(sample) / f64::from(COARSEST_RATE)).collect();
    let expected = run_at(scenario, &times).expect("the reference follows").samples;
    doublings
        .map(|doublings| {
            let ticks = 1 << doublings;
            let tables: Tables<f64, 3> =
                design_scheme(&scenario.joint, COARSEST_RATE * ticks, scheme, Effort::Accurate).expect("a sound joint");
            let error = rms_error(&scenario.joint, &tables, &scenario.start, scenario.torques_at(0), &expected);
            println!("{}, {scheme:?}: step {:.4}, error {error:.2e}", scenario.name, step(&tables));
            (step(&tables), error)
        })
        .collect()
}

/// Slope of log error over log step, by least squares.
fn order(points: &[Point]) -> f64 {
    let count = points.len() as f64;
    let mean = |of: fn(&Point) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0.ln()), mean(|point| point.1.ln()));
    let along: f64 = points.iter().map(|point| (point.0.ln() - x) * (point.1.ln() - y)).sum();
    along / points.iter().map(|point| (point.0.ln() - x).powi(2)).sum::<f64>()
}

/// Scenario cut off after `ticks`.
fn shortened(mut scenario: Scenario, ticks: u64) -> Scenario {
    scenario.ticks = ticks;
    scenario
}

/// A whole tick with contact held is of fourth order in the stiffness ripple.
#[test]
fn whole_tick_is_of_fourth_order() {
    // Ticks last up to 4 dimensionless seconds, where no method of sub-steps is stable; without ripple there is no error.
    let scenario = shortened(case("case Q", CASE_Q_OMEGA), 200);
    // Finer steps reach the reference's own error; coarser steps show the next order.
    let points = errors(&scenario, Scheme::Realtime, 1..=4, |tables| tables.flow.step);
    ORDER.check((4.0 - order(&points)).max(0.0));
}

/// Corrected sub-steps are of third order or higher on smooth motion.
#[test]
fn smooth_substeps_are_of_third_order() {
    // No backlash, but an excitation too fast for a whole tick.
    let scenario = shortened(regime("set P, b = 0", 0.0, 300.0), 100);
    let points = errors(&scenario, Scheme::Realtime, 5..=8, |tables| tables.substep);
    // The predicted rate is of second order and acts through damping alone, so the fourth order of the rest still shows.
    ORDER.check((3.0 - order(&points)).max(0.0));
}

/// Corrected sub-steps stay of third order or higher where meshes part and hit.
#[test]
fn kinked_substeps_are_of_third_order() {
    // Without corrections a crossing leaves an error of second order, wherever in the step it falls.
    let scenario = shortened(case("case A", CASE_A_OMEGA), 100);
    let points = errors(&scenario, Scheme::Realtime, 2..=8, |tables| tables.substep);
    ORDER_AT_KINKS.check((3.0 - order(&points)).max(0.0));
}

/// The paper's scheme is of first order on smooth and on kinked motion.
#[test]
fn paper_scheme_is_of_first_order() {
    for (scenario, doublings) in [
        (shortened(case("case Q", CASE_Q_OMEGA), 200), 0..=6),
        (shortened(regime("set P, b = 0", 0.0, 300.0), 100), 5..=8),
        (shortened(case("case A", CASE_A_OMEGA), 100), 5..=9),
    ] {
        let points = errors(&scenario, Scheme::PaperEtd1, doublings, |tables| tables.flow.step);
        ORDER.check(order(&points) - 1.0);
    }
}

/// Runge-Kutta drops from fourth to second order where meshes part and hit.
#[test]
fn runge_kutta_drops_to_second_order() {
    let smooth = shortened(regime("set P, b = 0", 0.0, 300.0), 100);
    ORDER.check(order(&errors(&smooth, Scheme::RungeKutta4, 5..=8, |tables| tables.substep)) - 4.0);
    let kinked = shortened(case("case A", CASE_A_OMEGA), 100);
    let kinked = order(&errors(&kinked, Scheme::RungeKutta4, 2..=8, |tables| tables.substep));
    println!("Runge-Kutta through kinks: order {kinked:.2}");
    // A kink inside the step leaves an error of second order, whatever the method's own order.
    ORDER_OF_RUNGE_KUTTA_AT_KINKS.check(kinked - 2.0);
}

/// Semi-implicit Euler is of first order on smooth and on kinked motion.
#[test]
fn euler_is_of_first_order() {
    for (scenario, doublings) in [
        (shortened(regime("set P, b = 0", 0.0, 300.0), 100), 7..=10),
        (shortened(case("case A", CASE_A_OMEGA), 100), 6..=9),
    ] {
        let points = errors(&scenario, Scheme::SemiImplicitEuler, doublings, |tables| tables.substep);
        ORDER_OF_EULER.check(order(&points) - 1.0);
    }
}

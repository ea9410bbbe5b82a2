//! The integrator alone, on one mass in a dead zone with known free periods, and in cases where event search could miss or never end. No
//! gears.

use std::f64::consts::TAU;

use host_tests::tolerance::FREE_PERIOD;
use reference::integrator::{Entries, Guards, Integrator, MAX_ENTRIES, SwitchedSystem};

/// Mass with x'' = force - f(x, half_backlash), mass and stiffness one.
struct Mass {
    force: f64,
    half_backlash: f64,
    side: f64,
    longest_step: f64,
    tolerance: f64,
}

impl Mass {
    fn new(force: f64, half_backlash: f64) -> Self {
        Self { force, half_backlash, side: 0.0, longest_step: 1.0, tolerance: 1e-13 }
    }

    /// Motion from rest at `amplitude` beyond the equilibrium on the side of the force.
    fn released(&self, amplitude: f64) -> Integrator {
        let mut state: Entries = [0.0; MAX_ENTRIES];
        state[0] = self.half_backlash + self.force + amplitude;
        Integrator::new(0.0, state)
    }
}

impl SwitchedSystem for Mass {
    fn dimension(&self) -> usize {
        2
    }

    fn derivative(&self, _: f64, state: &Entries, rates: &mut Entries) {
        rates[0] = state[1];
        rates[1] = self.force - self.side.abs() * (state[0] - self.side * self.half_backlash);
    }

    fn select_mode(&mut self, _: f64, state: &Entries) {
        self.side = if state[0].abs() > self.half_backlash { state[0].signum() } else { 0.0 };
    }

    fn guards(&self, _: f64, state: &Entries, _: &Entries, guards: &mut Guards) {
        if self.side == 0.0 {
            guards.watch(self.half_backlash - state[0], -state[1]);
            guards.watch(self.half_backlash + state[0], state[1]);
        } else {
            guards.watch(self.side * state[0] - self.half_backlash, self.side * state[1]);
        }
    }

    fn guard_resolution(&self) -> f64 {
        1e-14
    }

    fn tolerance(&self, _: usize) -> f64 {
        self.tolerance
    }

    fn longest_step(&self) -> f64 {
        self.longest_step
    }
}

/// Error of a period, relative: releases the mass, runs twenty of the expected periods and reads the speed, which near the turning point is
/// the acceleration there times the delay.
fn period_error(force: f64, half_backlash: f64, amplitude: f64, period: f64) -> f64 {
    let mut mass = Mass::new(force, half_backlash);
    let mut motion = mass.released(amplitude);
    motion.advance(&mut mass, 20.0 * period).expect("it runs");
    let [position, speed] = [motion.state()[0], motion.state()[1]];
    assert!((position - half_backlash - force - amplitude).abs() < 1e-6 * amplitude, "a whole number of periods");
    speed / amplitude / period
}

/// Without mean force the period grows by the time spent in the gap.
#[test]
fn gap_lengthens_the_free_period() {
    for (half_backlash, amplitude) in [(0.5_f64, 1.0), (2.0, 0.3), (0.01, 5.0)] {
        FREE_PERIOD.check(period_error(0.0, half_backlash, amplitude, TAU + 4.0 * half_backlash / amplitude));
    }
}

/// With loss of contact on one side the period matches its closed form.
#[test]
fn one_sided_contact_has_closed_period() {
    for (force, half_backlash, amplitude) in [(1.0_f64, 2.0, 1.5_f64), (1.0, 5.0, 3.0), (0.2, 1.0, 0.21)] {
        assert!(
            (amplitude.powi(2) - force.powi(2)) / (2.0 * force) < 2.0 * half_backlash,
            "the far side is not reached"
        );
        let flight = 2.0 * (amplitude.powi(2) - force.powi(2)).sqrt() / force;
        let contact = 2.0 * (std::f64::consts::PI - (force / amplitude).acos());
        FREE_PERIOD.check(period_error(force, half_backlash, amplitude, contact + flight));
    }
}

/// With contact on both flanks the period matches its closed form.
#[test]
fn two_sided_contact_has_closed_period() {
    for (force, half_backlash, amplitude) in [(0.5_f64, 0.5, 2.0_f64), (1.0, 0.3, 4.0), (0.1, 2.0, 3.0)] {
        let entry = (amplitude.powi(2) - force.powi(2)).sqrt();
        let exit = (entry.powi(2) - 4.0 * half_backlash * force).sqrt();
        let far_amplitude = exit.hypot(force);
        let period = 2.0 * (std::f64::consts::PI - (force / amplitude).acos())
            + 2.0 * (entry - exit) / force
            + 2.0 * (force / far_amplitude).acos();
        FREE_PERIOD.check(period_error(force, half_backlash, amplitude, period));
    }
}

/// The method is of eighth order.
#[test]
fn method_is_of_eighth_order() {
    let error = |step: f64| {
        let mut mass = Mass { longest_step: step, tolerance: f64::INFINITY, ..Mass::new(0.0, 0.0) };
        let mut motion = mass.released(1.0);
        // Ends before x = 0, so that no event shortens a step.
        motion.advance(&mut mass, 1.5).expect("it runs");
        (motion.state()[0] - 1.5_f64.cos()).hypot(motion.state()[1] + 1.5_f64.sin())
    };
    let order = (error(0.75) / error(0.375)).log2();
    assert!((7.5..9.5).contains(&order), "order {order}");
}

/// Grazes deeper than the resolution are found; shallower grazes do no harm.
#[test]
fn grazes_are_found_to_the_resolution() {
    // At amplitude = force the mass swings back exactly to the edge of the gap.
    for (excess, least_events) in [(1e-3, 180), (1e-6, 180), (1e-9, 180), (1e-14, 0), (0.0, 0), (-1e-14, 0), (-1e-6, 0)]
    {
        let mut mass = Mass::new(1.0, 0.5);
        let amplitude = 1.0 + excess;
        let mut motion = mass.released(amplitude);
        motion.advance(&mut mass, 95.0 * TAU).expect("it runs");
        let counters = motion.counters();
        assert!(counters.events >= least_events, "excess {excess}: {counters:?}");
        // Two events in each swing; near the resolution a swing may need a few more.
        assert!(counters.events <= 800, "excess {excess}: {counters:?}");
        let energy =
            0.5 * motion.state()[1].powi(2) + 0.5 * (motion.state()[0] - 0.5).max(0.0).powi(2) - motion.state()[0];
        let start = 0.5 * (1.0 + amplitude).powi(2) - (1.5 + amplitude);
        assert!((energy - start).abs() < 1e-10, "excess {excess}: energy changed by {:e}", energy - start);
    }
}

/// A mass at rest on the edge of the gap stays there without events.
#[test]
fn mass_on_the_edge_stays_there() {
    let mut mass = Mass::new(0.0, 0.5);
    let mut motion = mass.released(0.0);
    motion.advance(&mut mass, 1000.0).expect("it runs");
    assert_eq!(motion.state()[..2], [0.5, 0.0]);
    assert_eq!(motion.counters().events, 0);
}

/// A non-finite state is reported with its time.
#[test]
fn non_finite_state_is_reported() {
    let mut mass = Mass::new(f64::NAN, 0.5);
    let mut motion = mass.released(0.0);
    let error = motion.advance(&mut mass, 1.0).expect_err("NaN is no state");
    assert_eq!(error.to_string(), "the state is no longer finite at t = 0 s");
}

//! Oracle 7 on the core: with planets and carrier 1e9 times as heavy as the sun, the sun alone swings between n meshes in parallel, and its
//! free period through the gap has a closed form.

use std::f64::consts::{PI, TAU};

use host_tests::tolerance::core::CORE_FREE_PERIOD;
use model_core::gears::Relative;
use parameters::JointParameters;
use reference::scenarios::{PAPER_LENGTH, same};

use super::closed_forms::joint;
use super::{Start, run};

const TICK_RATE: u32 = 1_000_000;
const SUN: f64 = 0.39;

fn sun_alone(planets: usize, half_backlash: f64) -> JointParameters {
    let mut parameters = joint(planets, 0.0, half_backlash * PAPER_LENGTH, 0.0);
    for mesh in [&mut parameters.sun_planet, &mut parameters.ring_planet] {
        mesh.transmission_error = same(planets, 0.0);
    }
    parameters.bodies.planet_equivalent_mass = 1e9 * SUN;
    parameters.bodies.carrier_inertia_over_radius_squared = 1e9 * SUN;
    parameters
}

/// Error of a period, relative: releases the sun from rest at `amplitude` beyond its equilibrium under `force` (over n K_m), runs about
/// twenty of the expected periods and reads the phase of the swing.
fn period_error<const N: usize>(force: f64, half_backlash: f64, amplitude: f64, period: f64) -> f64 {
    let parameters = sun_alone(N, half_backlash);
    let frequency = (N as f64 * 1e8 / SUN).sqrt();
    let out = half_backlash + force + amplitude;
    let drive = force * N as f64 * 1e8 * PAPER_LENGTH * parameters.geometry.sun_base_radius;
    let position = Relative { planets: [out; N], gap: out, wind_up: 0.0 };
    let start = Start { position, ..Start::<N>::centred(drive) };
    let ticks = (20.0 * period / frequency * f64::from(TICK_RATE)).round();
    let (_, state) = run(&parameters, TICK_RATE, &start, ticks as usize, 1).remove(0);
    // Unit that refers the speed to the swing's own frequency instead of omega_n.
    let unit = (1e8 / SUN * (1.0 + 1e-9)).sqrt() / frequency;
    let phase = (-state.rate.gap * unit).atan2(state.position.gap - half_backlash - force);
    (phase - (ticks / f64::from(TICK_RATE) * frequency - 20.0 * period)) / (20.0 * period)
}

fn check_on_every_joint(force: f64, half_backlash: f64, amplitude: f64, period: f64) {
    CORE_FREE_PERIOD.check(period_error::<3>(force, half_backlash, amplitude, period));
    CORE_FREE_PERIOD.check(period_error::<4>(force, half_backlash, amplitude, period));
    CORE_FREE_PERIOD.check(period_error::<5>(force, half_backlash, amplitude, period));
}

/// Without mean force the period grows by the time spent in the gap.
#[test]
fn gap_lengthens_the_free_period() {
    for (half_backlash, amplitude) in [(0.5, 1.0), (6.0, 2.0), (0.1, 5.0)] {
        check_on_every_joint(0.0, half_backlash, amplitude, TAU + 4.0 * half_backlash / amplitude);
    }
}

/// With loss of contact on one side the period matches its closed form.
#[test]
fn one_sided_contact_has_closed_period() {
    for (force, half_backlash, amplitude) in [(1.0_f64, 2.0, 1.5_f64), (1.0, 5.0, 3.0), (0.5, 3.0, 1.0)] {
        let way = amplitude.powi(2) - force.powi(2);
        assert!(way / (2.0 * force) < 2.0 * half_backlash, "the far side is not reached");
        let period = 2.0 * (PI - (force / amplitude).acos()) + 2.0 * way.sqrt() / force;
        check_on_every_joint(force, half_backlash, amplitude, period);
    }
}

/// With contact on both flanks the period matches its closed form.
#[test]
fn two_sided_contact_has_closed_period() {
    for (force, half_backlash, amplitude) in [(0.5_f64, 0.5, 2.0_f64), (1.0, 0.3, 4.0), (0.1, 2.0, 3.0)] {
        let entry = (amplitude.powi(2) - force.powi(2)).sqrt();
        let exit = (entry.powi(2) - 4.0 * half_backlash * force).sqrt();
        let period = 2.0 * (PI - (force / amplitude).acos())
            + 2.0 * (entry - exit) / force
            + 2.0 * (force / exit.hypot(force)).acos();
        check_on_every_joint(force, half_backlash, amplitude, period);
    }
}

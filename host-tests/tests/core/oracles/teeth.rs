//! Oracle 8 on the core: planets lead one another by the fraction of a tooth left by Z / n, and move in phase where the division leaves
//! none.

use std::f64::consts::TAU;

use host_tests::tolerance::core::CORE_TOOTH_PHASE;
use parameters::{Excitation, JointParameters, MeshPhases, StiffnessWave};
use reference::scenarios::{PAPER_LENGTH, same};

use super::closed_forms::joint;
use super::{Start, run};

/// Ticks in a mesh period, divisible by three, four and five planets.
const PERIOD: usize = 60;
const TICK_RATE: u32 = 400_000;

fn by_teeth(planets: usize, sun_teeth: u32, ring_teeth: u32, ripple: f64) -> JointParameters {
    let mut parameters = joint(planets, 0.05, 10e-6, 0.0);
    parameters.geometry.sun_teeth = sun_teeth;
    parameters.geometry.ring_teeth = ring_teeth;
    parameters.excitation = Excitation::Time { mesh_frequency: TAU * f64::from(TICK_RATE) / PERIOD as f64 };
    for (mesh, error) in [(&mut parameters.sun_planet, 0.0), (&mut parameters.ring_planet, 0.7)] {
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: ripple };
        mesh.transmission_error = same(planets, 3e-6);
        mesh.phases = MeshPhases::FromTeeth { stiffness: 0.4, error };
    }
    parameters
}

/// Checks the phases of the planets under a load that keeps contact, so that the motion has the mesh period.
fn check_tooth_phases<const N: usize>(sun_teeth: u32, ring_teeth: u32, lead: usize) {
    let parameters = by_teeth(N, sun_teeth, ring_teeth, 0.05);
    let found = run(&parameters, TICK_RATE, &Start::<N>::centred(2400.0), 200 * PERIOD, 2 * PERIOD);
    for kind in [0, 1] {
        for planet in 1..N {
            let ahead = (lead * planet) % N * PERIOD / N;
            for sample in 0..PERIOD {
                let later = found[sample + ahead].0.deflections[kind][0];
                CORE_TOOTH_PHASE.check((found[sample].0.deflections[kind][planet] - later) / PAPER_LENGTH);
            }
        }
    }
    let apart = found.iter().map(|(outputs, _)| (outputs.deflections[0][0] - outputs.deflections[0][1]).abs());
    assert!(apart.fold(0.0, f64::max) > 0.1 * PAPER_LENGTH, "the planets are not in phase");
}

/// Planets follow one another by the fraction of a tooth.
#[test]
fn planets_follow_by_tooth_fraction() {
    check_tooth_phases::<3>(28, 98, 1);
    check_tooth_phases::<4>(26, 98, 2);
    check_tooth_phases::<5>(27, 98, 2);
}

/// Planets with whole tooth counts move in phase in every bit.
#[test]
fn whole_tooth_counts_move_in_phase() {
    // The joint swings through its gap without load, where the smallest difference would grow.
    for (outputs, _) in run(&by_teeth(3, 27, 99, 0.2), TICK_RATE, &Start::<3>::centred(2.0), 0, 20_000) {
        for family in outputs.deflections {
            assert_eq!(family, [family[0]; 3]);
        }
    }
}

//! Excitation of the mesh phase, forwards and backwards, and the rectangular stiffness wave against its graph.

use std::f64::consts::{PI, TAU};

use host_tests::tolerance::{INVARIANCE, RECTANGULAR_WAVE};
use parameters::{Excitation, JointParameters, MeshPhases, PerPlanet, StiffnessWave};
use reference::joint::RelativeState;
use reference::scenarios::{PAPER_LENGTH, Scenario, TorqueSegment, l1, paper_joint, run, run_at, same};

/// Phases of stiffness and error, sun-planet and ring-planet [rad].
const PHASES: [[f64; 2]; 2] = [[0.3, 1.1], [2.0, -0.6]];

fn with_phases(mut joint: JointParameters, turn: fn(f64) -> f64) -> JointParameters {
    for (mesh, [stiffness, error]) in [&mut joint.sun_planet, &mut joint.ring_planet].into_iter().zip(PHASES) {
        // Each planet has its own phase.
        let each = |first: f64| -> PerPlanet { (0..3).map(|planet| turn(first + f64::from(planet))).collect() };
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.2 };
        mesh.transmission_error = same(3, 8e-6);
        mesh.phases = MeshPhases::Given { stiffness: each(stiffness), error: each(error) };
    }
    joint
}

/// L1 turning at constant speed under balanced torques.
fn turning_scenario(joint: JointParameters, rigid_speed: f64) -> Scenario {
    let ratio = 2.0 * 90.3 / 38.7;
    let start = RelativeState { rigid_speed, ..RelativeState::centred(3) };
    let torques = vec![TorqueSegment { from_tick: 0, drive_torque: 60.0, load_torque: 60.0 * ratio }];
    Scenario { torques, ticks: 400, ..Scenario::new("turning", joint, start) }
}

/// At constant speed, excitation by angle equals excitation by time in both directions.
#[test]
fn angle_excites_like_time_at_constant_speed() {
    let speed = 12.0;
    let mesh_frequency = 99.0 * speed;
    // Backwards, sin(-omega t + phase) = sin(omega t + pi - phase).
    let same_way: fn(f64) -> f64 = |phase| phase;
    let mirrored: fn(f64) -> f64 = |phase| PI - phase;
    for (rigid_speed, turn) in [(speed, same_way), (-speed, mirrored)] {
        let by_angle = turning_scenario(with_phases(l1(), same_way), rigid_speed);
        let mut by_time = turning_scenario(with_phases(l1(), turn), rigid_speed);
        by_time.joint.excitation = Excitation::Time { mesh_frequency };
        let (by_angle, by_time) = (run(&by_angle).expect("it runs"), run(&by_time).expect("it runs"));
        assert!(by_angle.counters.events > 0);
        for (a, b) in by_angle.samples.iter().zip(&by_time.samples) {
            for (a, b) in a.deflections.iter().flatten().zip(b.deflections.iter().flatten()) {
                INVARIANCE.check((a - b) / PAPER_LENGTH);
            }
        }
    }
}

/// Rectangular wave of Fig. 3: high over the fraction `duty` of the period about pi/2, mean one.
fn rectangular_wave(phase: f64, ratio: f64, duty: f64) -> f64 {
    let from_centre = (phase - PI / 2.0 + PI).rem_euclid(TAU) - PI;
    let low = 1.0 - 2.0 * ratio * duty;
    if from_centre.abs() < PI * duty { low + 2.0 * ratio } else { low }
}

/// The rectangular wave is the Fourier series of its graph.
#[test]
fn rectangular_wave_is_its_fourier_series() {
    const CELLS: u32 = 20_000;
    let (ratio, contact_ratio, order) = (0.2, 1.6, 6);
    let middle = |cell: u32| TAU * (f64::from(cell) + 0.5) / f64::from(CELLS);
    let projected = |phase: f64| {
        (1..=order).fold(1.0, |sum, harmonic| {
            let m = f64::from(harmonic);
            let part = |wave: fn(f64) -> f64| {
                let integral: f64 =
                    (0..CELLS).map(|cell| rectangular_wave(middle(cell), ratio, 0.6) * wave(m * middle(cell))).sum();
                2.0 * integral / f64::from(CELLS)
            };
            sum + part(f64::sin) * (m * phase).sin() + part(f64::cos) * (m * phase).cos()
        })
    };
    // With a constant excitation phase the joint settles on the stiffness at this phase.
    for phase in [0.0, 0.9, 2.2, 4.0] {
        let mut joint = paper_joint(0.0, 0.0, 0.0, 0.0);
        for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
            mesh.stiffness_wave =
                StiffnessWave::Rectangular { stiffness_ratio: ratio, contact_ratio, order: order as usize };
            mesh.phases = MeshPhases::Given { stiffness: same(3, phase), error: same(3, 0.0) };
        }
        let ratio_by_radii = 2.0 * joint.geometry.carrier_radius * joint.geometry.working_pressure_angle.cos()
            / joint.geometry.sun_base_radius;
        let mut scenario = turning_scenario(joint, 0.0);
        scenario.torques[0].load_torque = 60.0 * ratio_by_radii;
        let sample = run_at(&scenario, &[0.1]).expect("it settles").samples.remove(0);
        let force = 60.0 / (3.0 * scenario.joint.geometry.sun_base_radius);
        let stiffness = force / sample.deflections[0][1];
        RECTANGULAR_WAVE.check(stiffness / 1e8 - projected(phase));
    }
}
